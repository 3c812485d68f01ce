// SPDX-License-Identifier: MIT
// Scenarios that produce each problem, and the resulting errors.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "g4lidar/error.hpp"

namespace g4lidar::test {

/// A scenario.
struct scenario {
  std::string_view name;  ///< The name in docs/errors.md.
  problem what;
  task doing;
  bool fatal;                                       ///< Whether it ends the loop of an application.
  std::string_view subject;                         ///< A part of it.
  std::optional<error> (*bring_about)() = nullptr;  ///< Nothing if there was no error.
};

/// A driver with the simulated device, in virtual time.
[[nodiscard]] std::vector<scenario> device_scenarios();
/// Ports, connections and files of this computer.
[[nodiscard]] std::vector<scenario> port_scenarios();
/// The selection of one of the computer's ports.
[[nodiscard]] std::vector<scenario> place_scenarios();

[[nodiscard]] std::vector<scenario> all_scenarios();

template <class T>
[[nodiscard]] std::optional<error> error_in(const result<T>& got) {
  return got ? std::nullopt : std::optional(got.error());
}

}  // namespace g4lidar::test
