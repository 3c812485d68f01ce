// SPDX-License-Identifier: MIT
#include "g4lidar/options/option_table.hpp"

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
using literal = std::string_view;
using options = lidar_options;

// How a value of its type becomes that of a member.
template <class Number>
  requires std::is_arithmetic_v<Number>
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
  requires(!std::is_enum_v<Value> && !std::is_same_v<Value, scan_frequency>)
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

/// The member that pointers lead to.
template <auto... Members>
constexpr auto& part(auto& of) {
  return (of.*....*Members);
}
/// Of the option that is this member.
template <auto... Members>
constexpr option_access member{
    [](const options& a, const options& b) {
      return !(part<Members...>(a) == part<Members...>(b));
    },
    [](options& to, const options& given) { part<Members...>(to) = part<Members...>(given); },
    [](options& into, const parameter_value& value) {
      if constexpr (requires { take(part<Members...>(into), value); })
        take(part<Members...>(into), value);
      return std::string();
    },
    nullptr};
/// With other ways to set it, and to compare it with its limits.
constexpr option_access changed(option_access made, decltype(option_access::set) set,
                                decltype(option_access::number) number = nullptr) {
  made.number = number;
  if (set != nullptr) made.set = set;
  return made;
}
/// Of one whose limits problem_with() checks.
template <auto... Members>
constexpr option_access number = changed(
    member<Members...>, nullptr, [](const options& of) { return count_of(part<Members...>(of)); });

template <auto Member>
constexpr option_access timed = number<&options::tuning, Member>;
template <auto Member>
constexpr option_access played = member<&options::playback, Member>;

/// Of the setting with this number.
template <std::size_t Index>
std::string set_setting(options& into, const parameter_value& value) {
  const auto made = answer_of(setting_rows[Index], value, into.model);
  if (!made) return std::string(made.error().subject());
  set_option(into, *made);
  return {};
}
template <std::size_t Index, auto Member>
constexpr option_access setting_access = changed(member<Member>, set_setting<Index>);

std::string set_model(lidar_options& into, const parameter_value& value) {
  literal label = std::get<std::string>(value);
  const bool insists = label.ends_with('!');
  if (insists) label.remove_suffix(1);
  const model* const found = model_named(label);
  if (found == nullptr) return why_no_model(label);
  into.model = found;
  into.insist_on_model = into.insist_on_model || insists;
  return {};
}
constexpr option_access model_access = changed(member<&options::model>, set_model);

constexpr std::array<literal, 3> paces{"automatic", "packets", "revolutions"};
std::string set_pace(options& into, const parameter_value& value) {
  const auto at = std::ranges::find(paces, std::get<std::string>(value));
  if (at == paces.end()) return "it is not one of " + list_of(paces);
  into.tuning.pace = static_cast<read_pace>(at - paces.begin());
  return {};
}
constexpr option_access pace_access =
    changed(member<&options::tuning, &lidar_tuning::pace>, set_pace,
            [](const options& of) { return static_cast<std::int64_t>(of.tuning.pace); });

/// `details`: the parts of a row that few have.
constexpr parameter row(literal name, std::uint8_t type, parameter_kind kind, std::uint8_t doors,
                        literal about, parameter details = {}, std::uint8_t users = any,
                        const option_access* access = nullptr) {
  details.name = name;
  details.type = type;
  details.kind = kind;
  details.doors = doors;
  details.text = about;
  details.users = users;
  details.access = access;
  return details;
}
constexpr parameter opening(literal name, std::uint8_t type, std::uint8_t users, std::uint8_t doors,
                            const option_access* access, literal about,
                            const parameter& details = {}) {
  return row(name, type, read_only, doors, about, details, users, access);
}
constexpr std::uint8_t programs = tool | node;
constexpr std::uint8_t all_doors = programs | python;

template <std::size_t Index, auto Member>
constexpr parameter setting_row() {
  constexpr std::array types{is_integer, is_double, is_string, is_bool};
  const setting_info& of = setting_rows[Index];
  parameter made = row(of.name, types.at(static_cast<std::size_t>(of.type)), device, node | python,
                       of.text, {.unit = of.unit}, live, &setting_access<Index, Member>);
  made.setting = &of;
  return made;
}

constexpr std::array<literal, 4> speckle_words{"window", "count", "near", "ratio"};
constexpr std::array<literal, 2> edge_words{"window", "angle"};
constexpr std::array<literal, 2> near_words{"shortest", "revolutions"};
constexpr std::array<literal, 3> no_return_words{"inf", "nan", "max"};
constexpr std::array<literal, 2> near_as_words{"nan", "minus-inf"};
constexpr std::array<literal, 2> order_words{"angle", "time"};
constexpr std::array<literal, 4> deskew_words{"none", "odometry", "scans", "tf"};

constexpr std::array table = std::to_array<parameter>({
    // How a lidar is opened.
    row("source", is_string, read_only, node, "The lidar or the recording",
        {.form = "/dev/ttyUSB0, serial:NUMBER, usb:PATH, tcp:HOST:PORT, a file, or sim:",
         .unset = "the only lidar"}),
    opening("model", is_string, any, all_doors, &model_access, "Model: x4, x2, ...; x4! insists",
            {.form = "MODEL", .unset = "searched, or as a file shows"}),
    opening("insist_on_model", is_bool, any, node | python, &member<&options::insist_on_model>,
            "The model is right, whatever the lidar reports or a recording states"),
    opening("listen_only", is_bool, live, all_doors, &member<&options::listen_only>,
            "Only listen: not a byte is sent",
            {.details = "for a data wire alone, or a lidar that another computer drives",
             .flag = "--listen"}),
    opening("leave_dtr", is_bool, live, all_doors, &member<&options::leave_dtr>,
            "Do not set the line DTR of the port",
            {.details = "a motor that it drives keeps its state"}),
    opening("baud", is_integer, live, all_doors, &member<&options::baud>, "Baud rate",
            {.form = "RATE", .unset = "searched, or by the model", .range = {1, 10'000'000, 1}}),
    opening("probe_all_ports", is_bool, port, tool, &member<&options::probe_all_ports>,
            "Without a name: look at all ports, not only at a CP2102", {.flag = "--all-ports"}),
    opening("zero_angle", is_double, any, tool | python, &member<&options::zero_angle>,
            "Added to all angles, not the answer to command 93",
            {.unit = "degrees", .form = "DEG", .range = {-360, 360, 0}}),
    setting_row<0, &options::sample_rate>(),
    setting_row<1, &options::frequency>(),
    setting_row<2, &options::direction>(),
    setting_row<3, &options::constant>(),
    setting_row<4, &options::idle>(),
    setting_row<5, &options::protection>(),
    opening("reconnect", is_bool, live, python, &member<&options::reconnect>,
            "Reconnect after a loss", {.flag = "--on-loss"}),
    opening("partial_scans", is_bool, any, python, &member<&options::partial_scans>,
            "Also pieces of revolutions"),
    opening("pace", is_string, live, 0, &pace_access, "When a running scan is read",
            {.words = paces, .range = {0, 2, 1}}),
    opening("longest_backoff", is_integer, live, python, &timed<&lidar_tuning::longest_backoff>,
            "Longest time between two attempts to reconnect",
            {.unit = "ms", .range = {1, 1000, 1}}),
    opening("answer_time", is_integer, live, python, &timed<&lidar_tuning::answer_time>,
            "Longest wait for an answer", {.unit = "ms", .range = {10, 10'000, 1}}),
    opening("stall_time", is_integer, live, python, &timed<&lidar_tuning::stall_time>,
            "Longest time of a scan without a packet", {.unit = "ms", .range = {100, 60'000, 1}}),
    opening("batch", is_integer, any, python, &timed<&lidar_tuning::batch>,
            "Least time between two readings", {.unit = "ms", .range = {0, 100, 1}}),
    opening("transport_delay", is_integer, any, python, &timed<&lidar_tuning::transport_delay>,
            "Least delay between measurement and arrival", {.unit = "ns", .range = {0, 1e9, 1}}),
    opening("speed", is_double, file, all_doors, &played<&playback_options::speed>,
            "Speed of a recording; 1: as recorded, 0.5: half as fast",
            {.form = "FACTOR",
             .usual = "1",
             .range = {0.001, 1000, 0},
             .flag = "--playback-speed",
             .node_name = "playback_speed"}),
    opening("loop", is_bool, file, all_doors, &played<&playback_options::loop>,
            "Start a recording again at its end"),
    opening("begin", is_integer, file, python, &played<&playback_options::from_ns>,
            "Begin at this time of the recording", {.unit = "ns", .flag = "--from"}),
    opening("end", is_integer, file, python, &played<&playback_options::to_ns>,
            "End at this time of the recording", {.unit = "ns", .flag = "--to"}),
    opening("raw_sample_rate_hz", is_integer, raw_file | pipe, tool | python,
            &number<&options::raw_sample_rate_hz>, "Samples per second of raw bytes",
            {.form = "HZ",
             .unset = "as the model",
             .range = {1, 1'000'000, 1},
             .flag = "--sample-rate"}),
    opening("counts_times", is_bool, raw_file | pipe, 0, &member<&options::counts_times>,
            "Times of points are counted from samples"),
    // Which points are kept, and what becomes of the others.
    row("range", is_string, filter, tool, "Keep returns in this range, in meters: 0.28:16",
        {.form = "FROM:TO"}),
    row("range_min", is_double, filter, node, "Shortest range that is kept",
        {.unit = "m", .usual = "0", .range = {0, 100, 0}}),
    row("range_max", is_double, filter, node, "Longest range that is kept",
        {.details = "also that of messages, up to the model's",
         .unit = "m",
         .usual = "100",
         .range = {0, 100, 0}}),
    row("angle_min", is_double, program, node,
        "First direction that is kept, counter-clockwise from ahead",
        {.unit = "degrees", .usual = "-180", .range = {-360, 360, 0}}),
    row("angle_max", is_double, program, node,
        "Last direction that is kept, counter-clockwise from angle_min",
        {.unit = "degrees", .usual = "180", .range = {-360, 360, 0}}),
    row("fov", is_string, filter, programs,
        "Keep these directions, in degrees of the frame: -90:90",
        {.details = "empty: from angle_min to angle_max", .form = "FROM:TO"}),
    row("ignore", is_string, filter, programs, "Leave out these directions: 30:40",
        {.details = "several with spaces between them: 30:40 90:100; off: none",
         .form = "FROM:TO"}),
    row("mask", is_string, read_only, programs, "Leave out returns inside the polygons of a file",
        {.form = "FILE"}),
    row("speckle", is_string, filter, programs, "Leave out returns without another one near them",
        {.form = "LIMITS", .usual = "off", .words = speckle_words}),
    row("edges", is_string, filter, programs, "Leave out veiling points at jumps of the range",
        {.form = "LIMITS", .usual = "off", .words = edge_words}),
    row("near", is_string, filter, programs,
        "Flag directions where something may be too near for a return",
        {.form = "LIMITS", .usual = "off", .words = near_words}),
    row("near_as", is_string, filter, programs,
        "What the range of a direction flagged as near becomes",
        {.usual = "nan", .words = near_as_words}),
    row("no_return", is_string, filter, programs,
        "What the range of a direction without return becomes",
        {.details = "it is not free space", .usual = "inf", .words = no_return_words}),
    // What programs make of the scans.
    row("standby", is_bool, program, programs,
        "Rest the motor while nobody subscribes to scans or clouds"),
    row("frame_id", is_string, read_only, programs, "Frame of the lidar",
        {.form = "NAME", .usual = "laser"}),
    row("grid", is_integer, read_only, programs, "Ranges of each LaserScan",
        {.form = "N", .unset = "by the model; G4: 720", .range = {1, 65'536, 1}}),
    row("order", is_string, read_only, programs,
        "Order of the ranges of a LaserScan; time: z is down, not for slam_toolbox",
        {.usual = "angle", .words = order_words}),
    row("base_frame", is_string, read_only, programs, "Frame of the robot",
        {.form = "NAME", .usual = "base_link"}),
    row("odometry_frame", is_string, read_only, programs, "Frame of the odometry",
        {.form = "NAME", .usual = "odom"}),
    row("mount", is_string, read_only, programs, "Where the lidar is on the robot; down: top down",
        {.details = "metres and degrees; if it is given, it is on /tf_static",
         .form = "X,Y,DEG[,down]",
         .unset = "0,0,0"}),
    row("deskew", is_string, read_only, programs,
        "Deskew each revolution by the odometry, or by the scans alone",
        {.details = "tf: from odometry_frame to base_frame",
         .usual = "none",
         .words = deskew_words,
         .node_words = 1}),
    row("connect_timeout", is_double, read_only, node,
        "How long the lidar may be missing until the node is unconfigured",
        {.details = "0: for ever", .unit = "s", .usual = "0", .range = {0, 3600, 0}}),
    row("bond_heartbeat_period", is_double, read_only, node,
        "Period of a bond with a lifecycle manager",
        {.details = "0.1 for Nav2; 0: none", .unit = "s", .usual = "0", .range = {0, 10, 0}}),
    row("autostart", is_bool, read_only, node,
        "The node configures and activates itself at the start"),
    row("serial_number", is_string, read_only, 0, "Serial number of the lidar"),
});

}  // namespace

std::span<const parameter> all_parameters() noexcept { return table; }

const parameter* find_parameter(std::string_view name) noexcept {
  const auto* const at = std::ranges::find(table, name, &parameter::name);
  return at == table.end() ? nullptr : at;
}

}  // namespace g4lidar
