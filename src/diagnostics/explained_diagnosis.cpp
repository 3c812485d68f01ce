// SPDX-License-Identifier: MIT
// Cause and advice of a diagnosis that depend on the way of the bytes, or on the case.
#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "g4lidar/diagnostics/diagnosis.hpp"

namespace g4lidar {
namespace {

using enum diagnosis;

/// Empty: as describe() has it.
struct other_words {
  diagnosis what;
  std::string_view cause;
  std::string_view advice;
};

constexpr std::string_view bridge_advice =
    "Set the bridge to raw TCP with the baud rate of the lidar and without flow control. If bytes "
    "are lost on the way, use a better network, or read the lidar at the computer to which it is "
    "attached.";
constexpr std::string_view power_advice =
    "The lidar gets too little power: use a separate supply that can deliver 1 A.";
constexpr std::string_view remote_answer_advice =
    "Try again. If this remains, look for another program that is connected to the bridge, switch "
    "the lidar off and on again, and check the settings of the bridge.";

// No cable, no ground, no reflection, no USB bridge: nobody here can know what is behind the network.
constexpr std::array of_network{
    other_words{no_lidar, "",
                "If it is a lidar, use its own driver. Otherwise check which device is attached to "
                "the bridge, and whether the bridge echoes."},
    other_words{
        unknown_bytes, "",
        "Set the bridge to the baud rate of the lidar. If a model or a baud rate was named, "
        "check it, or omit it. Check that a lidar is attached to the bridge."},
    other_words{silent,
                "Nothing arrives. Most likely the lidar has no power, or is not "
                "attached to this bridge, or the bridge has another baud rate.",
                "Check that the lidar has power and is attached to the bridge, that the bridge has "
                "the baud rate of the lidar, and that no other program is connected to it. If a "
                "model was named, check it, or omit it."},
    other_words{
        deaf, "",
        "Check that the bridge passes on what it receives: it must write to the lidar, too. "
        "A one-way lidar takes no commands: name its model."},
    other_words{one_way_lidar, "",
                "Name the model that is attached: its word is in the remark. If it really is the "
                "one that was named, commands do not reach it: the bridge must write to the lidar, "
                "too."},
    other_words{answers_late, "",
                "Use a faster network, or give lidar_options::answer_time a larger value."},
    other_words{answers_wrong, "", remote_answer_advice},
    other_words{answers_twice, "", remote_answer_advice},
    other_words{answers_missing, "", remote_answer_advice},
    other_words{
        no_zero_angle, "",
        "Query it again. Or give it with --zero-angle (lidar_options::zero_angle): 0 if the "
        "angles are right without it."},
    other_words{
        health_error, "",
        "Switch the lidar off and on again. If it reports the error again, have it repaired; "
        "the manufacturer knows the error code."},
    other_words{brown_out, "", power_advice},
    other_words{reboots, "", power_advice},
    other_words{does_not_start, "",
                "Query its health; switch it off and on again. If this remains, it needs repair."},
    other_words{no_motor_power,
                "The lidar answers and accepts the start, but its motor does not turn: most likely "
                "its motor has no power, or needs the line DTR, which a bridge may not set.",
                "Give the motor its own power: the second plug of the lidar. If it has power, set "
                "the bridge so that DTR is on; check that nothing blocks the head."},
    other_words{unplugged, "The other side has closed the connection.",
                "Check that the bridge is running, that the network works, and that the lidar is "
                "attached to the bridge; then connect again."},
    other_words{stalls, "Nothing arrived for a while, although the connection exists.",
                "Check whether the head turns: if not, check the power supply and the motor; if it "
                "does, the network and the bridge."},
    other_words{interference,
                "Another program is connected to the bridge at the same time; each byte reaches "
                "only one of them.",
                "Close the other program: only one at a time can use the lidar."},
    other_words{bits_flipped, "Packets of the right length contain single wrong bits.",
                bridge_advice},
    other_words{bytes_dropped, "Single bytes are missing inside packets.", bridge_advice},
    other_words{bytes_inserted, "Bytes arrive that the lidar did not send.", bridge_advice},
    other_words{bursts, "Longer parts of packets of the right length are overwritten.",
                bridge_advice},
    other_words{packets_truncated,
                "Packets end too early: most likely a byte buffer on the way overflows.",
                bridge_advice},
    other_words{packets_lost,
                "Whole packets are missing while the others are intact: the bridge or the network "
                "loses them, or the computer is too slow.",
                bridge_advice},
    other_words{line_noise, "Bytes arrive that belong to no packet, and they show no pattern.",
                bridge_advice},
    other_words{usb_latency, "Bytes are held back and arrive in groups.", bridge_advice}};

constexpr std::string_view examine_advice =
    "Examine the lidar itself with g4-dump doctor: it shows whether this still happens, and what "
    "to try. If the bytes went through a terminal, a mail or a transfer of text, transfer them as "
    "binary.";

// Nothing that can be tried at this computer changes a file.
constexpr std::array of_file{
    other_words{
        no_lidar, "",
        "If it is a lidar, use its own driver. Otherwise examine the port of the lidar with "
        "g4-dump doctor."},
    other_words{
        unknown_bytes,
        "The file contains bytes of no known kind: of another device, at a wrong baud rate, "
        "or damaged.",
        "Record the lidar again at its baud rate: g4-dump doctor finds that at the port."},
    other_words{wrong_baud_rate,
                "From here on the bytes make no sense: they were received at another baud rate.",
                "Record the lidar again at its baud rate: g4-dump doctor finds that at the port."},
    other_words{no_zero_angle, "",
                "Give it with --zero-angle (lidar_options::zero_angle): 0 if the angles are right "
                "without it. Or record the lidar again from its start on."},
    other_words{
        stalls,
        "The bytes have a gap: the lidar sent nothing for a while, or what it sent "
        "was not recorded.",
        "Examine the lidar itself with g4-dump doctor: it shows whether this still happens, "
        "and what to try."},
    other_words{bits_flipped, "Packets of the right length contain single wrong bits.",
                examine_advice},
    other_words{bytes_dropped, "Single bytes are missing inside packets.", examine_advice},
    other_words{bytes_inserted, "There are bytes that the lidar did not send.", examine_advice},
    other_words{bursts, "Longer parts of packets of the right length are overwritten.",
                examine_advice},
    other_words{packets_truncated, "Packets end too early.", examine_advice},
    other_words{packets_lost, "Whole packets are missing while the others are intact.",
                examine_advice},
    other_words{line_noise, "There are bytes that belong to no packet, and they show no pattern.",
                examine_advice}};

std::span<const other_words> words_by(byte_path by) noexcept {
  if (by == byte_path::network) return of_network;
  if (by == byte_path::file) return of_file;
  return {};
}

/// A case of a diagnosis that needs other words; the advice is that of the error.
struct known_case {
  error_detail detail;
  diagnosis what;
  std::string_view cause;
};
constexpr std::array known_cases{
    known_case{error_detail::not_passed, diagnosis::permission,
               "The system does not let this process use the device, whatever the mode of the "
               "port."},
    known_case{error_detail::other_samples, other_device,
               "The packets of the lidar cannot be read as those of the model that was named."},
    known_case{
        error_detail::other_maker, other_device,
        "The bytes are those of a device of another kind, which this library does not read."},
    known_case{error_detail::unsupported_product, other_device,
               "The lidar is a product with another protocol, which this library does not read."},
    known_case{error_detail::missing_port, no_port, "There is no such port."},
    known_case{error_detail::missing_path, no_port, "There is no port and no file of this name."},
    known_case{error_detail::not_attached, no_port,
               "Nothing that is attached has this number or USB path."},
    known_case{error_detail::bad_name, no_port, "This does not name a lidar."},
    known_case{error_detail::other_bridges, no_port,
               "No port has the USB bridge that lidars usually have (CP2102)."}};

/// Diagnoses that blame the line of this computer.
bool is_of_line(diagnosis what) noexcept { return what == line_noise || what == usb_latency; }

}  // namespace

diagnosis_info stage_report::explain(diagnosis what) const noexcept {
  diagnosis_info info = describe(what);
  const auto all = words_by(by);
  if (const auto at = std::ranges::find(all, what, &other_words::what); at != all.end()) {
    if (!at->cause.empty()) info.cause = at->cause;
    info.advice = at->advice;
  }
  // In each row the last one.
  if (by == byte_path::network && !info.alternatives.empty() &&
      is_of_line(info.alternatives.back())) {
    info.alternatives = info.alternatives.first(info.alternatives.size() - 1);
  }
  const auto is_this = [&](const known_case& each) {
    return each.detail == detail && each.what == what;
  };
  if (const auto at = std::ranges::find_if(known_cases, is_this); at != known_cases.end()) {
    info.cause = at->cause;
    info.advice = error(task::opening, problem::no_port, {}, 0, detail).advice();
  } else if (what == other_device && stage != diagnostic_stage::identity) {
    // Only a number can be overruled.
    if (stage == diagnostic_stage::rate) {
      info.cause = "The lidar is another model than the one as which it is read.";
    }
    info.advice = "Check the label of the device: name its model, or the port of the other one.";
  }
  return info;
}

}  // namespace g4lidar
