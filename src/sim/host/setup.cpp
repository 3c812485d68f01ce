// SPDX-License-Identifier: MIT
// The names in the text of a setup in one table, and the files that it names.
#include "g4lidar/sim/setup.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <system_error>
#include <type_traits>
#include <utility>

#include "g4lidar/core/label.hpp"
#include "sim/read_time.hpp"
#include "sim/world/world_text.hpp"
#include "transport/text_file.hpp"

namespace g4lidar::sim {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view prefix = "sim:";

// Members of device_options with a name in texts; where that is their unit, they are times.
using options = device_options;
using stored = device_settings;
using member =
    std::variant<std::int64_t options::*, std::uint32_t options::*, std::uint16_t options::*,
                 std::int32_t options::*, bool options::*, turning options::*, at_limit options::*,
                 disturbance options::*, drive options::*, dtr_start options::*, dtr_cut options::*,
                 low_power stored::*, motor_direction stored::*, constant_frequency stored::*,
                 power_down_protection stored::*, health_status health::*>;
constexpr std::array<std::pair<std::string_view, member>, 55> members{{
    {"baud", &options::baud},
    {"batch_min_ns", &options::batch_min_ns},
    {"batch_max_ns", &options::batch_max_ns},
    {"any_baud", &options::any_baud},
    {"reaction_ns", &options::reaction_ns},
    {"first_answer_ns", &options::first_answer_ns},
    {"header_ns", &options::header_ns},
    {"silence_ns", &options::silence_ns},
    {"stop_ns", &options::stop_ns},
    {"acceleration_mhz_per_s", &options::acceleration_mhz_per_s},
    {"standstill_ns", &options::standstill_ns},
    {"motor_drift_ppm", &options::motor_drift_ppm},
    {"free_motor_drift_ppm", &options::free_motor_drift_ppm},
    {"motor_drift_period_ns", &options::motor_drift_period_ns},
    {"counter_clockwise", &options::counter_clockwise},
    {"stray_after_start", &options::stray_after_start},
    {"stray_before_zero", &options::stray_before_zero},
    {"ct_crc", &options::ct_crc},
    {"ct_information", &options::ct_information},
    {"one_way", &options::one_way},
    {"driven_by", &options::driven_by},
    {"dtr_starts_by", &options::dtr_starts_by},
    {"dtr_cuts", &options::dtr_cuts},
    {"dtr_low_ns", &options::dtr_low_ns},
    {"motor_has_power", &options::motor_has_power},
    {"time_packet_ns", &options::time_packet_ns},
    {"empty_packets", &options::empty_packets},
    {"stop_truncates", &options::stop_truncates},
    {"boot_text", &options::boot_text},
    {"boot_information", &options::boot_information},
    {"boot_ns", &options::boot_ns},
    {"frequency_at_limit", &options::frequency_at_limit},
    {"highest_frequency_chz", &options::highest_frequency_chz},
    {"while_scanning", &options::while_scanning},
    {"settings_outlive_power", &options::settings_outlive_power},
    {"settings_outlive_restart", &options::settings_outlive_restart},
    {"answers_direction", &options::answers_direction},
    {"answers_sample_rate", &options::answers_sample_rate},
    {"other_rate_codes", &options::other_rate_codes},
    {"zero_angle_cdeg", &options::zero_angle_cdeg},
    {"pitch_cdeg", &options::pitch_cdeg},
    {"health", &health::status},
    {"answers_health_91", &options::answers_health_91},
    {"answers_health_92", &options::answers_health_92},
    {"obeys_forced_stop", &options::obeys_forced_stop},
    {"obeys_restart_80", &options::obeys_restart_80},
    {"obeys_restart_40", &options::obeys_restart_40},
    {"error_refuses_start", &options::error_refuses_start},
    {"start_again_answers", &options::start_again_answers},
    {"header_after_protection", &options::header_after_protection},
    {"initial_idle_power", &stored::idle_power},
    {"initial_direction", &stored::direction},
    {"initial_constancy", &stored::constancy},
    {"initial_protection", &stored::protection},
    {"boots_at_start", &options::boots_at_start},
}};

template <class Value>
Value& at(options& device, Value options::* place) noexcept {
  return device.*place;
}
template <class Value>
Value& at(options& device, Value health::* place) noexcept {
  return device.condition.*place;
}
template <class Value>
Value& at(options& device, Value stored::* place) noexcept {
  return device.initial.*place;
}

// The words of an enumeration, in its order.
using namespace std::string_view_literals;
constexpr auto words_of(turning) { return std::array{"clockwise"sv, "mirrored"sv, "falling"sv}; }
constexpr auto words_of(health_status) { return std::array{"ok"sv, "warning"sv, "error"sv}; }
constexpr auto words_of(at_limit) { return std::array{"clamp"sv, "refuse"sv}; }
constexpr auto words_of(disturbance) {
  return std::array{"mid_packet"sv, "between"sv, "drops"sv, "ignored"sv};
}
constexpr auto words_of(drive) { return std::array{"commands"sv, "dtr_line"sv, "power"sv}; }
constexpr auto words_of(dtr_start) { return std::array{"level"sv, "edge"sv, "pulse"sv}; }
constexpr auto words_of(dtr_cut) { return std::array{"motor"sv, "supply"sv}; }
constexpr auto words_of(low_power) { return std::array{"off"sv, "on"sv}; }
constexpr auto words_of(motor_direction) {
  return std::array{"clockwise"sv, "counter_clockwise"sv};
}
constexpr auto words_of(constant_frequency) { return std::array{"off"sv, "on"sv}; }
constexpr auto words_of(power_down_protection) { return std::array{"on"sv, "off"sv}; }
constexpr auto words_of(bool) { return std::array{"false"sv, "true"sv}; }

std::string refused(std::string_view value, std::string_view why) {
  constexpr std::size_t enough = 60;
  return quoted(value, enough) + " " + std::string(why);
}

std::string read_into(std::int64_t& time_ns, std::string_view value) {
  const bool has_unit = value.empty() || value.back() < '0' || value.back() > '9';
  const auto read = read_time_ns(std::string(value) + (has_unit ? "" : "s"));
  if (!read) return refused(value, "is not a time such as 10s, 500ms or 2min");
  time_ns = *read;
  return {};
}

template <class Value>
  requires(std::is_enum_v<Value> || std::is_same_v<Value, bool>)
std::string read_into(Value& chosen, std::string_view value) {
  constexpr auto words = words_of(Value{});
  const auto found = std::find(words.begin(), words.end(), value);
  if (found != words.end()) {
    chosen = static_cast<Value>(found - words.begin());
    return {};
  }
  std::string known(words.front());
  for (std::size_t i = 1; i < words.size(); ++i) known.append(", ").append(words[i]);
  return refused(value, "is not one of " + known);
}

template <class Number>
std::string read_into(Number& number, std::string_view value) {
  const char* const end = value.data() + value.size();
  const auto [at, error] = std::from_chars(value.data(), end, number);
  if (error == std::errc() && at == end) return {};
  return refused(value, "is not in the range " +
                            std::to_string(std::numeric_limits<Number>::min()) + " to " +
                            std::to_string(std::numeric_limits<Number>::max()));
}

std::string add_fault(std::vector<fault>& faults, std::string_view value) {
  const auto read = parse_fault(value);
  const auto* const wrong = std::get_if<fault_error>(&read);
  if (wrong != nullptr) return std::string(value) + ": " + wrong->message;
  faults.push_back(std::get<fault>(read));
  return {};
}

// The text of read_into(), with the name of what was to be read.
std::string named(std::string_view name, const std::string& wrong) {
  return wrong.empty() ? wrong : std::string(name) + ": " + wrong;
}

std::string set_member(device_options& device, std::string_view name, std::string_view value) {
  for (const auto& [each, place] : members) {
    if (each == name) {
      return named(
          name, std::visit([&](auto found) { return read_into(at(device, found), value); }, place));
    }
  }
  return refused(
      name,
      "is not one of fault, firmware, model, model_id, other_layout, path, seed, serial, "
      "world, or of those in docs/sim_device.md");
}

// "3.2"
std::string read_firmware(device_information& info, std::string_view value) {
  const std::string_view major = value.substr(0, value.find('.'));
  const std::string_view minor = value.substr(std::min(major.size() + 1, value.size()));
  const bool is_read = read_into(info.firmware_major, major).empty() &&
                       read_into(info.firmware_minor, minor).empty();
  return is_read ? "" : refused(value, "is not a firmware version such as 3.2");
}

std::string read_model(setup& into, std::string_view value) {
  if (use_model(into.device, value, into.other_layout)) {
    into.model = into.device.model;
    return {};
  }
  if (const auto why = why_unsupported(value); !why.empty())
    return refused(value, std::string("is not supported: ").append(why));
  std::string known;
  for (const std::string_view word : model_words()) {
    if (is_label_of(value, word)) return refused(value, "has one layout of samples only");
    known.append(known.empty() ? "" : ", ").append(word);
  }
  return refused(value, "is not one of " + known);
}

// The order in which the parts of a text are taken: what selects a model, the model, what changes it.
int turn_of(std::string_view word) noexcept {
  if (word.starts_with("firmware=") || word.starts_with("other_layout=")) return 0;
  return word.starts_with("model=") ? 1 : 2;
}

// "a%41" is "aA".
std::string decoded(std::string_view coded) {
  std::string text;
  for (std::size_t i = 0; i < coded.size(); ++i) {
    const char* const digits = coded.data() + i + 1;
    unsigned char byte = 0;
    if (coded[i] == '%' && i + 2 < coded.size() &&
        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      text += static_cast<char>(byte);
      i += 2;
    } else {
      text += coded[i];
    }
  }
  return text;
}

std::optional<world_error> read_text(const std::string& file, std::string& text) {
  const std::string why = read_text_file(file, text);
  if (why.empty()) return std::nullopt;
  return world_error{0, "it " + why};
}

}  // namespace

std::string set(setup& into, std::string_view word) {
  const std::string_view name = word.substr(0, word.find('='));
  const std::string_view value = word.substr(std::min(name.size() + 1, word.size()));
  if (name == "world") {
    into.world_file = value;
    return {};
  }
  if (name == "path") {
    into.path_file = value;
    return {};
  }
  if (name == "seed") return named(name, read_into(into.device.scanner.seed, value));
  if (name == "other_layout") return named(name, read_into(into.other_layout, value));
  if (name == "model") return named(name, read_model(into, value));
  if (name == "model_id") return named(name, read_into(into.device.info.model, value));
  if (name == "firmware") return read_firmware(into.device.info, value);
  if (name == "fault") return add_fault(into.faults, value);
  if (name != "serial") return set_member(into.device, name, value);
  auto& digits = into.device.info.serial_digits;
  if (value.size() != digits.size() || value.find_first_not_of("0123456789") != value.npos) {
    return refused(value, "is not a serial number: a serial number has 16 decimal digits");
  }
  std::copy(value.begin(), value.end(), digits.begin());
  return {};
}

bool is_simulated(std::string_view source) noexcept { return source.starts_with(prefix); }

std::variant<setup, setup_error> parse_setup(std::string_view source) {
  if (!is_simulated(source)) return setup_error{refused(source, "does not begin with sim:")};
  source.remove_prefix(prefix.size());
  if (source.starts_with('?')) source.remove_prefix(1);
  std::vector<std::string> words;
  while (!source.empty()) {
    const std::string_view piece = source.substr(0, source.find('&'));
    source.remove_prefix(std::min(piece.size() + 1, source.size()));
    words.push_back(decoded(piece));
  }
  // std::stable_sort uses a deprecated function, which clang reports.
  std::multimap<int, std::string_view> in_order;
  for (const std::string& word : words) in_order.emplace(turn_of(word), word);
  setup read;
  for (const auto& [turn, word] : in_order) {
    if (std::string wrong = set(read, word); !wrong.empty()) return setup_error{wrong};
  }
  const std::string_view problem = problem_with(read.device);
  if (!problem.empty()) return setup_error{std::string(problem)};
  return read;
}

std::variant<world, world_error> load_world(const std::string& file) {
  if (file.empty()) return built_in_world();
  std::string text;
  if (auto wrong = read_text(file, text)) return *std::move(wrong);
  return parse_world(text);
}

std::optional<world_error> load_path(world& into, const std::string& file) {
  std::string text;
  if (auto wrong = read_text(file, text)) return wrong;
  auto read = parse_path(text, into.lidar);
  if (auto* wrong = std::get_if<world_error>(&read)) return std::move(*wrong);
  into.path = std::get<std::vector<path_point>>(std::move(read));
  into.lidar = into.path.front().robot.at;
  return std::nullopt;
}

std::vector<device_options> several(const device_options& each, std::size_t count,
                                    std::vector<std::string> serials) {
  constexpr std::uint64_t all_serials = 10'000'000'000'000'000;
  std::uint64_t next = 0;
  [[maybe_unused]] const std::string is_number = read_into(next, each.info.serial_number());
  for (; serials.size() < count; ++next) {
    std::string serial = std::to_string(all_serials + next % all_serials).substr(1);
    if (std::find(serials.begin(), serials.end(), serial) == serials.end()) {
      serials.push_back(std::move(serial));
    }
  }
  std::vector<device_options> made(count, each);
  for (std::size_t i = 0; i < count; ++i) {
    made[i].scanner.seed += i;
    auto& digits = made[i].info.serial_digits;
    std::copy_n(serials[i].begin(), std::min(serials[i].size(), digits.size()), digits.begin());
  }
  return made;
}

}  // namespace g4lidar::sim
