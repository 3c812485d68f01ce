// SPDX-License-Identifier: MIT
#include "metadata.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/response.hpp"

namespace g4lidar {

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

void take_serial(device_information& information, std::string_view text) noexcept {
  const bool is_digits =
      text.size() == information.serial_digits.size() &&
      std::ranges::all_of(text, [](char digit) { return digit >= '0' && digit <= '9'; });
  if (is_digits) std::ranges::copy(text, information.serial_digits.begin());
}

void take_firmware(device_information& information, std::string_view text) noexcept {
  const std::size_t dot = std::min(text.find('.'), text.size());
  information.firmware_major = number_in<std::uint8_t>(text.substr(0, dot)).value_or(0);
  if (dot < text.size()) {
    information.firmware_minor = number_in<std::uint8_t>(text.substr(dot + 1)).value_or(0);
  }
}

/// From what the model of the recorded lidar was known.
known_by known_by_from(std::string_view word) {
  constexpr std::array all{known_by::user, known_by::recording, known_by::number,
                           known_by::samples};
  const auto* const at = std::ranges::find(all, word, [](known_by each) { return name_of(each); });
  return at == all.end() ? known_by::nothing : *at;
}

/// "x2 x3".
std::string words_in(const model_set& all) {
  std::string text;
  for (std::size_t at = 0; at < models.size(); ++at) {
    if (!all[at]) continue;
    if (!text.empty()) text += ' ';
    text += models[at].word;
  }
  return text;
}

/// Without those that this version does not know.
model_set models_from(std::string_view text) {
  model_set all;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const model* const row = model_named(text.substr(0, end));
    all |= set_of(std::span(&row, 1));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return all;
}

}  // namespace

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
    if (device.candidates.any()) words.emplace_back("candidates", words_in(device.candidates));
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

recorded_device joined(const recorded_device& before, const recorded_device& known) {
  recorded_device both = known;
  const auto keep = [&](auto part) {
    if (!(both.*part)) both.*part = before.*part;
  };
  if (!known.recognised) both.candidates = before.candidates;
  keep(&recorded_device::recognised);
  keep(&recorded_device::sample_rate);
  keep(&recorded_device::frequency);
  keep(&recorded_device::motor);
  keep(&recorded_device::constant);
  keep(&recorded_device::idle);
  keep(&recorded_device::protection);
  if (!known.information.is_known()) both.information = before.information;
  return both;
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
    if (name == "candidates") device.candidates = models_from(value);
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

}  // namespace mcap
}  // namespace g4lidar
