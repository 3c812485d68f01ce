// SPDX-License-Identifier: MIT
#include "messages.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/detail/enumerators.hpp"
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

std::string_view computed_with() noexcept {
#if defined(__x86_64__)
  return "x86_64";
#elif defined(__aarch64__)
  return "aarch64";
#elif defined(__arm__)
  return "arm";
#elif defined(__i386__)
  return "i386";
#elif defined(__riscv)
  return "riscv";
#elif defined(__s390x__)
  return "s390x";
#else
  return "portable";
#endif
}

namespace mcap {
namespace {

std::optional<problem> problem_named(std::string_view name) noexcept {
  for (std::size_t i = 0; i < problem_count; ++i) {
    if (name_of(static_cast<problem>(i)) == name) return static_cast<problem>(i);
  }
  return std::nullopt;
}

template <class Number>
std::optional<Number> number_in(std::string_view text, int base = 10) noexcept {
  Number value{};
  const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (wrong != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class Take>
void for_each_word(field_reader& map, Take take) {
  field_reader words(map.take(map.take<std::uint32_t>()));
  while (!words.is_at_end() && words.is_good()) {
    const std::string_view name = words.take_text();
    take(name, words.take_text());
  }
}

template <class Setting>
void put_setting(word_map& words, const char* name, const std::optional<Setting>& value) {
  if (value) words.emplace_back(name, std::to_string(static_cast<unsigned>(*value)));
}

template <class Setting>
void take_setting(std::optional<Setting>& setting, std::string_view text) noexcept {
  const auto value = number_in<std::uint8_t>(text);
  setting = value ? reply_byte<Setting>(*value) : std::nullopt;
}

/// As older versions wrote it: 0, 1 and 2 are the rates of a G4.
std::string rate_text(sample_rate rate) {
  const std::uint8_t code = code_of_rate(g4_model, to_hz(rate));
  return std::to_string(code < g4_model.rates.entries.size() ? code : to_hz(rate));
}
std::optional<sample_rate> rate_from(std::string_view text) noexcept {
  const auto value = number_in<std::uint16_t>(text);
  if (!value) return std::nullopt;
  const bool is_code = *value < g4_model.rates.entries.size();
  return static_cast<sample_rate>(is_code ? g4_model.rates.entries[*value].hz : *value);
}

void take_serial(device_information& who, std::string_view text) noexcept {
  const bool is_digits =
      text.size() == who.serial_digits.size() &&
      std::ranges::all_of(text, [](char digit) { return digit >= '0' && digit <= '9'; });
  if (is_digits) std::ranges::copy(text, who.serial_digits.begin());
}

void take_firmware(device_information& who, std::string_view text) noexcept {
  const std::size_t dot = std::min(text.find('.'), text.size());
  who.firmware_major = number_in<std::uint8_t>(text.substr(0, dot)).value_or(0);
  if (dot < text.size()) {
    who.firmware_minor = number_in<std::uint8_t>(text.substr(dot + 1)).value_or(0);
  }
}

/// From what the model of the recorded lidar was known.
known_by known_by_from(std::string_view word) {
  constexpr std::array all{known_by::user, known_by::recording, known_by::number,
                           known_by::samples};
  const auto* const at = std::ranges::find(all, word, [](known_by each) { return name_of(each); });
  return at == all.end() ? known_by::nothing : *at;
}

}  // namespace

void put_recorded_bytes(record_text& out, bytes data, std::int64_t time_ns) {
  g4lidar::put_recorded_bytes(data, time_ns, out.memory());
}

void put_event(record_text& out, const recorded_event& what, std::int64_t wall_ahead_ns) {
  cdr_writer message(out.memory());
  message.put(what.time_ns);
  message.put(wall_ahead_ns);
  message.put(what.baud);
  message.put(what.sample_rate_hz);
  message.put(what.unparsed);
  message.put(what.events);
  message.put(std::uint8_t{what.delivers});
  message.put(name_of(what.what));
  message.put(name_of(what.reason));
  message.put(what.name.substr(0, longest_name));
  message.put(std::uint8_t{what.zero.has_value()});
  message.put(what.zero.value_or(zero_angle{}).cdeg);
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

void put_map(record_text& out, const word_map& words) {
  const std::size_t map = out.begin<std::uint32_t>();
  for (const auto& [name, value] : words) {
    out.put(std::string_view(name));
    out.put(std::string_view(value));
  }
  out.end<std::uint32_t>(map);
}

std::string word_in(field_reader map, std::string_view name) {
  std::string found;
  for_each_word(map, [&](std::string_view each, std::string_view value) {
    if (each == name) found = value;
  });
  return found;
}

word_map words_of(const recorded_device& device) {
  const device_information& who = device.information;
  word_map words{
      {"model", std::to_string(who.model)},
      {"firmware", std::to_string(who.firmware_major) + "." + std::to_string(who.firmware_minor)},
      {"hardware", std::to_string(who.hardware)},
      {"serial_number", std::string(who.serial_number())},
  };
  if (const auto& read = device.recognised; read && read->model != nullptr) {
    if (!who.is_known()) words.clear();
    words.emplace_back("read_as", read->model->word);
    words.emplace_back("known_by", name_of(read->by));
    words.emplace_back("number", std::to_string(read->number));
    words.emplace_back("baud", std::to_string(read->baud));
    words.emplace_back("is_silent", read->is_silent ? "yes" : "no");
    if (read->speaks_telnet) words.emplace_back("speaks_telnet", "yes");
  }
  if (device.frequency) words.emplace_back("frequency_chz", std::to_string(device.frequency->chz));
  if (device.sample_rate) words.emplace_back("sample_rate", rate_text(*device.sample_rate));
  put_setting(words, "motor_direction", device.motor);
  put_setting(words, "constant_frequency", device.constant);
  put_setting(words, "low_power", device.idle);
  put_setting(words, "power_down_protection", device.protection);
  return words;
}

recorded_device device_of(field_reader& map) {
  recorded_device device;
  recognition read;
  device_information& who = device.information;
  who.serial_digits.fill('0');
  for_each_word(map, [&](std::string_view name, std::string_view value) {
    if (name == "model") who.model = number_in<std::uint8_t>(value).value_or(0);
    if (name == "firmware") take_firmware(who, value);
    if (name == "hardware") who.hardware = number_in<std::uint8_t>(value).value_or(0);
    if (name == "serial_number") take_serial(who, value);
    const auto chz = name == "frequency_chz" ? number_in<std::uint16_t>(value) : std::nullopt;
    if (chz) device.frequency = scan_frequency{*chz};
    if (name == "sample_rate" || name == "ranging") device.sample_rate = rate_from(value);
    if (name == "motor_direction") take_setting(device.motor, value);
    if (name == "constant_frequency") take_setting(device.constant, value);
    if (name == "low_power") take_setting(device.idle, value);
    if (name == "power_down_protection") take_setting(device.protection, value);
    if (name == "read_as") read.model = model_named(value);
    if (name == "known_by") read.by = known_by_from(value);
    if (name == "number") read.number = number_in<std::uint8_t>(value).value_or(0);
    if (name == "baud") read.baud = number_in<std::uint32_t>(value).value_or(0);
    if (name == "is_silent") read.is_silent = value == "yes";
    if (name == "speaks_telnet") read.speaks_telnet = value == "yes";
  });
  if (read.model != nullptr) device.recognised = read;
  return device;
}

recorded_digest digest_of(field_reader& map, std::int64_t& last_ns) {
  recorded_digest found{.is_same_version = false};
  for_each_word(map, [&](std::string_view name, std::string_view value) {
    if (name == "payload") found.payload = number_in<std::uint64_t>(value, 16).value_or(0);
    if (name == "points") found.points = number_in<std::uint64_t>(value, 16).value_or(0);
    if (name == "point_count") found.point_count = number_in<std::uint64_t>(value).value_or(0);
    if (name == "computed_with") found.is_comparable = value == computed_with();
    if (name == "points_version") found.is_same_version = value == points_version;
    if (name == "last_ns") last_ns = number_in<std::int64_t>(value).value_or(0);
  });
  return found;
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
  return made;
}

}  // namespace mcap

void put_recorded_bytes(bytes data, std::int64_t time_ns, std::vector<std::uint8_t>& out) {
  cdr_writer message(out);
  message.put(time_ns);
  message.put(data);
}

}  // namespace g4lidar
