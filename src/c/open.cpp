// SPDX-License-Identifier: MIT
// Lidars: options and opening.
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "border.hpp"
#include "core/number_text.hpp"
#include "g4lidar/core/wall_clock.hpp"
#include "g4lidar/options/option_table.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/transport/source.hpp"
#include "handles.hpp"

namespace g4lidar::c {
namespace {

constexpr g4lidar_options lidar_defaults = [] {
  g4lidar_options made{};  // 0 is the default of the others
  made.struct_size = sizeof made;
  return made;
}();

void take_time(std::int32_t given_ms, std::chrono::milliseconds& into) noexcept {
  if (given_ms != 0) into = std::chrono::milliseconds(given_ms);
}

/// What an option with this setting may be, in its own unit.
std::string values_of(const setting_info& of) {
  if (of.type == setting_type::on_off) return "a g4lidar_switch or 0";
  if (of.type == setting_type::word) return "a g4lidar_direction or 0";
  if (of.values.empty()) {
    return std::to_string(of.least) + " to " + std::to_string(of.most) + ", or 0";
  }
  return list_of(of.values, [](const setting_value& each) { return std::to_string(each.number); }) +
         " or 0";
}

/// The option without a valid value, and what it may be; empty if there is none. Times and the baud rate are checked
/// by the lidar.
std::string take_settings(const g4lidar_options& given, lidar_options& into) {
  struct row {
    std::int32_t number;
    std::string_view name;
  };
  const std::array<row, 6> settings{{
      {given.sample_rate_hz, "sample_rate_hz"},
      {given.frequency_chz, "frequency_chz"},
      {given.direction, "direction"},
      {given.constant_frequency, "constant_frequency"},
      {given.low_power, "low_power"},
      {given.protection, "protection"},
  }};
  for (std::size_t i = 0; i < settings.size(); ++i) {
    if (settings[i].number == 0) continue;  // as it is
    const setting_info& of = all_settings()[i];
    std::optional<answer> value = value_of(of, settings[i].number);
    // The lidar refuses it, with the limits of its model.
    constexpr std::int32_t most = std::numeric_limits<std::uint16_t>::max();
    const bool is_held = settings[i].number > 0 && settings[i].number <= most;
    if (!value && of.type == setting_type::decimal && is_held) {
      value = scan_frequency{static_cast<std::uint16_t>(settings[i].number)};
    }
    if (!value) return std::string(settings[i].name) + ": " + values_of(of);
    set_option(into, *value);
  }
  if (given.device_wait_ms < -1) return "device_wait_ms: 0 or more, or -1 for no limit";
  into.device_wait = given.device_wait_ms < 0 ? std::chrono::milliseconds::max()
                                              : std::chrono::milliseconds(given.device_wait_ms);
  if (given.pace < G4LIDAR_AUTOMATIC || given.pace > G4LIDAR_REVOLUTIONS) {
    return "pace: a g4lidar_pace";
  }
  into.tuning.pace = static_cast<read_pace>(given.pace);
  if (given.has_zero_angle) into.zero_angle = zero_angle{given.zero_angle_cdeg};
  return {};
}

/// What is known of a lidar, for the metadata of its recording. Nothing is changed for it.
void describe(lidar& made, recording_writer& into) {
  recorded_device known;
  known.information = made.information();
  if (const auto got = made.ask(requests::get_sample_rate())) known.sample_rate = *got;
  if (const auto got = made.ask(requests::get_scan_frequency())) known.frequency = *got;
  into.device(known);
}

/// Of a recording, or of a simulation in virtual time: what no name opens.
result<lidar> open_unnamed(const opening& wanted, const lidar_options& options) {
  auto from = wanted.recording.empty()
                  ? wanted.simulated->connect()
                  : replay::open(wanted.recording, options.playback, options.is_cancelled);
  if (from) from = options.wrap(*std::move(from));
  return from ? lidar::open(*std::move(from), options) : tl::unexpected(from.error());
}

/// Opens the lidar of a handle, the first time or again.
result<void> connect(g4lidar_lidar& handle) {
  const opening& wanted = handle.from;
  const bool has_own_time = wanted.simulated && wanted.simulated->is_virtual();
  lidar_options how = wanted.how;
  how.wrap = [&](std::unique_ptr<connector> from) -> result<std::unique_ptr<connector>> {
    handle.connector = from.get();
    if (has_own_time) {
      handle.wall_ahead_ns = wall_clock().ahead().count() + g4lidar_now_ns() - from->now_ns();
    }
    if (!wanted.recorder) return from;
    if (reads_file(how.device, std::string(wanted.recorder->path()))) {
      return failure(task::opening, problem::bad_option,
                     "recorder: its file is the one of the source");
    }
    if (has_own_time) wanted.recorder->set_wall_clock(handle.wall_ahead_ns);
    return recorded(std::move(from), *wanted.recorder);
  };
  auto opened =
      has_own_time || !wanted.recording.empty() ? open_unnamed(wanted, how) : lidar::open(how);
  if (!opened) return tl::unexpected(opened.error());
  handle.made = std::make_unique<lidar>(std::move(*opened));
  handle.identity = identity_of(handle.made->information());
  if (wanted.recorder && wanted.recording.empty()) describe(*handle.made, *wanted.recorder);
  return {};
}

int take_lidar_options(const g4lidar_options* given, opening& into, g4lidar_error* error) {
  g4lidar_options taken = lidar_defaults;
  if (!take_options(given, taken)) return refuse(error, bad_options);
  if (const std::string wrong = take_settings(taken, into.how); !wrong.empty()) {
    return bad_option(error, wrong);
  }
  if (!take_model(taken.model, into.how.model)) return refuse_model(error, taken.model);
  into.how.is_cancelled = question_of(taken);
  into.how.baud = taken.baud;
  into.how.probe_all_ports = taken.probe_all_ports;
  into.how.listen_only = taken.listen_only;
  into.how.leave_dtr = taken.leave_dtr;
  into.how.insist_on_model = taken.insist_on_model;
  into.how.reconnect = taken.reconnect;
  into.how.partial_scans = taken.partial_scans;
  into.how.tuning.transport_delay = std::chrono::nanoseconds(taken.transport_delay_ns);
  take_time(taken.longest_backoff_ms, into.how.tuning.longest_backoff);
  take_time(taken.answer_time_ms, into.how.tuning.answer_time);
  take_time(taken.stall_time_ms, into.how.tuning.stall_time);
  take_time(taken.batch_ms, into.how.tuning.batch);
  if (taken.recorder != nullptr) into.recorder = taken.recorder->made;
  into.how.device = text_of(taken.device);
  return G4LIDAR_OK;
}

/// Opens by these options, which `change(opening)` completes; it returns a g4lidar_result.
int open_lidar(const g4lidar_options* given, g4lidar_lidar** made, g4lidar_error* error,
               const auto& change) {
  opening wanted;
  int code = take_lidar_options(given, wanted, error);
  if (code == G4LIDAR_OK) code = change(wanted);
  if (code != G4LIDAR_OK) return code;
  auto handle = std::make_unique<g4lidar_lidar>();
  handle->from = std::move(wanted);
  if (const auto opened = connect(*handle); !opened) return fail(error, opened.error());
  *made = handle.release();
  return succeed(error);
}

}  // namespace

g4lidar_identity identity_of(const device_information& from) noexcept {
  g4lidar_identity made{from.model, from.firmware_major, from.firmware_minor, from.hardware, {}};
  const std::string_view digits = from.serial_number();
  copy_text(made.serial_number, digits.substr(0, digits.find('\0')));
  return made;
}

}  // namespace g4lidar::c

using namespace g4lidar;
using namespace g4lidar::c;

void g4lidar_options_init(g4lidar_options* options, size_t size) {
  set_defaults(options, size, lidar_defaults);
}

int g4lidar_open(const char* device, g4lidar_lidar** lidar, g4lidar_error* error) {
  g4lidar_options options = lidar_defaults;
  options.device = device;
  return g4lidar_open_with(&options, lidar, error);
}

int g4lidar_open_with(const g4lidar_options* options, g4lidar_lidar** lidar, g4lidar_error* error) {
  return created(lidar, error, [&] {
    return open_lidar(options, lidar, error, [](opening&) { return G4LIDAR_OK; });
  });
}

int g4lidar_open_simulated(g4lidar_simulator* simulator, const g4lidar_options* options,
                           g4lidar_lidar** lidar, g4lidar_error* error) {
  const auto choose = [&](opening& wanted) {
    wanted.simulated = simulator->made;
    if (wanted.how.model == nullptr) wanted.how.model = simulator->made->simulated();
    wanted.how.device = simulator->path;
    return G4LIDAR_OK;
  };
  return created(
      lidar, error, [&] { return open_lidar(options, lidar, error, choose); }, simulator);
}

void g4lidar_free(g4lidar_lidar* lidar) { delete lidar; }

namespace {

constexpr g4lidar_playback_options playback_defaults{
    sizeof(g4lidar_playback_options), 0.0, 0, 0, false, {}, nullptr, nullptr};

}  // namespace

void g4lidar_playback_options_init(g4lidar_playback_options* options, size_t size) {
  set_defaults(options, size, playback_defaults);
}

int g4lidar_open_recording(const char* path, const g4lidar_playback_options* playback,
                           const g4lidar_options* options, g4lidar_lidar** lidar,
                           g4lidar_error* error) {
  const auto choose = [&](opening& wanted) -> int {
    g4lidar_playback_options taken = playback_defaults;
    if (!take_options(playback, taken)) return refuse(error, bad_options);
    wanted.recording = path;
    wanted.how.device = {};
    wanted.how.playback = {.speed = taken.speed, .loop = taken.loop, .from_ns = taken.from_ns};
    if (taken.to_ns != 0) wanted.how.playback.to_ns = taken.to_ns;
    if (taken.is_cancelled != nullptr) wanted.how.is_cancelled = question_of(taken);
    return G4LIDAR_OK;
  };
  return created(lidar, error, [&] { return open_lidar(options, lidar, error, choose); }, path);
}
