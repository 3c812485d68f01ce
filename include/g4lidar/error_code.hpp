// SPDX-License-Identifier: MIT
// Errors as std::error_code, for programs that use it throughout.
#pragma once

#include <system_error>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"

namespace g4lidar {

/// The category of all codes of this library, "g4lidar". Its messages are those of docs/errors.md.
/// Codes with a counterpart in std::errc compare equal to it: problem::permission to
/// std::errc::permission_denied. *Any thread.*
[[nodiscard]] G4LIDAR_API const std::error_category& error_category() noexcept;

/// The problem as a code of that category; the value is never 0. *Any thread.*
[[nodiscard]] inline std::error_code make_error_code(problem code) noexcept {
  return {static_cast<int>(code) + 1, error_category()};
}
/// The same for an error. The code does not contain the task and the error number of the system.
[[nodiscard]] inline std::error_code make_error_code(const error& of) noexcept {
  return make_error_code(of.code());
}

}  // namespace g4lidar

// Allows comparing a `problem` with a std::error_code, and assigning it to one.
template <>
struct std::is_error_code_enum<g4lidar::problem> : std::true_type {};
