// SPDX-License-Identifier: MIT
#include "g4lidar/recording/raw_bytes.hpp"

#include <cstddef>
#include <utility>
#include <variant>

#include "g4lidar/core/response.hpp"

namespace g4lidar {
namespace {

const response_layout& layout_of(response_kind kind) noexcept {
  return response_layouts[static_cast<std::size_t>(kind)];
}

void append(std::vector<std::uint8_t>& out, bytes data) {
  out.insert(out.end(), data.begin(), data.end());
}

/// The content of an answer to 93 of a lidar like `model`: the nearest number of its unit.
std::int32_t reply_of(zero_angle angle, const model& model) noexcept {
  const int hundredths = angle.cdeg * model.zero_angle_divisor;
  return (hundredths + (hundredths < 0 ? -50 : 50)) / 100;
}

}  // namespace

raw_copy::raw_copy(const model& model, const device_information& information)
    : which_(&model),
      parser_(model.samples),
      source_{.like = &with_firmware(model, information), .who = information},
      reader_{.like = &model} {}

void raw_copy::known_lidar::take(const event& found, const model& named) noexcept {
  const auto* const heard = std::get_if<response_view>(&found);
  if (heard == nullptr) return replies.pass();
  const auto stated = replies.take(*heard, *like);
  if (stated.firmware) {
    who = *stated.firmware;
    like = &with_firmware(named, who);
  }
  if (stated.zero) zero.set(*stated.zero, zero_offset::stated_by::device);
}

void raw_copy::take(const event& found, bool is_wanted) {
  source_.take(found, *which_);
  if (is_wanted) reader_.take(found, *which_);
}

bool raw_copy::is_zero_missing() const noexcept {
  const auto& known = source_.zero.angle();
  const auto& read = reader_.zero.angle();
  return known && reader_.like->zero_angle_divisor != 0 &&
         (!read || reply_of(*read, *reader_.like) != reply_of(*known, *reader_.like));
}

void raw_copy::put_information(std::vector<std::uint8_t>& out) {
  const device_information& who = source_.who;
  const std::size_t from = out.size();
  append(out, layout_of(response_kind::device_info).header);
  out.insert(out.end(), {who.model, who.firmware_minor, who.firmware_major, who.hardware});
  for (const char digit : who.serial_digits) {
    out.push_back(static_cast<std::uint8_t>(digit >= '0' && digit <= '9' ? digit - '0' : 0));
  }
  if (const auto made = response_view::from(bytes(out).subspan(from))) {
    reader_.take(event(*made), *which_);
  }
}

void raw_copy::put_zero(bool with_header, std::vector<std::uint8_t>& out) {
  const auto report = [&](std::size_t from) {
    if (const auto made = response_view::from(bytes(out).subspan(from), true)) {
      reader_.take(event(*made), *which_);
    }
  };
  std::size_t from = out.size();
  if (with_header) {
    append(out, layout_of(response_kind::scan_started).header);
    report(from);
  }
  from = out.size();
  append(out, layout_of(response_kind::frequency).header);
  // NOLINTNEXTLINE(bugprone-unchecked-optional-access): it is missing
  const auto number = static_cast<std::uint32_t>(reply_of(*source_.zero.angle(), *reader_.like));
  for (unsigned i = 0; i < 4; ++i) out.push_back(static_cast<std::uint8_t>(number >> 8U * i));
  report(from);
}

void raw_copy::received(bytes data, bool is_wanted, std::vector<std::uint8_t>& out) {
  begins_within_ = begins_within_ || (!is_wanted && !has_begun_);
  if (is_wanted && !std::exchange(has_begun_, true) && begins_within_) {
    const bool is_default = *which_ == g4_model;
    if (!is_default && which_->link == link_kind::two_way && source_.who.is_known()) {
      put_information(out);
    }
    if (is_zero_missing()) put_zero(true, out);
  }
  std::size_t copied = 0;
  bytes rest = data;
  while (const auto found = parser_.next(rest)) {
    take(*found, is_wanted);
    const auto* const heard = std::get_if<response_view>(&*found);
    const bool is_header = heard != nullptr && heard->kind() == response_kind::scan_started;
    const bool is_packet = std::get_if<packet_view>(&*found) != nullptr;
    if (!is_wanted || !(is_header || is_packet) || parser_.held() != 0 || !is_zero_missing()) {
      continue;
    }
    const std::size_t end = data.size() - rest.size();
    append(out, data.subspan(copied, end - copied));
    copied = end;
    put_zero(!is_header, out);
  }
  if (is_wanted) append(out, data.subspan(copied));
}

void raw_copy::take(const recorded_item& item, bool is_wanted, std::vector<std::uint8_t>& out) {
  switch (item.what) {
    case recorded_item::kind::from_device:
      return received(item.data, is_wanted, out);
    case recorded_item::kind::to_device:
      return source_.replies.sent(item.data);
    case recorded_item::kind::other: {
      const recorded_event& what = item.other;
      if (what.zero) source_.zero.set(*what.zero, zero_offset::stated_by::recording);
      using enum recorded_event::kind;
      begins_within_ = begins_within_ || (what.what == state && what.delivers && !has_begun_);
      const bool ends = what.what == cut || what.what == gap || what.what == closed;
      while (ends) {
        const auto found = parser_.finish();
        if (!found) break;
        take(*found, is_wanted);
      }
      return;
    }
    case recorded_item::kind::odometry:
      return;
  }
}

}  // namespace g4lidar
