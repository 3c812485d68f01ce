// SPDX-License-Identifier: MIT
// The lines of a path in a text: timed poses, or commands.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::sim {

class G4LIDAR_HIDDEN route {
 public:
  using error_if_any = std::optional<std::string>;

  /// No value if a line that begins with `word` does not belong to a path.
  [[nodiscard]] std::optional<error_if_any> take(std::string_view word, std::string_view rest,
                                                 std::size_t line_number);
  [[nodiscard]] bool has_poses() const noexcept { return !path_.empty(); }
  /// After the last line: completes the path. Commands begin at `start`.
  [[nodiscard]] std::optional<world_error> finish(const pose& start);
  /// Empty if there was no line of a path.
  [[nodiscard]] std::vector<path_point> path() && { return std::move(path_); }

 private:
  enum class action { forward, turn, arc, wait };
  struct leg {
    action what;
    double amount;  // m, degrees or seconds
    double radius_m;
    double speed;  // m/s or degrees/s
    std::size_t line;
  };

  error_if_any take_pose(std::string_view rest);
  error_if_any take_drive(std::string_view rest, std::size_t line_number);
  void follow(const leg& next);

  std::vector<path_point> path_;
  std::vector<leg> legs_;
};

}  // namespace g4lidar::sim
