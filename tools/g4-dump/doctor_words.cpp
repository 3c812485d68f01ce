// SPDX-License-Identifier: MIT
#include "doctor_words.hpp"

#include <algorithm>

#include "g4lidar/error.hpp"

namespace g4_dump {
namespace {

using enum diagnosis;
using g4lidar::problem;

/// The library's own words for what it knows, too.
std::string_view library_advice(problem what) {
  return g4lidar::error(g4lidar::task::asking, what).advice();
}

constexpr std::array if_silent{deaf, wrong_baud_rate, stalls};
constexpr std::array if_garbage{other_device, interference, line_noise};
constexpr std::array if_browned_out{stalls, unplugged};
constexpr std::array if_stalled{brown_out, unplugged};
constexpr std::array if_rebooting{brown_out};
constexpr std::array if_truncated{bytes_dropped};
constexpr std::array if_lost{stalls};
constexpr std::array if_scan_ends{reboots, interference};
constexpr std::array if_wrong{interference};
constexpr std::array if_missing{interference};
constexpr std::array if_scanning{interference};
constexpr std::array if_noise{wrong_baud_rate, interference};
constexpr std::span<const diagnosis> nothing_else{};

constexpr std::string_view line_advice =
    "Try a shorter or better cable between lidar and bridge, keep it away from motors, press the "
    "plugs "
    "in, and see that lidar and host share a good ground.";
constexpr std::string_view answer_advice =
    "Try again; plug the lidar out and in. If it stays so, look for another program on the port "
    "(`fuser -v <port>`), and for a bridge or adapter in between.";

struct row {
  diagnosis what;
  std::string_view name;
  verdict how;
  exit_code code;
  std::string_view cause;
  std::string_view advice;  // empty: of `known`
  problem known;
  std::span<const diagnosis> or_else;
};

constexpr auto none = problem::cancelled;  // with an advice of its own
constexpr auto fail = verdict::fail;
constexpr auto warn = verdict::warn;

// In the order of the enumeration.
const std::array<row, diagnosis_count> rows{{
    {no_port, "no_port", fail, exit_code::no_device,
     "There is no such port, or none that a G4 could be behind.", "", problem::no_port,
     nothing_else},
    {several_ports, "several_ports", fail, exit_code::no_device,
     "More than one lidar could be meant.", "", problem::several_ports, nothing_else},
    {not_serial, "not_serial", fail, exit_code::no_device, "This is no serial port.", "",
     problem::not_serial, nothing_else},
    {cannot_connect, "cannot_connect", fail, exit_code::no_device,
     "Nobody accepts a connection there.", "", problem::cannot_connect, nothing_else},
    {system, "system", fail, exit_code::no_device, "The system refused for a reason of its own.",
     "", problem::system, nothing_else},
    {permission, "permission", fail, exit_code::permission,
     "This user may not read and write the port.", "", problem::permission, nothing_else},
    {busy, "busy", fail, exit_code::busy, "Another program holds the port.", "", problem::busy,
     nothing_else},
    {interference, "interference", fail, exit_code::busy,
     "Another program uses the port at the same time; each byte goes to one reader only.", "",
     problem::interference, nothing_else},
    {bad_baud_rate, "bad_baud_rate", fail, exit_code::silent,
     "The port cannot do the baud rate of a G4.", "", problem::bad_baud_rate, nothing_else},
    {wrong_baud_rate, "wrong_baud_rate", fail, exit_code::silent,
     "Bytes come, and none make sense at this baud rate.", "", problem::garbage, if_garbage},
    {silent, "silent", fail, exit_code::silent,
     "Nothing comes whatever is said: most likely the lidar has no power of its own, or this is "
     "not "
     "its port.",
     "", problem::silence, if_silent},
    {deaf, "deaf", fail, exit_code::unhealthy,
     "It sends, and does nothing that it is told: commands do not reach it.", "",
     problem::does_not_stop, nothing_else},
    {was_scanning, "was_scanning", warn, exit_code::unhealthy,
     "It scanned though nobody had asked now: a program before was killed, or another one uses it.",
     "Nothing, if a program has just been killed; the scan was stopped. If it comes again and "
     "again, "
     "look for another program on the port.",
     none, if_scanning},
    {answers_late, "answers_late", fail, exit_code::unhealthy,
     "Answers come so late that they could be taken for those of later questions.",
     "Without a network bridge or an adapter in between, plug the lidar out and in. With one, give "
     "lidar_options::answer_time more.",
     none, nothing_else},
    {answers_wrong, "answers_wrong", fail, exit_code::unhealthy,
     "Answers come that are none to what was asked.", "", problem::wrong_answer, if_wrong},
    {answers_twice, "answers_twice", warn, exit_code::unhealthy, "Answers come twice.",
     answer_advice, none, nothing_else},
    {answers_missing, "answers_missing", fail, exit_code::unhealthy,
     "Answers stay away, though what is sent reaches it.", answer_advice, none, if_missing},
    {other_device, "other_device", fail, exit_code::not_a_g4,
     "It answers as a lidar of this maker, of another model.", "", problem::other_device,
     nothing_else},
    {health_warning, "health_warning", warn, exit_code::unhealthy,
     "The lidar warns of its own health.",
     "Clean the window and keep it cool; tell the maker the code if it stays.", none, nothing_else},
    {health_error, "health_error", fail, exit_code::unhealthy,
     "The lidar says by itself that it is defective.", "", problem::unhealthy, nothing_else},
    {brown_out, "brown_out", fail, exit_code::unhealthy,
     "It died when the motor started: too little power.", "", problem::brown_out, if_browned_out},
    {reboots, "reboots", fail, exit_code::unhealthy,
     "It boots again by itself, most often for want of power.", "", problem::brown_out,
     if_rebooting},
    {does_not_start, "does_not_start", fail, exit_code::unhealthy,
     "It answers, and does not start to scan when told to.",
     "Ask for its health; plug it out and in. If it stays so it is for repair.", none,
     nothing_else},
    {motor_stuck, "motor_stuck", fail, exit_code::unhealthy,
     "It measures, and the head does not turn.",
     "See whether something holds the head, and whether the motor has power.", none, nothing_else},
    {motor_unsteady, "motor_unsteady", warn, exit_code::unhealthy,
     "The head does not come to a steady speed.",
     "See whether something rubs at the head, and whether the supply is strong enough.", none,
     nothing_else},
    {unplugged, "unplugged", fail, exit_code::lost, "The port vanished while it was looked at.", "",
     problem::gone, nothing_else},
    {stalls, "stalls", fail, exit_code::lost,
     "The line fell silent for a while, though the port is there.", "", problem::stalled,
     if_stalled},
    {scan_ends, "scan_ends", fail, exit_code::unhealthy,
     "The scan ended by itself, and the lidar still answers.",
     "Look for another program that stops it; give it a stronger supply.", none, if_scan_ends},
    {protection_on, "protection_on", warn, exit_code::unhealthy,
     "The power-down protection is on: the scan ends 3 s after the last command.",
     "Nothing, for programs that feed it, as this library does. `set protection=off` turns it off.",
     none, nothing_else},
    {jolts, "jolts", warn, exit_code::unhealthy,
     "Packets come whose angles go back though the head is up to speed: it jerks.",
     "Fasten the lidar; see that nothing touches the head, and that the supply is steady.", none,
     nothing_else},
    {frequency_off, "frequency_off", warn, exit_code::unhealthy,
     "The head turns at another speed than is set.",
     "See that nothing rubs at the head; turn constant frequency on.", none, nothing_else},
    {sample_rate_off, "sample_rate_off", warn, exit_code::unhealthy,
     "It measures at another rate than it says.",
     "Trust the measured rate. Samples that are lost look the same: see the stage loss.", none,
     nothing_else},
    {bits_flipped, "bits_flipped", fail, exit_code::unhealthy,
     "Packets of the right length come with single wrong bits: the line is disturbed.", line_advice,
     none, nothing_else},
    {bytes_dropped, "bytes_dropped", fail, exit_code::unhealthy,
     "Single bytes are missing inside packets: the bridge or its driver loses them.",
     "Try another USB port, without a hub; another bridge; fewer programs on this computer.", none,
     nothing_else},
    {bytes_inserted, "bytes_inserted", fail, exit_code::unhealthy,
     "Bytes come that were never sent, between those of packets: the line rings or is "
     "cross-talked.",
     line_advice, none, nothing_else},
    {bursts, "bursts", fail, exit_code::unhealthy,
     "Whole stretches of packets of the right length are overwritten: bursts of noise.",
     line_advice, none, nothing_else},
    {packets_truncated, "packets_truncated", fail, exit_code::unhealthy,
     "Packets end before their end: most likely a byte buffer on the way overflows.",
     "Try another USB port, another bridge, a computer with less to do.", none, if_truncated},
    {packets_lost, "packets_lost", fail, exit_code::unhealthy,
     "Whole packets are missing while those that come are sound: more is measured than the line "
     "carries, or the computer is too slow.",
     "Choose a lower ranging frequency; see what else this computer does.", none, if_lost},
    {line_noise, "line_noise", fail, exit_code::unhealthy,
     "Bytes that make no packet come, in no pattern that could be told.", line_advice, none,
     if_noise},
    {usb_latency, "usb_latency", warn, exit_code::unhealthy,
     "Bytes are held back and handed over in batches: the latency timer of a USB bridge, most "
     "often.",
     "With an FTDI bridge write 1 to /sys/bus/usb-serial/devices/ttyUSB0/latency_timer; else try "
     "another USB port, without a hub.",
     none, nothing_else},
}};

std::array<diagnosis_words, diagnosis_count> all_words() {
  std::array<diagnosis_words, diagnosis_count> words{};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const row& r = rows[i];
    words[i] = {r.what,   r.name,  r.how,
                r.code,   r.cause, r.advice.empty() ? library_advice(r.known) : r.advice,
                r.or_else};
  }
  return words;
}

}  // namespace

const diagnosis_words& words_of(diagnosis what) {
  static const std::array<diagnosis_words, diagnosis_count> words = all_words();
  return words[static_cast<std::size_t>(what)];
}

std::string_view name_of(stage where) noexcept {
  constexpr std::array<std::string_view, stage_count> names{
      "port",   "permission", "holder", "baud_rate", "answer", "identity",
      "health", "motor",      "stream", "rate",      "loss",   "usb_latency"};
  return names[static_cast<std::size_t>(where)];
}

std::string_view name_of(verdict how) noexcept {
  constexpr std::array<std::string_view, 4> names{"ok", "skipped", "warn", "fail"};
  return names[static_cast<std::size_t>(how)];
}

void stage_report::find(diagnosis what) {
  if (std::find(found.begin(), found.end(), what) != found.end()) return;
  found.push_back(what);
  how = std::max(how, words_of(what).how);
}

exit_code exit_code_of(std::span<const stage_report> stages) {
  for (const stage_report& each : stages) {
    if (each.how != verdict::fail) continue;
    for (const diagnosis what : each.found) {
      if (words_of(what).how == verdict::fail) return words_of(what).code;
    }
  }
  return exit_code::ok;
}

}  // namespace g4_dump
