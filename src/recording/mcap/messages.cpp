// SPDX-License-Identifier: MIT
#include "messages.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>

#include "core/enumerators.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "message/cdr.hpp"

namespace g4lidar {
namespace {

constexpr std::array<std::string_view, 11> event_names{"opened",   "closed",  "sent",    "begun",
                                                       "held",     "cut",     "gap",     "state",
                                                       "odometry", "dtr_low", "dtr_high"};

}  // namespace

std::string_view name_of(recorded_event::kind what) noexcept {
  return detail::name_in(event_names, what);
}

namespace mcap {
namespace {

std::optional<problem> problem_named(std::string_view name) noexcept {
  for (std::size_t i = 0; i < problem_count; ++i) {
    if (name_of(static_cast<problem>(i)) == name) return static_cast<problem>(i);
  }
  return std::nullopt;
}

}  // namespace

void put_recorded_bytes(record_text& out, bytes data, std::int64_t time_ns) {
  g4lidar::put_recorded_bytes(data, time_ns, out.memory());
}

void put_event(record_text& out, const recorded_event& event, std::int64_t wall_ahead_ns) {
  cdr_writer message(out.memory());
  message.put(event.time_ns);
  message.put(wall_ahead_ns);
  message.put(event.baud);
  message.put(event.sample_rate_hz);
  message.put(event.unparsed);
  message.put(event.events);
  message.put(std::uint8_t{event.delivers});
  message.put(name_of(event.what));
  message.put(name_of(event.reason));
  message.put(event.name.substr(0, longest_name));
  message.put(std::uint8_t{event.zero.has_value()});
  message.put(event.zero.value_or(zero_angle{}).cdeg);
  message.put(std::uint8_t{event.counts_times});
}

std::optional<recorded_bytes> recorded_bytes_from(bytes message) noexcept {
  if (message.size() < recorded_bytes_header_size || message[1] != 1) return std::nullopt;
  const std::uint32_t count = load_u32(message, 12);
  if (count > message.size() - recorded_bytes_header_size) return std::nullopt;
  return recorded_bytes{static_cast<std::int64_t>(load_u64(message, 4)),
                        message.subspan(recorded_bytes_header_size, count)};
}

/// A G4 has 9000; much larger values are never written by this library, and no clock could use
/// them.
constexpr std::uint32_t max_sample_rate_hz = 1'000'000;

std::optional<recorded_event> event_from(bytes message) noexcept {
  if (message.size() < 4 || message[1] != 1) return std::nullopt;
  field_reader fields(message.subspan(4));
  recorded_event made{};
  made.time_ns = static_cast<std::int64_t>(fields.take<std::uint64_t>());
  static_cast<void>(fields.take<std::uint64_t>());  // the wall clock is that of the message
  made.baud = fields.take<std::uint32_t>();
  made.sample_rate_hz = fields.take<std::uint32_t>();
  made.unparsed = fields.take<std::uint32_t>();
  made.events = fields.take<std::uint32_t>();
  made.delivers = fields.take<std::uint8_t>() != 0;
  const std::string_view what = fields.take_cdr_text();
  made.reason = problem_named(fields.take_cdr_text()).value_or(problem::system);
  made.name = fields.take_cdr_text();
  const auto* const named = std::ranges::find(event_names, what);
  if (!fields.is_good() || named == event_names.end()) return std::nullopt;
  made.what = static_cast<recorded_event::kind>(named - event_names.begin());
  if (!fields.is_at_end()) {  // older recordings end here
    constexpr std::int32_t turn_cdeg = 36'000;
    const bool has_zero = fields.take<std::uint8_t>() != 0;
    fields.align(sizeof(std::int32_t));
    const auto cdeg = static_cast<std::int32_t>(fields.take<std::uint32_t>());
    if (!fields.is_good()) return std::nullopt;
    if (has_zero && cdeg >= -turn_cdeg && cdeg <= turn_cdeg) made.zero = zero_angle{cdeg};
    made.counts_times = !fields.is_at_end() && fields.take<std::uint8_t>() != 0;
  }
  if (made.sample_rate_hz > max_sample_rate_hz) return std::nullopt;
  if (made.what == recorded_event::kind::begun && made.sample_rate_hz == 0) return std::nullopt;
  // These have channels of their own.
  const bool is_event =
      made.what != recorded_event::kind::sent && made.what != recorded_event::kind::odometry;
  return is_event ? std::optional(made) : std::nullopt;
}

std::optional<stamped_odometry> odometry_from(bytes message) noexcept {
  if (message.size() < 4 || message[1] != 1) return std::nullopt;
  field_reader fields(message.subspan(4));
  const auto number = [&fields] { return std::bit_cast<double>(fields.take<std::uint64_t>()); };
  constexpr std::size_t covariance_size = 36 * sizeof(double);
  const auto seconds = static_cast<std::int32_t>(fields.take<std::uint32_t>());
  const auto rest_ns = fields.take<std::uint32_t>();
  static_cast<void>(fields.take_cdr_text());
  static_cast<void>(fields.take_cdr_text());
  fields.align(sizeof(double));
  std::array<double, 7> pose{};  // x, y, z, and the quaternion x, y, z, w
  std::ranges::generate(pose, number);
  static_cast<void>(fields.take(covariance_size));
  std::array<double, 6> twist{};
  std::ranges::generate(twist, number);
  static_cast<void>(fields.take(covariance_size));
  if (!fields.is_good() || !fields.is_at_end() || rest_ns >= 1'000'000'000) return std::nullopt;
  return planar_odometry(std::int64_t{seconds} * 1'000'000'000 + rest_ns, pose, twist);
}

// ---- transport_state --------------------------------------------------------------------------------

void transport_state::take(const recorded_event& what) noexcept {
  using enum recorded_event::kind;
  is_known = true;
  if (what.zero) zero = what.zero;
  if (what.what == opened || what.what == state) {
    baud = what.baud;
    name_size = static_cast<std::uint8_t>(std::min(what.name.size(), name.size()));
    std::copy_n(what.name.begin(), name_size, name.begin());
  }
  switch (what.what) {
    case opened:
      is_open = true;
      delivers = true;  // if no driver has recorded otherwise
      break;
    case closed:
      is_open = false;
      delivers = false;
      break;
    case state:
      is_open = what.reason != problem::gone;
      [[fallthrough]];
    case begun:
      sample_rate_hz = what.sample_rate_hz;
      counts_times = what.counts_times;
      delivers = what.delivers;
      break;
    case held:
      delivers = false;
      break;
    case sent:
    case cut:
    case gap:
    case odometry:
    case dtr_low:
    case dtr_high:
      break;
  }
}

recorded_event transport_state::as_event(std::int64_t time_ns) const noexcept {
  recorded_event made{.what = recorded_event::kind::state, .time_ns = time_ns};
  made.reason = is_open ? problem::cancelled : problem::gone;
  made.delivers = delivers;
  made.baud = baud;
  made.sample_rate_hz = sample_rate_hz;
  made.name = transport_name();
  made.zero = zero;
  made.counts_times = counts_times;
  return made;
}

}  // namespace mcap

void put_recorded_bytes(bytes data, std::int64_t time_ns, std::vector<std::uint8_t>& out) {
  cdr_writer message(out);
  message.put(time_ns);
  message.put(data);
}

}  // namespace g4lidar
