// SPDX-License-Identifier: MIT
// The answers that decide how points are read, live, in a recording or in raw bytes: the firmware, and the offset
// of zero, which is added to the points.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/command.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

/// What a stream states of its lidar. *Single thread, never allocates.* Which command was answered is known by the
/// order, where the commands are known: a lidar gets one command at a time. Raw bytes have no commands. There an
/// answer of four bytes is that to 93 if it cannot be a frequency of the model, or if it comes directly behind a
/// scan header, where a lidar sends no answer: g4-dump repeats it there. (protocol: Commands)
class reply_watch {
 public:
  /// Was sent to the device.
  constexpr void sent(bytes data) noexcept {
    if (data.size() == 2) last_ = static_cast<command>(data[1]);
  }
  /// What a response states.
  struct finding {
    /// Who the lidar is, if its firmware decides: the first information of a stream, and later the answers to
    /// command 90. The turning part may report another firmware behind the scan header.
    std::optional<device_information> firmware;
    std::optional<zero_angle> zero;  ///< The answer to command 93.
  };

  /// Passes a response of a lidar like `model`.
  [[nodiscard]] constexpr finding take(const response_view& heard, const model& model) noexcept {
    const bool is_certain =
        std::exchange(is_behind_header_, false) || !may_be_frequency(heard, model);
    is_behind_header_ = heard.kind() == response_kind::scan_started;
    finding made;
    if (const auto who = heard.as_device_info()) {
      const bool is_first = !std::exchange(is_known_, true);
      if (is_first || last_ == command::device_info) made.firmware = who;
    }
    if (last_ ? *last_ == command::zero_angle : is_certain) made.zero = zero_angle_of(heard, model);
    return made;
  }
  /// Passes any other event.
  constexpr void pass() noexcept { is_behind_header_ = false; }

 private:
  std::optional<command> last_;    // nothing: the commands are not known
  bool is_known_ = false;          // there was an information
  bool is_behind_header_ = false;  // the last event was a scan header
};

/// What is added to each angle, as the manufacturer's program does. That this is the sign, and that a device has not
/// added it already, is an assumption: no device was at hand. *Single thread, never allocates.*
class zero_offset {
 public:
  /// Who knows it, the most reliable last.
  enum class stated_by : std::uint8_t {
    device,     ///< The lidar has answered 93.
    recording,  ///< It was used for the points that were recorded.
    user,
  };
  /// Uses it, if nobody more reliable knows another one.
  constexpr void set(zero_angle known, stated_by authority) noexcept {
    if (authority < how_) return;
    angle_ = known;
    how_ = authority;
  }
  /// Nothing as long as it is not known; then no angle is changed.
  [[nodiscard]] constexpr const std::optional<zero_angle>& angle() const noexcept { return angle_; }

  /// Adds it to the angles of `points`.
  constexpr void add_to(std::span<point> points) const noexcept {
    if (!angle_ || angle_->cdeg == 0) return;
    const auto offset_deg = static_cast<float>(angle_->deg());
    for (point& each : points) {
      float turned_deg = each.angle_deg + offset_deg;
      if (turned_deg < 0.0F) turned_deg += 360.0F;
      if (turned_deg >= 360.0F) turned_deg -= 360.0F;
      each.angle_deg = turned_deg;
    }
  }

 private:
  std::optional<zero_angle> angle_;
  stated_by how_ = stated_by::device;
};

}  // namespace g4lidar
