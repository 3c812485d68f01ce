// SPDX-License-Identifier: MIT
// The answer to command 93, live or in a recording: it is added to all angles.
#pragma once

#include <optional>
#include <variant>

#include "g4lidar/core/session/model_requests.hpp"
#include "g4lidar/core/stream_parser.hpp"

namespace g4lidar {

/// *Single thread, never allocates.*
class zero_angle_watch {
 public:
  explicit zero_angle_watch(const model& which) noexcept : which_(&which) {}

  /// Was sent to the device.
  void sent(bytes data) noexcept {
    is_asked_ = data.size() == 2 && static_cast<command>(data[1]) == command::zero_angle;
  }
  /// The offset, if the event is the answer.
  [[nodiscard]] std::optional<zero_angle> take(const event& found) const noexcept {
    if (!is_asked_) return std::nullopt;  // the usual case
    const auto* const heard = std::get_if<response_view>(&found);
    if (heard == nullptr) return std::nullopt;
    return zero_angle_of(*heard, *which_);
  }

 private:
  const model* which_;
  bool is_asked_ = false;  // by the last command
};

}  // namespace g4lidar
