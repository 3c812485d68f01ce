// SPDX-License-Identifier: MIT
// What an error says, in words.
#include "g4lidar/error.hpp"

#include <algorithm>
#include <cstring>

namespace g4lidar {
namespace {

struct words {
  problem what;
  std::string_view name;
  std::string_view says;    // "<task> <subject>: <says>."
  std::string_view advice;  // A sentence.
};

// In the order of the enumeration.
constexpr std::array<words, problem_count> all_words{{
    {problem::bad_option, "bad_option", "the value is not possible",
     "Correct the option, or leave it out: none of them need be set."},
    {problem::no_port, "no_port", "no serial port with a lidar was found",
     "Plug the lidar in with a data cable, and see whether `dmesg` tells of a new ttyUSB; in a "
     "container, hand the device in. Or name the port."},
    {problem::several_ports, "several_ports", "there is more than one lidar",
     "Say which is meant: by its path, as serial:<the lidar's number>, or as usb:<bus path>."},
    {problem::permission, "permission", "this user may not open it",
     "Install the udev rule, or join the group that owns the port (`sudo usermod -aG dialout "
     "$USER`) and log in again."},
    {problem::busy, "busy", "another program holds it",
     "End that program (`fuser -v <port>` names it); one program at a time can use the lidar."},
    {problem::not_serial, "not_serial", "this is not a serial port",
     "Name a serial port such as /dev/ttyUSB0."},
    {problem::bad_baud_rate, "bad_baud_rate", "the port cannot do this baud rate",
     "A G4 speaks at 230400 baud: use a bridge that can (CP2102), or leave the option out."},
    {problem::cannot_connect, "cannot_connect", "nobody answers at this address",
     "See that the bridge (ser2net, for one) runs, that host and port are right, and that no "
     "firewall stands between."},
    {problem::silence, "silence", "not a single byte came",
     "See that the lidar has power (its own 5 V supply if need be), that the cable carries data, "
     "that this is the lidar's port, and that the baud rate is its own: 230400 for a G4."},
    {problem::garbage, "garbage", "bytes came, but none that make sense",
     "Most likely the baud rate is wrong: a G4 speaks at 230400 baud. Else look for a loose cable "
     "or for another kind of device."},
    {problem::other_device, "other_device", "the device that answers is not a G4",
     "Look at the type plate, and name the port of the G4."},
    {problem::does_not_stop, "does_not_stop", "it goes on scanning and cannot be stopped",
     "Commands do not reach it: look at the wire from the host's transmit pin, or plug the lidar "
     "out and in."},
    {problem::unhealthy, "unhealthy", "the lidar says that it is defective",
     "Plug it out and in. If it says so again, have it repaired; the error code is for the maker."},
    {problem::timeout, "timeout", "nothing came in time",
     "Try again, or wait longer: a scan comes some 0.7 s after the start. If it stays so, plug the "
     "lidar out and in."},
    {problem::wrong_answer, "wrong_answer", "the answers do not belong to the question",
     "Try again. If it stays so, see that no other program talks to the lidar, and plug it out and "
     "in."},
    {problem::not_reached, "not_reached", "the lidar does not take this value",
     "Choose a value that the lidar offers; it stays with the nearest one that it took."},
    {problem::scanning, "scanning", "refused, since it would disturb the running scan",
     "Stop the scan first, or allow it to be interrupted (while_scanning::stop_and_resume)."},
    {problem::not_scanning, "not_scanning", "no scan is running", "Start the scan first."},
    {problem::gone, "gone", "the port is not there any more",
     "Unless the program has closed it, the lidar was unplugged: plug it in and open it again, or "
     "turn reconnecting on, so that the program goes on by itself."},
    {problem::stalled, "stalled", "the stream has stopped though the port is there",
     "See whether the head still turns: if not, power or motor; if so, cable or bridge."},
    {problem::brown_out, "brown_out", "the bytes stopped when the motor started",
     "The lidar gets too little power: give it a supply of its own, a shorter cable, or a port "
     "that can deliver 1 A."},
    {problem::interference, "interference", "another program reads from or writes to the port",
     "End the other program (`fuser -v <port>` names it); the udev rule keeps ModemManager and "
     "brltty off the port."},
    {problem::read_only, "read_only", "a file cannot be asked anything",
     "A file only gives its points: open the lidar itself for that."},
    {problem::bad_file, "bad_file", "there is nothing of use in this file",
     "Name a recording; what does not begin as one is read as bytes from a line with file:PATH."},
    {problem::end_of_input, "end_of_input", "there is no more to read",
     "A recording ends, a connection is closed by its other end: open it again."},
    {problem::cancelled, "cancelled", "woken by this program", "Nothing is wrong."},
    {problem::system, "system", "the system refused",
     "See what the system's error means; `dmesg` may say more."},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < all_words.size(); ++i) {
    if (static_cast<std::size_t>(all_words[i].what) != i) return false;
  }
  return true;
}
static_assert(in_order());

const words& words_of(problem what) noexcept { return all_words[static_cast<std::size_t>(what)]; }

constexpr std::array<std::string_view, 8> task_names{
    "finding", "opening", "configuring", "asking", "starting", "reading", "writing", "stopping"};

}  // namespace

error::error(g4lidar::task doing, problem what, std::string_view subject, int system_errno) noexcept
    : size_(static_cast<std::uint8_t>(std::min(subject.size(), subject_.size()))),
      errno_(system_errno),
      doing_(doing),
      what_(what) {
  std::copy_n(subject.begin(), size_, subject_.begin());
}

bool error::is_fatal() const noexcept {
  switch (what_) {
    case problem::timeout:
    case problem::wrong_answer:
    case problem::not_reached:
    case problem::scanning:
    case problem::read_only:
    case problem::cancelled:
      return false;
    default:
      return true;
  }
}

std::string_view error::advice() const noexcept { return words_of(what_).advice; }

std::string error::message() const {
  std::string text(name_of(doing_));
  if (size_ > 0) text.append(" ").append(subject());
  text.append(": ").append(words_of(what_).says);
  if (errno_ != 0) {
    // Of glibc; thread-safe and independent of the locale, unlike strerror.
    const char* name = strerrorname_np(errno_);
    const char* says = strerrordesc_np(errno_);
    if (name != nullptr && says != nullptr) {
      text.append(" (").append(name).append(", ").append(says).append(")");
    }
  }
  return text.append(". ").append(words_of(what_).advice);
}

std::string_view name_of(problem what) noexcept { return words_of(what).name; }

std::string_view name_of(task doing) noexcept {
  return task_names[static_cast<std::size_t>(doing)];
}

}  // namespace g4lidar
