// SPDX-License-Identifier: MIT
#include "subject.hpp"

namespace g4lidar {
namespace {

std::string_view words_of(ask what) noexcept {
  switch (what) {
    case ask::device_info:
      return "device information";
    case ask::health:
      return "health";
    case ask::get_low_power:
    case ask::set_low_power:
      return "low power";
    case ask::get_direction:
    case ask::set_direction:
      return "direction";
    case ask::get_scan_frequency:
    case ask::step_scan_frequency:
    case ask::set_scan_frequency:
      return "scan frequency";
    case ask::set_constant_frequency:
      return "constant frequency";
    case ask::get_ranging:
    case ask::set_ranging:
      return "ranging frequency";
    case ask::set_protection:
      return "power-down protection";
    case ask::restart:
      return "restart";
    case ask::start:
    case ask::stop:
      break;
  }
  return {};
}

std::string_view words_of(ranging_frequency value) noexcept {
  switch (value) {
    case ranging_frequency::khz_4:
      return " 4 kHz";
    case ranging_frequency::khz_8:
      return " 8 kHz";
    case ranging_frequency::khz_9:
      return " 9 kHz";
  }
  return {};
}

}  // namespace

subject& subject::add(const request& wanted) noexcept {
  const std::string_view what = words_of(wanted.what);
  if (what.empty()) return *this;
  add(", ").add(what);
  if (wanted.what == ask::set_scan_frequency) return add(" ").add(scan_frequency{wanted.value});
  if (wanted.what == ask::set_ranging) {
    return add(words_of(static_cast<ranging_frequency>(wanted.value)));
  }
  return *this;
}

}  // namespace g4lidar
