// SPDX-License-Identifier: MIT
// What brings each problem about, and what a user is then told.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "g4lidar/error.hpp"

namespace g4lidar::test {

/// One way into trouble.
struct scenario {
  std::string_view name;  ///< As docs/errors.md names it.
  problem what;
  task doing;
  bool fatal;                                       ///< Whether an application's loop ends by it.
  std::string_view subject;                         ///< A part of it.
  std::optional<error> (*bring_about)() = nullptr;  ///< Nothing where all went well.
};

/// A driver on the simulated device, in virtual time.
[[nodiscard]] std::vector<scenario> device_scenarios();
/// Ports, connections and files of this computer.
[[nodiscard]] std::vector<scenario> port_scenarios();
/// Which of the computer's ports is meant.
[[nodiscard]] std::vector<scenario> place_scenarios();

[[nodiscard]] std::vector<scenario> all_scenarios();

template <class T>
[[nodiscard]] std::optional<error> error_in(const result<T>& got) {
  return got ? std::nullopt : std::optional(got.error());
}

}  // namespace g4lidar::test
