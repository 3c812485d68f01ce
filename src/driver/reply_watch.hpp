// SPDX-License-Identifier: MIT
// The answers that decide how points are read, live or in a recording: the firmware, and the offset of zero.
#pragma once

#include <optional>
#include <utility>

#include "g4lidar/core/session/model_requests.hpp"
#include "g4lidar/core/stream_parser.hpp"

namespace g4lidar {

/// *Single thread, never allocates.* Which command was answered is known by the order: a lidar gets one
/// command at a time.
class reply_watch {
 public:
  /// Was sent to the device.
  void sent(bytes data) noexcept {
    if (data.size() == 2) last_ = static_cast<command>(data[1]);
  }
  /// Who the lidar is, if its firmware decides: the first information of a stream, and later the answers to
  /// command 90. The turning part may report another firmware behind the scan header.
  [[nodiscard]] std::optional<device_information> who(const response_view& heard) noexcept {
    const auto found = heard.as_device_info();
    if (!found || (std::exchange(is_known_, true) && last_ != command::device_info)) return {};
    return found;
  }
  /// The offset of zero of a lidar like `which`, if it is the answer to command 93.
  [[nodiscard]] std::optional<zero_angle> zero(const response_view& heard,
                                               const model& which) const noexcept {
    if (last_ != command::zero_angle) return {};
    return zero_angle_of(heard, which);
  }

 private:
  command last_ = command::start;
  bool is_known_ = false;  // there was an information
};

}  // namespace g4lidar
