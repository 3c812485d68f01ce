// SPDX-License-Identifier: MIT
// The bytes of a lidar as raw bytes, with what their reader has to know.
#pragma once

#include <cstdint>
#include <vector>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/reply_watch.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/core/zero_offset.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/device_information.hpp"
#include "g4lidar/recording/reader.hpp"

namespace g4lidar {

/// Copies what a lidar has sent to raw bytes, as it came. A reader of raw bytes knows neither the commands nor what came
/// before the part that is copied. So answers are repeated that decide how points are read, and that it would not find:
/// at the beginning of a part the device information, with model and firmware, but not that of a G4; and behind a scan
/// header the answer to command 93. *Single thread, allocates.*
class G4LIDAR_API raw_copy {
 public:
  /// Of a lidar like `model`, valid as long as this; `information`: what is known of it before the first bytes.
  explicit raw_copy(const model& model, const device_information& information = {});

  /// Whether the answers before a part matter for reading it, so that they must be passed, too.
  [[nodiscard]] bool needs_begin() const noexcept {
    return which_->zero_angle_divisor != 0 || which_->old_firmware.last_version != 0;
  }

  /// Passes what was received, in order: appends it to `out` if it is wanted, with what is repeated.
  void received(bytes data, bool is_wanted, std::vector<std::uint8_t>& out);
  /// Passes an item of a recording in the same way.
  void take(const recorded_item& item, bool is_wanted, std::vector<std::uint8_t>& out);

 private:
  /// What is known of the lidar by its bytes.
  struct known_lidar {
    const model* like;
    device_information who{};
    reply_watch replies{};
    zero_offset zero{};

    void take(const event& found, const model& named) noexcept;
  };

  void take(const event& found, bool is_wanted);
  [[nodiscard]] bool is_zero_missing() const noexcept;
  void put_information(std::vector<std::uint8_t>& out);
  void put_zero(bool with_header, std::vector<std::uint8_t>& out);

  const model* which_;
  stream_parser parser_;
  known_lidar source_;
  known_lidar reader_;
  bool begins_within_ = false;  // there is something before the first bytes that are copied
  bool has_begun_ = false;
};

}  // namespace g4lidar
