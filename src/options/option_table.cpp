// SPDX-License-Identifier: MIT
#include "g4lidar/option_table.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <type_traits>

#include "option_access.hpp"
#include "setting_rows.hpp"

namespace g4lidar {
namespace {

using namespace option_user;
using namespace option_door;
using enum parameter_kind;
using words = std::string_view;

// How a value of its type becomes that of a member.
template <class Number>
void take(Number& into, const parameter_value& value) {
  if constexpr (std::is_same_v<Number, bool> || std::is_same_v<Number, double>)
    into = std::get<Number>(value);
  else
    into = static_cast<Number>(std::get<std::int64_t>(value));
}
template <class Rep, class Period>
void take(std::chrono::duration<Rep, Period>& into, const parameter_value& value) {
  into = std::chrono::duration<Rep, Period>(std::get<std::int64_t>(value));
}
void take(zero_angle& into, const parameter_value& value) {
  into.cdeg = static_cast<std::int32_t>(std::lround(100.0 * std::get<double>(value)));
}
template <class Value>
void take(std::optional<Value>& into, const parameter_value& value) {
  take(into.emplace(), value);
}

/// Nothing counts as 1, which is in every range.
template <class Value>
std::int64_t count_of(const Value& member) {
  if constexpr (requires { member.has_value(); })
    return member ? count_of(*member) : 1;
  else if constexpr (requires { member.count(); })
    return static_cast<std::int64_t>(member.count());
  else
    return static_cast<std::int64_t>(member);
}

template <auto Part>
constexpr bool (*differs)(const lidar_options&, const lidar_options&) =
    [](const lidar_options& a, const lidar_options& b) { return !(Part(a) == Part(b)); };
template <auto Part>
constexpr void (*copy)(lidar_options&, const lidar_options&) =
    [](lidar_options& to, const lidar_options& from) { Part(to) = Part(from); };
template <auto Part>
std::string set(lidar_options& into, const parameter_value& value) {
  take(Part(into), value);
  return {};
}

/// Of an option: `Part(options)` is the member.
template <auto Part>
constexpr option_access member{differs<Part>, copy<Part>, set<Part>, nullptr};
/// Of one whose value problem_with() checks.
template <auto Part>
constexpr option_access number{differs<Part>, copy<Part>, set<Part>,
                               [](const lidar_options& of) { return count_of(Part(of)); }};
/// Of the setting with this number.
template <std::size_t Index, auto Part>
constexpr option_access of_setting{
    differs<Part>, copy<Part>,
    [](lidar_options& into, const parameter_value& value) -> std::string {
      const auto made = answer_of(setting_rows[Index], value, into.model);
      if (!made) return std::string(made.error().subject());
      set_option(into, *made);
      return {};
    },
    nullptr};

std::string set_model(lidar_options& into, const parameter_value& value) {
  words label = std::get<std::string>(value);
  const bool insists = label.ends_with('!');
  if (insists) label.remove_suffix(1);
  const model* const found = model_named(label);
  if (found == nullptr) return why_no_model(label);
  into.model = found;
  into.insist_on_model = into.insist_on_model || insists;
  return {};
}
constexpr auto model_part = [](auto& of) -> auto& { return of.model; };
constexpr option_access model_access{differs<model_part>, copy<model_part>, set_model, nullptr};

constexpr std::array<words, 3> paces{"automatic", "packets", "revolutions"};
constexpr auto pace_part = [](auto& of) -> auto& { return of.tuning.pace; };
constexpr option_access pace_access{
    differs<pace_part>, copy<pace_part>,
    [](lidar_options& into, const parameter_value& value) -> std::string {
      const auto at = std::ranges::find(paces, std::get<std::string>(value));
      if (at == paces.end())
        return in_quotes(std::get<std::string>(value)) + " is not one of " + list_of(paces);
      into.tuning.pace = static_cast<read_pace>(at - paces.begin());
      return {};
    },
    [](const lidar_options& of) { return static_cast<std::int64_t>(of.tuning.pace); }};

template <std::size_t Index, auto Part>
constexpr parameter setting_row() {
  constexpr std::array types{is_integer, is_double, is_string, is_bool};
  const setting_info& of = setting_rows[Index];
  return {.name = of.name,
          .type = types.at(static_cast<std::size_t>(of.type)),
          .kind = device,
          .text = of.text,
          .unit = of.unit,
          .users = live,
          .doors = node | keyword,
          .setting = &of,
          .access = &of_setting<Index, Part>};
}

constexpr std::array<words, 4> speckle_words{"window", "count", "near", "ratio"};
constexpr std::array<words, 2> edge_words{"window", "angle"};
constexpr std::array<words, 2> near_words{"shortest", "revolutions"};
constexpr std::array<words, 3> no_return_words{"inf", "nan", "max"};
constexpr std::array<words, 2> near_as_words{"nan", "minus-inf"};
constexpr std::array<words, 2> order_words{"angle", "time"};
constexpr std::array<words, 4> deskew_words{"none", "odometry", "scans", "tf"};

// clang-format off: a row of the table is not a column
constexpr std::array table = std::to_array<parameter>({
    // How a lidar is opened.
    {.name = "source", .type = is_string, .kind = read_only,
     .text = "The lidar or the recording",
     .form = "/dev/ttyUSB0, serial:NUMBER, usb:PATH, tcp:HOST:PORT, a file, or sim:",
     .unset = "the only lidar", .doors = node},
    {.name = "model", .type = is_string, .kind = read_only,
     .text = "Model: x4, x2, ...; x4! insists",
     .form = "MODEL", .unset = "searched, or as a file shows",
     .doors = command_line | node | keyword, .access = &model_access},
    {.name = "insist_on_model", .type = is_bool, .kind = read_only,
     .text = "The model is right, whatever the lidar reports or a recording states",
     .doors = node | keyword,
     .access = &member<[](auto& of) -> auto& { return of.insist_on_model; }>},
    {.name = "listen_only", .type = is_bool, .kind = read_only,
     .text = "Only listen: not a byte is sent",
     .details = "for a data wire alone, or a lidar that another computer drives",
     .users = live, .doors = command_line | node | keyword, .flag = "--listen",
     .access = &member<[](auto& of) -> auto& { return of.listen_only; }>},
    {.name = "leave_dtr", .type = is_bool, .kind = read_only,
     .text = "Do not set the line DTR of the port",
     .details = "a motor that it drives keeps its state",
     .users = live, .doors = command_line | node | keyword,
     .access = &member<[](auto& of) -> auto& { return of.leave_dtr; }>},
    {.name = "baud", .type = is_integer, .kind = read_only,
     .text = "Baud rate", .form = "RATE", .unset = "searched, or by the model",
     .range = {1, 10'000'000, 1}, .users = live, .doors = command_line | node | keyword,
     .access = &member<[](auto& of) -> auto& { return of.baud; }>},
    {.name = "probe_all_ports", .type = is_bool, .kind = read_only,
     .text = "Without a name: look at all ports, not only at a CP2102",
     .users = port, .doors = command_line, .flag = "--all-ports",
     .access = &member<[](auto& of) -> auto& { return of.probe_all_ports; }>},
    {.name = "zero_angle", .type = is_double, .kind = read_only,
     .text = "Added to all angles, not the answer to command 93", .unit = "degrees",
     .form = "DEG", .range = {-360, 360, 0}, .doors = command_line | keyword,
     .access = &member<[](auto& of) -> auto& { return of.zero_angle; }>},
    setting_row<0, [](auto& of) -> auto& { return of.sample_rate; }>(),
    setting_row<1, [](auto& of) -> auto& { return of.frequency; }>(),
    setting_row<2, [](auto& of) -> auto& { return of.direction; }>(),
    setting_row<3, [](auto& of) -> auto& { return of.constant; }>(),
    setting_row<4, [](auto& of) -> auto& { return of.idle; }>(),
    setting_row<5, [](auto& of) -> auto& { return of.protection; }>(),
    {.name = "reconnect", .type = is_bool, .kind = read_only,
     .text = "Reconnect after a loss", .users = live, .doors = keyword, .flag = "--on-loss",
     .access = &member<[](auto& of) -> auto& { return of.reconnect; }>},
    {.name = "partial_scans", .type = is_bool, .kind = read_only,
     .text = "Also pieces of revolutions", .doors = keyword,
     .access = &member<[](auto& of) -> auto& { return of.partial_scans; }>},
    {.name = "pace", .type = is_string, .kind = read_only,
     .text = "When a running scan is read", .words = paces, .range = {0, 2, 1}, .users = live,
     .access = &pace_access},
    {.name = "longest_backoff", .type = is_integer, .kind = read_only,
     .text = "Longest time between two attempts to reconnect", .unit = "ms",
     .range = {1, 1000, 1}, .users = live, .doors = keyword,
     .access = &number<[](auto& of) -> auto& { return of.tuning.longest_backoff; }>},
    {.name = "answer_time", .type = is_integer, .kind = read_only,
     .text = "Longest wait for an answer", .unit = "ms", .range = {10, 10'000, 1},
     .users = live, .doors = keyword,
     .access = &number<[](auto& of) -> auto& { return of.tuning.answer_time; }>},
    {.name = "stall_time", .type = is_integer, .kind = read_only,
     .text = "Longest time of a scan without a packet", .unit = "ms", .range = {100, 60'000, 1},
     .users = live, .doors = keyword,
     .access = &number<[](auto& of) -> auto& { return of.tuning.stall_time; }>},
    {.name = "batch", .type = is_integer, .kind = read_only,
     .text = "Least time between two readings", .unit = "ms", .range = {0, 100, 1},
     .doors = keyword,
     .access = &number<[](auto& of) -> auto& { return of.tuning.batch; }>},
    {.name = "transport_delay", .type = is_integer, .kind = read_only,
     .text = "Least delay between measurement and arrival", .unit = "ns",
     .range = {0, 1e9, 1}, .doors = keyword,
     .access = &number<[](auto& of) -> auto& { return of.tuning.transport_delay; }>},
    {.name = "speed", .type = is_double, .kind = read_only,
     .text = "Speed of a recording; 1: as recorded, 0.5: half as fast", .form = "FACTOR",
     .usual = "1", .range = {0.001, 1000, 0}, .users = file,
     .doors = command_line | node | keyword, .flag = "--playback-speed",
     .node_name = "playback_speed",
     .access = &member<[](auto& of) -> auto& { return of.playback.speed; }>},
    {.name = "loop", .type = is_bool, .kind = read_only,
     .text = "Start a recording again at its end", .users = file,
     .doors = command_line | node | keyword,
     .access = &member<[](auto& of) -> auto& { return of.playback.loop; }>},
    {.name = "begin", .type = is_integer, .kind = read_only,
     .text = "Begin at this time of the recording", .unit = "ns", .users = file,
     .doors = keyword, .flag = "--from",
     .access = &member<[](auto& of) -> auto& { return of.playback.from_ns; }>},
    {.name = "end", .type = is_integer, .kind = read_only,
     .text = "End at this time of the recording", .unit = "ns", .users = file,
     .doors = keyword, .flag = "--to",
     .access = &member<[](auto& of) -> auto& { return of.playback.to_ns; }>},
    {.name = "raw_sample_rate_hz", .type = is_integer, .kind = read_only,
     .text = "Samples per second of raw bytes", .form = "HZ", .unset = "as the model",
     .range = {1, 1'000'000, 1}, .users = raw_file, .doors = command_line | keyword,
     .flag = "--sample-rate",
     .access = &number<[](auto& of) -> auto& { return of.raw_sample_rate_hz; }>},
    // Which points are kept, and what becomes of the others.
    {.name = "range", .type = is_string, .kind = filter,
     .text = "Keep returns in this range, in meters: 0.28:16", .form = "FROM:TO",
     .doors = command_line},
    {.name = "range_min", .type = is_double, .kind = filter,
     .text = "Shortest range that is kept", .unit = "m", .usual = "0", .range = {0, 100, 0},
     .doors = node},
    {.name = "range_max", .type = is_double, .kind = filter,
     .text = "Longest range that is kept", .details = "also that of messages, up to the model's",
     .unit = "m", .usual = "100", .range = {0, 100, 0}, .doors = node},
    {.name = "angle_min", .type = is_double, .kind = program,
     .text = "First direction that is kept, counter-clockwise from ahead", .unit = "degrees",
     .usual = "-180", .range = {-360, 360, 0}, .doors = node},
    {.name = "angle_max", .type = is_double, .kind = program,
     .text = "Last direction that is kept, counter-clockwise from angle_min", .unit = "degrees",
     .usual = "180", .range = {-360, 360, 0}, .doors = node},
    {.name = "fov", .type = is_string, .kind = filter,
     .text = "Keep these directions, in degrees of the frame: -90:90",
     .details = "empty: from angle_min to angle_max", .form = "FROM:TO",
     .doors = command_line | node},
    {.name = "ignore", .type = is_string, .kind = filter,
     .text = "Leave out these directions: 30:40",
     .details = "several with spaces between them: 30:40 90:100; off: none", .form = "FROM:TO",
     .doors = command_line | node},
    {.name = "mask", .type = is_string, .kind = read_only,
     .text = "Leave out returns inside the polygons of a file", .form = "FILE",
     .doors = command_line | node},
    {.name = "speckle", .type = is_string, .kind = filter,
     .text = "Leave out returns without another one near them", .form = "LIMITS",
     .usual = "off", .words = speckle_words, .doors = command_line | node},
    {.name = "edges", .type = is_string, .kind = filter,
     .text = "Leave out veiling points at jumps of the range", .form = "LIMITS", .usual = "off",
     .words = edge_words, .doors = command_line | node},
    {.name = "near", .type = is_string, .kind = filter,
     .text = "Flag directions where something may be too near for a return", .form = "LIMITS",
     .usual = "off", .words = near_words, .doors = command_line | node},
    {.name = "near_as", .type = is_string, .kind = filter,
     .text = "What the range of a direction flagged as near becomes", .usual = "nan",
     .words = near_as_words, .doors = command_line | node},
    {.name = "no_return", .type = is_string, .kind = filter,
     .text = "What the range of a direction without return becomes",
     .details = "it is not free space", .usual = "inf", .words = no_return_words,
     .doors = command_line | node},
    // What programs make of the scans.
    {.name = "standby", .type = is_bool, .kind = program,
     .text = "Rest the motor while nobody subscribes", .details = "to a scan or a cloud",
     .doors = command_line | node},
    {.name = "frame_id", .type = is_string, .kind = read_only, .text = "Frame of the lidar",
     .form = "NAME", .usual = "laser", .doors = command_line | node},
    {.name = "grid", .type = is_integer, .kind = read_only,
     .text = "Ranges of each LaserScan", .form = "N", .unset = "by the model; G4: 720",
     .range = {1, 65'536, 1}, .doors = command_line | node},
    {.name = "order", .type = is_string, .kind = read_only,
     .text = "Order of the ranges of a LaserScan; time: z is down, not for slam_toolbox",
     .usual = "angle", .words = order_words, .doors = command_line | node},
    {.name = "base_frame", .type = is_string, .kind = read_only, .text = "Frame of the robot",
     .form = "NAME", .usual = "base_link", .doors = command_line | node},
    {.name = "odometry_frame", .type = is_string, .kind = read_only,
     .text = "Frame of the odometry", .form = "NAME", .usual = "odom",
     .doors = command_line | node},
    {.name = "mount", .type = is_string, .kind = read_only,
     .text = "Where the lidar is on the robot; down: top down",
     .details = "in metres and degrees, for /tf_static and deskewing", .form = "X,Y,DEG[,down]",
     .unset = "0,0,0", .doors = command_line | node},
    {.name = "deskew", .type = is_string, .kind = read_only,
     .text = "Deskew each revolution by the odometry, or by the scans alone",
     .details = "tf: from odometry_frame to base_frame", .usual = "none",
     .words = deskew_words, .node_words = 1,
     .doors = command_line | node},
    {.name = "connect_timeout", .type = is_double, .kind = read_only,
     .text = "How long the lidar may be missing until the node is unconfigured",
     .details = "0: for ever", .unit = "s", .usual = "0", .range = {0, 3600, 0}, .doors = node},
    {.name = "bond_heartbeat_period", .type = is_double, .kind = read_only,
     .text = "Period of a bond with a lifecycle manager", .details = "0.1 for Nav2; 0: none",
     .unit = "s", .usual = "0", .range = {0, 10, 0}, .doors = node},
    {.name = "autostart", .type = is_bool, .kind = read_only,
     .text = "The node configures and activates itself at the start", .doors = node},
    {.name = "serial_number", .type = is_string, .kind = read_only,
     .text = "Serial number of the lidar"},
});
// clang-format on

}  // namespace

std::span<const parameter> all_parameters() noexcept { return table; }

const parameter* find_parameter(std::string_view name) noexcept {
  const auto* const at = std::ranges::find(table, name, &parameter::name);
  return at == table.end() ? nullptr : at;
}

}  // namespace g4lidar
