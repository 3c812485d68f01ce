// SPDX-License-Identifier: MIT
// The text of an error.
#include "g4lidar/error.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <utility>

#include "core/enumerators.hpp"
#include "one_of.hpp"
#include "printable_text.hpp"

// Of glibc 2.32 and later; thread-safe and independent of the locale, unlike strerror.
extern "C" {  // NOLINTBEGIN(readability-redundant-declaration): they are weak
[[gnu::weak]] const char* strerrorname_np(int) noexcept;
[[gnu::weak]] const char* strerrordesc_np(int) noexcept;
}  // NOLINTEND(readability-redundant-declaration)

namespace g4lidar {
namespace {

struct words {
  problem what;
  std::string_view name;
  std::string_view cause;   // "<task> <subject>: <cause>."
  std::string_view advice;  // A sentence.
};

// In the order of the enumeration.
constexpr std::array<words, problem_count> all_words{{
    {problem::bad_option, "bad_option", "the option cannot have this value",
     "Correct the value or omit the option; every option has a default."},
    {problem::no_port, "no_port", "no serial port with a lidar was found",
     "Connect the lidar with a data cable and check `dmesg` for a new ttyUSB port; in a container, "
     "pass the device through. Or name the port; sim: is a simulated lidar."},
    {problem::several_ports, "several_ports", "more than one lidar is connected",
     "Name one: by its path, as serial:<number of the lidar>, or as usb:<USB path>."},
    {problem::permission, "permission", "this user has no permission to open it",
     "Install the udev rule, or join the group that owns the port (`sudo usermod -aG dialout "
     "$USER`) and log in again."},
    {problem::busy, "busy", "another program has it open",
     "Close that program (`fuser -v <port>` names it); only one program at a time can use the "
     "lidar."},
    {problem::not_serial, "not_serial", "this is not a serial port",
     "Name a serial port such as /dev/ttyUSB0; for a recording or a file of bytes, write "
     "file:PATH."},
    {problem::bad_baud_rate, "bad_baud_rate", "the port does not support this baud rate",
     "Use an adapter that supports the baud rate of the lidar (CP2102), or omit the option baud, "
     "so "
     "that the rate of the model is used."},
    {problem::cannot_connect, "cannot_connect", "the network address does not answer",
     "Check that the bridge (for example ser2net) is running, that host and port are correct, and "
     "that no firewall blocks them."},
    {problem::silence, "silence", "no byte was received",
     "Check that the lidar has power (its own supply if necessary), that the cable carries data, "
     "and "
     "that this is its port. If a model or a baud rate was named, check it, or omit it: then all "
     "rates "
     "are tried (--model and --baud; in a program the options model and baud)."},
    {problem::garbage, "garbage", "bytes were received, but no valid data",
     "If a model or a baud rate was named, it is probably wrong: correct it, or omit it, and all "
     "rates "
     "are tried (--model and --baud; in a program the options model and baud). Otherwise check for "
     "a "
     "loose cable or another kind of device."},
    {problem::other_device, "other_device",
     "the device that answers is not the model that was expected",
     "Check the label of the device: name its model, or the port of the other one. If the named "
     "model is right, insist on it (option insist_on_model, --model WORD!)."},
    {problem::does_not_stop, "does_not_stop", "it continues to scan and cannot be stopped",
     "Commands do not reach it: check the wire of the host's transmit pin, or unplug the lidar and "
     "plug it in again. A one-way lidar takes no commands: name its model."},
    {problem::unhealthy, "unhealthy", "the lidar reports that it is defective",
     "Unplug it and plug it in again. If it reports the error again, have it repaired; the "
     "manufacturer knows the error code."},
    {problem::timeout, "timeout", "what was awaited did not arrive in time",
     "Try again, or wait longer. If it fails again, unplug the lidar and plug it in again."},
    {problem::wrong_answer, "wrong_answer", "the answers do not match the request",
     "Try again. If it fails again, check that no other program uses the lidar, and unplug it and "
     "plug it in again."},
    {problem::not_reached, "not_reached", "the lidar does not accept this value",
     "Choose a value that the lidar supports; it keeps the nearest value that it accepted."},
    {problem::bad_setting, "bad_setting", "this model of lidar cannot be set to this value",
     "Choose a scan frequency within the limits of the model, and for other settings one of the "
     "named values."},
    {problem::scanning, "scanning", "refused, because it would disturb the running scan",
     "Stop the scan first, or allow it to be interrupted."},
    {problem::not_scanning, "not_scanning", "no scan is running", "Start the scan first."},
    {problem::reconnecting, "reconnecting",
     "the connection was lost, and the driver is reconnecting",
     "Call again: the next call waits until the lidar is back. If it does not come back, check the "
     "plug, the cable and the power supply."},
    {problem::gone, "gone", "the port is no longer there",
     "Unless the program closed it, the lidar was unplugged: plug it in and open it again."},
    {problem::stalled, "stalled", "the data stopped although the port is still there",
     "Check whether the head turns: if not, check the power supply and the motor; if it does, the "
     "cable and the adapter."},
    {problem::brown_out, "brown_out", "the data stopped when the motor started",
     "The lidar gets too little power: use a separate supply, a shorter cable, or a port that can "
     "deliver 1 A."},
    {problem::interference, "interference", "another program reads from or writes to the port",
     "Close the other program (`fuser -v <port>` names it); the udev rule keeps ModemManager and "
     "brltty away from the port."},
    {problem::read_only, "read_only", "a file cannot be asked or set",
     "A file contains only recorded data: open the lidar itself for that."},
    {problem::bad_file, "bad_file", "the file contains nothing that can be used",
     "Name a recording. To read a file as raw bytes of a port, write file:PATH."},
    {problem::end_of_input, "end_of_input", "there is no more data to read",
     "The recording has ended, or the other side has closed the connection: open it again."},
    {problem::cancelled, "cancelled", "cancelled by this program",
     "Nothing is wrong: the program called wake()."},
    {problem::system, "system", "the operating system reported an error",
     "Check what the system error means; `dmesg` may show more."},
    {problem::not_supported, "not_supported", "this model of lidar has no such command",
     "Omit the setting or the request. If the lidar is another model, name it with the option "
     "model."},
}};

// Of the details other than the usual one, in the order of their enumeration. Without a cause it is that of
// the problem.
struct detail_words {
  std::string_view cause;
  std::string_view advice;
};
constexpr std::array<detail_words, 25> all_details{{
    {"no scan arrived in time, because the motor spins up",
     "Call again or wait longer: the first scan arrives about 0.7 s after the start, later with a "
     "heavy or cold motor. If the head does not turn within 10 s, check the power supply."},
    {"no scan arrived in time: the lidar was lost or is not there yet, and the driver is looking "
     "for it",
     "Check the plug, the cable and the power supply, and call again: scans continue when the "
     "lidar is back."},
    {"this port does not exist",
     "Name a port that exists, or connect the lidar with a data cable and check `dmesg` for a new "
     "ttyUSB port; in a container, pass the device through. Without a name the only lidar is "
     "opened."},
    {"there is no port and no file of this name",
     "Give the path of a port such as /dev/ttyUSB0, or of a recording that exists."},
    {"nothing that is attached has this number or USB path",
     "Compare it with the label of the lidar, or with `g4-dump list --probe`. Connect the lidar "
     "with "
     "a data cable, and check that it has power."},
    {"this does not name a lidar",
     "A lidar is named by a path (/dev/ttyUSB0), serial:<its number of 16 digits>, usb:<USB path, "
     "1-1.4>, tcp:<host>:<port>, file:<path>, or sim:. Without a name the only lidar is opened."},
    {"this describes no simulated lidar",
     "`sim:` alone is a healthy simulated G4; docs/sim.md lists what can follow it, and the format "
     "of "
     "worlds and paths."},
    {"this program has no simulated lidar",
     "Its libg4lidar was built with G4LIDAR_SIM=OFF: use one that was built with the simulator, or "
     "open "
     "the port that `g4-dump sim` prints."},
    {"the scan was confirmed, but the motor never turned",
     "Plug in the second (power) plug of its board: the data plug alone does not feed the motor. "
     "The line "
     "DTR of the port must reach the board: it starts and stops the motor."},
    {"a recording of a model of lidar, or in a version, that this library does not know",
     "Read it with the libg4lidar that made it, or a newer one."},
    {"a product with another protocol, which this library does not read",
     "Use its manufacturer's software. docs/models.md lists the models that this library reads."},
    {"",  // that of the problem
     "The lidar answered before, so its model and its baud rate are right. Check its power supply, "
     "the "
     "cable and the adapter, and that no other program uses the port."},
    {"",
     "Check the plugs, the power supply (an X4 has a second plug) and that this is its port. A "
     "lidar "
     "without commands, such as an X2, sends only while its motor turns. Or name the model or its "
     "baud "
     "rate (options model and baud, --model and --baud)."},
    {"packets arrive, but no revolution was complete in time",
     "Use a timeout that is longer than a revolution (0.2 s at 5 Hz). If it is longer, the motor "
     "turns too slowly: check "
     "its power supply, and that nothing touches the head."},
    {"no scan arrived in time, because the motor rests",
     "The program has called rest(true): call rest(false), and scans come when the motor has spun "
     "up."},
    {"no scan of the file was due in time",
     "Wait longer, or play it faster. While it is paused, and where the recorded lidar was stopped "
     "or lost, it gives no "
     "scan."},
    {"the port did not accept the command in time",
     "Check the adapter, or the network and its bridge. If it fails again, unplug the lidar and "
     "plug it in again."},
    {"the source cannot use this option",
     "Omit the option: a lidar has no playback, a file has no settings and no connection, and only "
     "ports are searched."},
    {"parts of this recording state different models of lidar",
     "Recordings of two lidars have been joined, or the file is damaged: use the recording of each "
     "lidar by itself."},
    {"the packets of the lidar cannot be read as those of the model that was named",
     "Omit the model (option model, --model): the packets are then read as they show. Or give the "
     "port or the file of a lidar of that model."},
    {"the bytes are those of a device of another kind, which this library does not read",
     "Use the driver of that device, or name the port of the lidar."},
    {"the system does not let this process use the device, whatever the mode of the port",
     "Pass the device to the container (`docker run --device /dev/ttyUSB0`), or allow it to the "
     "service or the sandbox in which the program runs."},
    {"no port has the USB bridge that lidars usually have (CP2102)",
     "`g4-dump doctor <port>` looks at one of them: then name it. Or look at all of them "
     "(--all-ports; in a program the "
     "option probe_all_ports). Else connect the lidar with a data cable, and check `dmesg`."},
    {"no command is sent to this lidar, because it is only listened to or answers nothing",
     "Omit the setting or the request, or open the lidar without listening only (--listen; in a "
     "program the option listen_only). If it answers nothing, check the wire to its Rx pin."},
    {"these are no packets as a lidar sends them",
     "Do what the sentence before this one asks for, or name the port of the lidar."},
}};
static_assert(all_details.size() == static_cast<std::size_t>(last_error_detail));

constexpr bool in_order() {
  for (std::size_t i = 0; i < all_words.size(); ++i) {
    if (static_cast<std::size_t>(all_words[i].what) != i) return false;
  }
  return true;
}
static_assert(in_order());

const words& words_of(problem what) noexcept { return detail::row_of(all_words, what); }

detail_words words_of(problem code, error_detail detail) noexcept {
  if (detail == error_detail::usual) return {words_of(code).cause, words_of(code).advice};
  detail_words found = detail::row_of(all_details, static_cast<std::size_t>(detail) - 1);
  if (found.cause.empty()) found.cause = words_of(code).cause;
  return found;
}

constexpr std::array<std::string_view, 8> task_names{
    "finding", "opening", "configuring", "asking", "starting", "reading", "writing", "stopping"};

}  // namespace

error::error(g4lidar::task doing, problem code, std::string_view subject, int system_errno,
             error_detail detail) noexcept
    : errno_(system_errno), doing_(doing), code_(code), detail_(detail) {
  bool is_full = false;
  each_printable(subject.substr(0, subject_.size()), [&](std::string_view piece) {
    is_full = is_full || piece.size() > subject_.size() - size_;
    if (is_full) return;
    std::copy(piece.begin(), piece.end(), subject_.begin() + size_);
    size_ = static_cast<std::uint8_t>(size_ + piece.size());
  });
}

bool error::is_fatal() const noexcept {
  using enum problem;
  return !is_one_of(code_, timeout, wrong_answer, not_reached, bad_setting, scanning, reconnecting,
                    read_only, cancelled, not_supported);
}

bool error::may_pass() const noexcept {
  using enum problem;
  return !is_one_of(code_, bad_option, not_serial, bad_baud_rate, other_device, bad_setting,
                    read_only, bad_file, end_of_input, cancelled, system, not_supported);
}

std::string_view error::advice() const noexcept {
  if (errno_ == EMFILE)
    return "Too many files are open: raise the limit, as with `ulimit -n 1024`.";
  if (errno_ == ELIBACC)
    return "Install libudev (on Debian the package libudev1), or name the port: without it no "
           "ports are listed.";
  return words_of(code_, detail_).advice;
}

std::string errno_text(int number, errno_word name, errno_word description) {
  const bool has_words = name != nullptr && description != nullptr;
  if (has_words && name(number) == nullptr) return {};
  return " (" + (has_words ? name(number) : "errno " + std::to_string(number)) + ", " +
         (has_words ? description(number) : std::generic_category().message(number)) + ")";
}

std::string error::message() const {
  std::string text(name_of(doing_));
  if (size_ > 0) text.append(" ").append(subject());
  text.append(": ").append(words_of(code_, detail_).cause);
  if (errno_ != 0) text += errno_text(errno_, &strerrorname_np, &strerrordesc_np);
  return text.append(". ").append(advice());
}

std::string_view name_of(problem code) noexcept { return words_of(code).name; }

std::string_view description_of(problem code) noexcept { return words_of(code).cause; }

std::string_view name_of(task doing) noexcept { return detail::name_in(task_names, doing); }

}  // namespace g4lidar
