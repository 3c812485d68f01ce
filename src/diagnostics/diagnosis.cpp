// SPDX-License-Identifier: MIT
#include "g4lidar/diagnostics/diagnosis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "core/enumerators.hpp"
#include "core/number_text.hpp"

namespace g4lidar {
namespace {

using enum diagnosis;

constexpr std::string_view line_advice =
    "Use a shorter or better cable between lidar and bridge, keep it away from motors, press the "
    "plugs in, and check that lidar and host share a good ground.";
constexpr std::string_view answer_advice =
    "Try again; unplug the lidar and plug it in again. If this remains, look for another program "
    "that uses the port (`fuser -v <port>`), and for a bridge or adapter in between.";

struct row {
  constexpr row(std::string_view its_name, stage_verdict how_bad, std::string_view why,
                std::variant<std::string_view, problem> what_to_try,
                std::initializer_list<diagnosis> others = {}) noexcept
      : name(its_name), severity(how_bad), cause(why), advice(what_to_try), count(others.size()) {
    std::copy(others.begin(), others.end(), alternatives.begin());
  }

  std::string_view name;
  stage_verdict severity;
  std::string_view cause;
  std::variant<std::string_view, problem> advice;  // a problem: that of its error
  std::array<diagnosis, 3> alternatives{};
  std::size_t count;  // of the alternatives
};

constexpr auto fail = stage_verdict::fail;
constexpr auto warn = stage_verdict::warn;

// In the order of the enumeration.
constexpr std::array rows{
    row("no_port", fail, "There is no such port, or no port that a lidar could be attached to.",
        problem::no_port),
    row("several_ports", fail, "More than one lidar could be meant.", problem::several_ports),
    row("not_serial", fail, "This is not a serial port.", problem::not_serial),
    row("cannot_connect", fail, "No connection is accepted at this address.",
        problem::cannot_connect),
    row("system", fail, "The operating system refused for another reason.", problem::system),
    row("bad_file", fail, "The file cannot be read, or holds no bytes of a lidar.",
        problem::bad_file),
    row("permission", fail, "This user may not read and write the port.", problem::permission),
    row("busy", fail, "Another program has the port open.", problem::busy),
    row("interference", fail,
        "Another program uses the port at the same time; each byte reaches only one of them.",
        problem::interference),
    row("bad_baud_rate", fail, "The port does not support the baud rate.", problem::bad_baud_rate),
    row("changed_bytes", fail,
        "Something between the lidar and this program has changed the bytes: a network bridge, a "
        "transfer of text, a terminal.",
        "Pass the bytes on as they are: set the bridge to raw TCP with the baud rate of the lidar "
        "and without flow control; transfer files as binary. Over a slow network bytes may be "
        "lost: use a better connection.",
        {bytes_dropped, line_noise}),
    row("no_lidar", fail,
        "These are not the bytes of a lidar of this family: a device of another maker or kind has "
        "sent them, or nothing comes back but what was sent.",
        "If it is a lidar, use its own driver. Otherwise name the port of the lidar (`g4-dump "
        "list` shows the ports), and check both wires between lidar and bridge."),
    row("unknown_bytes", fail,
        "Bytes arrive that are of no known kind: of another device, at a baud rate that was not "
        "tried, or damaged.",
        problem::garbage, {other_device, interference, line_noise}),
    row("wrong_baud_rate", fail, "Bytes arrive, but they make no sense at this baud rate.",
        "Give the baud rate of the lidar, or none: then all rates are tried. Set a network bridge "
        "to "
        "the rate of the lidar.",
        {other_device, interference, line_noise}),
    row("silent", fail,
        "Nothing arrives. Most likely the lidar has no power, or is not attached to this port.",
        problem::silence, {deaf, wrong_baud_rate, stalls}),
    row("deaf", fail, "The lidar sends but does not react: commands do not reach it.",
        problem::does_not_stop),
    row("one_way_lidar", fail,
        "The lidar sends and answers nothing, as one-way models do; the model that was named "
        "answers.",
        "Name the model that is attached: its word is in the remark. If it really is the one that "
        "was "
        "named, commands do not reach it: check the wire to the lidar.",
        {deaf, other_device}),
    row("was_scanning", warn,
        "The lidar was scanning before the run: a program was killed, or another one uses it.",
        "Nothing, if a program has just been killed. If it happens again, look for another program "
        "that uses the port.",
        {interference}),
    row("answers_late", fail,
        "Replies arrive so late that they could be taken for the replies to later commands.",
        "Without a network bridge or an adapter, unplug the lidar and plug it in again. With one, "
        "use a faster network, or give lidar_options::answer_time a larger value."),
    row("answers_wrong", fail, "Replies arrive that do not belong to the command.",
        problem::wrong_answer, {interference}),
    row("answers_twice", warn, "Replies arrive twice.", answer_advice),
    row("no_zero_angle", warn,
        "The offset of zero, which this model states as the answer to command 93, is not known: "
        "all angles may be "
        "wrong by the same amount.",
        "Query it again: unplug the lidar and plug it in. Or give it with --zero-angle "
        "(lidar_options::zero_angle): "
        "0 if the angles are right without it."),
    row("answers_missing", fail, "Replies are missing, although commands reach the lidar.",
        answer_advice, {interference}),
    row("other_number", warn, "The lidar states a number that the model does not have.",
        "Compare the model with the label of the lidar, and name the right one: ranges and angles "
        "may be wrong."),
    row("other_device", fail, "The lidar is another model than the one that was expected.",
        problem::other_device),
    row("health_warning", warn, "The lidar reports a warning about its own health.",
        "Clean the window and keep the lidar cool; give the code to the maker if it remains."),
    row("health_error", fail, "The lidar reports that it is defective.", problem::unhealthy),
    row("brown_out", fail, "The lidar stopped working when the motor started: not enough power.",
        problem::brown_out, {stalls, unplugged}),
    row("reboots", fail, "The lidar restarts by itself, most often because of too little power.",
        problem::brown_out, {brown_out}),
    row("does_not_start", fail, "The lidar answers but does not start to scan.",
        "Query its health; unplug it and plug it in again. If this remains, it needs repair."),
    row("motor_stuck", fail, "The lidar measures, but the head does not turn.",
        "Check that nothing blocks the head and that the motor has power."),
    row("no_motor_power", fail,
        "The lidar answers and accepts the start, but its motor does not turn: most likely its "
        "second plug, which gives power to the motor, is not connected.",
        "Connect the second plug of the lidar, to a charger or a powered hub. If it is connected, "
        "use a "
        "connection that has the line DTR, which starts the motor; check that nothing blocks the "
        "head.",
        {motor_stuck, does_not_start}),
    row("motor_unsteady", warn, "The head does not reach a steady speed.",
        "Check that nothing touches the head and that the power supply is strong enough."),
    row("unplugged", fail, "The port disappeared during the run.", problem::gone),
    row("stalls", fail, "Nothing arrived for a while, although the port exists.", problem::stalled,
        {brown_out, unplugged}),
    row("scan_ends", fail, "The scan ended by itself, and the lidar still answers.",
        "Look for another program that stops it; use a stronger power supply.",
        {reboots, interference}),
    row("protection_on", warn,
        "Power-down protection is on: the scan ends 3 s after the last start command.",
        "Programs that use this library need nothing: it sends the start command again and again. "
        "For "
        "others, switch power-down protection off."),
    row("jolts", warn, "The angles of some packets go back at full speed: the head jerks.",
        "Fasten the lidar; check that nothing touches the head and that the supply is steady."),
    row("host_busy", warn,
        "This computer did not run the program for a while. This is not a fault of the lidar.",
        "Run fewer programs at the same time. Measurements during such a pause can be incomplete."),
    row("frequency_off", warn, "The head turns at another speed than the one that is set.",
        "Check that nothing touches the head; switch constant frequency on."),
    row("sample_rate_off", warn,
        "The sample rate differs from the one that the lidar reports, or from those of its model.",
        "Use the measured rate. Lost samples look the same: see the stage loss."),
    row("bits_flipped", fail,
        "Packets of the right length contain single wrong bits: the line is disturbed.",
        line_advice),
    row("bytes_dropped", fail,
        "Single bytes are missing inside packets: the bridge or its driver loses them.",
        "Use another USB port, without a hub; another bridge; fewer programs on this computer."),
    row("bytes_inserted", fail,
        "Bytes arrive that were never sent: reflections on the line or crosstalk.", line_advice),
    row("bursts", fail,
        "Longer parts of packets of the right length are overwritten: bursts of noise.",
        line_advice),
    row("packets_truncated", fail,
        "Packets end too early: most likely a byte buffer on the way overflows.",
        "Use another USB port, another bridge, or a computer with less load.", {bytes_dropped}),
    row("packets_lost", fail,
        "Whole packets are missing while the others are intact: more is measured than the line "
        "carries, or the computer is too slow.",
        "Set a lower sample rate; reduce the load of this computer.", {stalls}),
    row("line_noise", fail, "Bytes arrive that belong to no packet, and they show no pattern.",
        line_advice, {wrong_baud_rate, interference}),
    row("no_returns", warn,
        "Nothing came back in any direction: the window is covered, the laser is dead, or nothing "
        "is within the range of the lidar. The laser of an X4 lasts about 1,500 hours.",
        "Hold a white sheet 30 cm in front of the window. If still nothing comes back, remove "
        "covers and dirt from the window; after that the lidar needs repair."),
    row("usb_latency", warn,
        "Bytes are held back and arrive in groups, most often by the latency timer of a USB "
        "bridge.",
        "With an FTDI bridge write 1 to /sys/bus/usb-serial/devices/ttyUSB0/latency_timer; "
        "otherwise use another USB port, without a hub.")};
static_assert(rows.size() == diagnosis_count);

}  // namespace

diagnosis_info describe(diagnosis what) noexcept {
  const row& from = detail::row_of(rows, what);
  const auto* const known = std::get_if<problem>(&from.advice);
  return {from.name, from.severity, from.cause,
          known != nullptr ? error(task::asking, *known).advice() : std::get<0>(from.advice),
          std::span(from.alternatives).first(from.count)};
}

std::string_view name_of(diagnostic_stage where) noexcept {
  constexpr std::array<std::string_view, diagnostic_stage_count> names{
      "port",  "permission", "holder", "baud_rate", "answers", "identity",   "health",
      "motor", "stream",     "rate",   "loss",      "returns", "usb_latency"};
  return detail::name_in(names, where);
}

std::string_view name_of(stage_verdict how) noexcept {
  constexpr std::array<std::string_view, 4> names{"ok", "skipped", "warn", "fail"};
  return detail::name_in(names, how);
}

diagnosis diagnosis_of(problem what) noexcept {
  if (what == problem::gone || what == problem::end_of_input) return unplugged;
  if (what == problem::bad_option) return no_port;  // a name that is none
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto* const known = std::get_if<problem>(&rows[i].advice);
    if (known != nullptr && *known == what) return static_cast<diagnosis>(i);
  }
  return system;
}

std::optional<diagnosis> diagnosis_of(const stream_counts& counts, std::uint64_t size) noexcept {
  if (size == 0) return bad_file;
  const bool is_lidar = counts.responses > 0 && counts.skipped_bytes() <= size / 2;
  if (counts.packets == 0 && !is_lidar) return unknown_bytes;
  if (counts.packets > 0 && counts.skipped_bytes() > size / 2) return line_noise;
  return std::nullopt;
}

std::string_view evidence::unit() const noexcept {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> units{
      {{"_ms", "ms"}, {"_hz", "Hz"}, {"_percent", "%"}, {"baud", "baud"}, {"seconds", "s"}}};
  for (const auto& [ending, unit] : units) {
    if (name.ends_with(ending)) return unit;
  }
  return {};
}

std::string evidence::text() const {
  if (const auto* word = std::get_if<std::string>(&value)) return *word;
  if (const auto* number = std::get_if<std::int64_t>(&value)) return std::to_string(*number);
  const double number = std::get<double>(value);
  const double size = std::abs(number);
  const int decimals = size >= 1000 ? 0 : size >= 100 ? 1 : size >= 10 ? 2 : size >= 1 ? 3 : 4;
  std::string text = with_decimals(number, decimals);
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

void stage_report::find(diagnosis what) {
  if (std::find(diagnoses.begin(), diagnoses.end(), what) != diagnoses.end()) return;
  diagnoses.push_back(what);
  outcome = std::max(outcome, describe(what).severity);
}

}  // namespace g4lidar
