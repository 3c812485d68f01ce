// SPDX-License-Identifier: MIT
#include "port_holder.hpp"

#include <sys/sysmacros.h>
#include <termios.h>

#include <array>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>
#include <optional>
#include <string_view>

#include "core/one_of.hpp"
#include "custom_baud.hpp"
#include "directory.hpp"
#include "system_calls.hpp"

namespace g4lidar {
namespace {

bool is_number(std::string_view text) noexcept {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// "screen (1234)", or "1234" if the name is not known.
std::string program(std::string_view pid) {
  const std::string number(pid);
  std::string name;
  std::ifstream comm("/proc/" + number + "/comm");
  std::getline(comm, name);
  return name.empty() ? number : name + " (" + number + ")";
}

/// The process in a line of /proc/locks, if the line is about the file:
/// "1: FLOCK  ADVISORY  WRITE 1234 00:05:678 0 EOF"
std::optional<long> locker(const std::string& line, const struct stat& file) {
  long pid = 0;
  unsigned major_number = 0;
  unsigned minor_number = 0;
  unsigned long inode = 0;
  if (std::sscanf(line.c_str(), "%*u: FLOCK %*s %*s %ld %x:%x:%lu", &pid, &major_number,
                  &minor_number, &inode) != 4) {
    return std::nullopt;
  }
  const bool is_it = major_number == major(file.st_dev) && minor_number == minor(file.st_dev) &&
                     inode == file.st_ino;
  // 0 and less: a process that is not visible from this container.
  return is_it && pid > 0 ? std::optional(pid) : std::nullopt;
}

/// Whether this open file, "/proc/1234/fd/5", is the device at `path`. In another container a link with the same
/// target may be another device.
bool is_device_at(const std::string& path, const std::string& open_file) noexcept {
  struct stat here{};
  struct stat there{};
  return ::stat(path.c_str(), &here) == 0 && ::stat(open_file.c_str(), &there) == 0 &&
         here.st_rdev == there.st_rdev && here.st_dev == there.st_dev;
}

bool can_come_of_a_port_conflict(problem what) noexcept {
  using enum problem;
  return is_one_of(what, silence, garbage, does_not_stop, timeout, wrong_answer, stalled, brown_out,
                   interference);
}

/// No permission is needed for this, so it also detects processes of root.
bool has_other_settings(const transport& port) noexcept {
  termios now{};
  if (port.native_handle() < 0 || ::tcgetattr(port.native_handle(), &now) != 0) return false;
  if ((now.c_lflag & (ICANON | ECHO)) != 0 || (now.c_iflag & IXON) != 0) return true;
  const std::uint32_t baud = custom_baud(real_system_calls().ioctl, port.native_handle());
  return baud != 0 && !is_near(baud, port.baud());
}

error looked_into(const error& why, const transport& port) {
  const std::string path(port.name());
  if (const std::string program = port_conflict(path); !program.empty()) {
    return {why.doing(), problem::interference, path + ", also used by " + program};
  }
  if (has_other_settings(port)) {
    return {why.doing(), problem::interference, path + ", whose settings were changed"};
  }
  return why;
}

}  // namespace

bool is_pty_master(const struct stat& file) noexcept {
  const auto number = major(file.st_rdev);
  const bool is_multiplexer = number == 5 && minor(file.st_rdev) == 2;
  const bool is_master = number == 2 || (number >= 128 && number <= 135);
  return S_ISCHR(file.st_mode) && (is_multiplexer || is_master);
}

std::string lock_holder(const struct stat& file) {
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    if (const auto pid = locker(line, file)) return program(std::to_string(*pid));
  }
  return {};
}

std::map<std::string, std::string> device_holders() {
  std::map<std::string, std::string> holders;
  each_entry("/proc", [&](std::string_view pid) {
    if (!is_number(pid)) return;
    const std::string files = "/proc/" + std::string(pid) + "/fd/";
    each_entry(files, [&](std::string_view fd) {
      if (!is_number(fd)) return;
      const std::string file = files + std::string(fd);
      const std::string target = link_target(file);
      if (target.starts_with("/dev/") && !holders.contains(target) && is_device_at(target, file)) {
        holders.emplace(target, program(pid));
      }
    });
  });
  return holders;
}

std::string port_holder(const std::string& path) {
  struct stat file{};
  if (::stat(path.c_str(), &file) == 0) {
    if (std::string locked = lock_holder(file); !locked.empty()) return locked;
  }
  std::array<char, PATH_MAX> real{};
  if (::realpath(path.c_str(), real.data()) == nullptr) return {};
  const auto holders = device_holders();
  const auto found = holders.find(real.data());
  return found == holders.end() ? std::string() : found->second;
}

std::string port_conflict(const std::string& path) {
  std::array<char, PATH_MAX> real{};
  if (::realpath(path.c_str(), real.data()) == nullptr) return {};
  const std::string self = std::to_string(::getpid());
  const bool is_pty = std::string_view(real.data()).starts_with("/dev/pts/");
  std::string name;
  each_entry("/proc", [&](std::string_view pid) {
    if (!name.empty() || !is_number(pid) || pid == self) return;
    const std::string files = "/proc/" + std::string(pid) + "/fd/";
    bool has_port = false;
    bool has_master = false;
    each_entry(files, [&](std::string_view fd) {
      const std::string file = files + std::string(fd);
      const std::string target = link_target(file);
      has_port = has_port || (target == real.data() && is_device_at(target, file));
      has_master = has_master || (is_pty && target.ends_with("/ptmx"));
    });
    if (has_port && !has_master) name = program(pid);
  });
  return name;
}

/// A lock stops processes that open the port later and respect locks. A process that opened it
/// before, and processes of root, can still read the bytes of the device: usually half of each
/// answer.
error with_port_conflict(const error& why, const transport& port) noexcept {
  if (!can_come_of_a_port_conflict(why.code()) || !port.name().starts_with('/')) return why;
  try {
    return looked_into(why, port);
  } catch (const std::bad_alloc&) {
    return why;
  }
}

}  // namespace g4lidar
