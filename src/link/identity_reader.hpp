// SPDX-License-Identifier: MIT
// What a lidar reports about itself without being asked.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <variant>

#include "g4lidar/core/ct_information.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

/// The health by CT bytes.
[[nodiscard]] constexpr health health_of(const ct_information& found) noexcept {
  const bool is_ok = found.faults == ct_faults::none;
  return {is_ok ? health_status::ok : health_status::error,
          static_cast<std::uint8_t>(found.faults)};
}

/// *Single thread, never allocates.* A device information comes after power-on, and from some two-way
/// lidars behind the scan header. One-way lidars put what they know into CT bytes.
class identity_reader {
 public:
  /// `reads_ct`: CT bytes are read, too; a two-way lidar answers instead.
  explicit identity_reader(const model& model, bool reads_ct) noexcept
      : which_(&model), reads_ct_(reads_ct) {}
  explicit identity_reader(const model& model) noexcept
      : identity_reader(model, model.link == link_kind::one_way) {}

  void take(const event& found) noexcept {
    if (const auto* const packet = std::get_if<packet_view>(&found)) {
      if (!packet->is_suspect()) ++packets_;
      // NOLINTNEXTLINE(bugprone-unchecked-optional-access): checked in the same expression
      if (reads_ct_ && in_ct_.add(*packet)) take_ct(*in_ct_.last());
    } else if (const auto* const gone = std::get_if<skipped>(&found)) {
      in_ct_.add(*gone);
    } else if (const auto* const heard = std::get_if<response_view>(&found)) {
      if (const auto who = heard->as_device_info()) set(*who);
    }
  }
  /// Another transport follows.
  void reset() noexcept { *this = identity_reader(*which_, reads_ct_); }

  /// The valid packets.
  [[nodiscard]] std::uint64_t packets() const noexcept { return packets_; }
  /// The last information.
  [[nodiscard]] const std::optional<device_information>& who() const noexcept { return who_; }
  /// The last health, from CT bytes.
  [[nodiscard]] const std::optional<health>& condition() const noexcept { return condition_; }
  /// Whether who() has a number that no lidar like the model has.
  [[nodiscard]] bool has_other_number() const noexcept {
    return who_ && !detail::may_report(*which_, who_->model);
  }
  /// Whether who() has changed since the last call.
  [[nodiscard]] bool take_news() noexcept { return std::exchange(is_new_, false); }

 private:
  void set(const device_information& who) noexcept {
    if (who_ == who) return;
    who_ = who;
    is_new_ = true;
  }
  /// What CT bytes do not state stays as it was.
  void take_ct(const ct_information& found) noexcept {
    if (found.has_faults) condition_ = health_of(found);
    device_information who = information_of(found, *which_);
    if (!who.is_known()) return;
    if (who_ && !found.has_firmware) {
      who.hardware = who_->hardware;
      who.firmware_major = who_->firmware_major;
      who.firmware_minor = who_->firmware_minor;
    }
    if (who_ && !found.has_serial) who.serial_digits = who_->serial_digits;
    set(who);
  }

  const model* which_;
  bool reads_ct_;
  ct_information_reader in_ct_;
  std::uint64_t packets_ = 0;
  std::optional<device_information> who_;
  std::optional<health> condition_;
  bool is_new_ = false;
};

}  // namespace g4lidar
