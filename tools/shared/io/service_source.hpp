// SPDX-License-Identifier: MIT
// The options of a lidar_service by those of a program, and its errors in the words of the tools.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/common_options.hpp"
#include "cli/exit_code.hpp"
#include "g4lidar/lidar_service.hpp"

namespace g4_tool {

/// The lidar of these options, opened as `wanted` states in all else: see options_for().
[[nodiscard]] service_lidar service_lidar_of(const common_options& options,
                                             const lidar_options& wanted);
/// Filters, mask and deskewing of these options. Throws a failure if the mask cannot be read.
[[nodiscard]] service_options service_options_of(const common_options& options);

/// lidar_service::make(). Throws a failure, and bad_value for too many lidars.
[[nodiscard]] std::unique_ptr<lidar_service> make_service(
    std::vector<service_lidar> lidars, service_options options,
    const std::vector<service_output>& outputs);

/// reader_status::why as a failure; nothing at the end of a file with packets, and after a signal.
[[nodiscard]] std::optional<failure> failure_of(const common_options& options,
                                                const std::optional<error>& why,
                                                const lidar_counts& counts);
/// The same as a text; empty for nothing.
[[nodiscard]] std::string why_of(const common_options& options, const std::optional<error>& why,
                                 const lidar_counts& counts);
/// Why a lidar has ended for good; nothing before, at the end of a file with packets, and after a signal.
[[nodiscard]] std::optional<failure> final_failure_of(const common_options& options,
                                                      const lidar_service& service,
                                                      std::size_t lidar = 0);
/// The failure of the first lidar, if all lidars have failed. `options_of`: of a lidar.
template <class OptionsOf>
[[nodiscard]] std::optional<failure> failure_of_all(const lidar_service& service,
                                                    OptionsOf options_of) {
  std::optional<failure> first;
  for (std::size_t i = service.size(); i-- > 0;) {
    first = final_failure_of(options_of(i), service, i);
    if (!first) break;
  }
  return first;
}
/// Reports that the motion by which points are deskewed is known, or `why` it is not.
void report_motion(bool is_known, const std::string& why);

}  // namespace g4_tool
