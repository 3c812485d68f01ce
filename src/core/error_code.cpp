// SPDX-License-Identifier: MIT
#include "g4lidar/error_code.hpp"

#include <array>
#include <string>
#include <utility>

namespace g4lidar {
namespace {

class category final : public std::error_category {
 public:
  [[nodiscard]] const char* name() const noexcept override { return "g4lidar"; }

  [[nodiscard]] std::string message(int value) const override {
    return is_problem(value) ? std::string(description_of(problem_of(value))) : "unknown";
  }

  [[nodiscard]] std::error_condition default_error_condition(int value) const noexcept override {
    using known = std::pair<problem, std::errc>;
    static constexpr std::array conditions{
        known{problem::bad_option, std::errc::invalid_argument},
        known{problem::no_port, std::errc::no_such_device},
        known{problem::gone, std::errc::no_such_device},
        known{problem::permission, std::errc::permission_denied},
        known{problem::busy, std::errc::device_or_resource_busy},
        known{problem::not_serial, std::errc::inappropriate_io_control_operation},
        known{problem::cannot_connect, std::errc::host_unreachable},
        known{problem::timeout, std::errc::timed_out},
        known{problem::cancelled, std::errc::operation_canceled}};
    for (const auto& [what, condition] : conditions) {
      if (is_problem(value) && problem_of(value) == what) return condition;
    }
    return {value, *this};
  }

 private:
  static bool is_problem(int value) noexcept {
    return value > 0 && static_cast<std::size_t>(value) <= problem_count;
  }
  static problem problem_of(int value) noexcept { return static_cast<problem>(value - 1); }
};

}  // namespace

const std::error_category& error_category() noexcept {
  static const category only;
  return only;
}

}  // namespace g4lidar
