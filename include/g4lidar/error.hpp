// SPDX-License-Identifier: MIT
// Errors of the outside world: what was being done, what went wrong, and what to try.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "g4lidar/export.hpp"

namespace g4lidar {

/// What was being done when something went wrong.
enum class task : std::uint8_t {
  finding,      ///< Looking for a port or a device.
  opening,      ///< Opening a port, a connection or a file.
  configuring,  ///< Setting options, of the port or of the device.
  asking,       ///< Waiting for the answer to a command.
  starting,     ///< Starting the scan.
  reading,      ///< Reading the stream.
  writing,      ///< Sending a command.
  stopping,     ///< Stopping the scan.
};

/// Everything that can go wrong. A closed set: `docs/errors.md` has a paragraph for each.
enum class problem : std::uint8_t {
  bad_option,      ///< A value that an option cannot have; a caller's text, most often.
  no_port,         ///< No port, or none that a G4 can be behind.
  several_ports,   ///< More than one G4, and no word which is meant.
  permission,      ///< The user may not open it.
  busy,            ///< Another program has it open, exclusively.
  not_serial,      ///< The path is no serial port.
  bad_baud_rate,   ///< The port cannot do the baud rate.
  cannot_connect,  ///< The other end of a network connection does not answer.
  silence,         ///< Not a single byte came.
  garbage,         ///< Bytes came, and no frame: the wrong baud rate or another device.
  other_device,    ///< It answers, and is no G4.
  does_not_stop,   ///< It scans and cannot be stopped: commands do not reach it.
  unhealthy,       ///< It says that it is defective.
  timeout,         ///< Nothing came in time; it is worth trying again.
  wrong_answer,    ///< Answers came, none of them possible for the question.
  not_reached,     ///< A setting went another way than asked: the device refuses it.
  scanning,        ///< Refused: the command would disturb the running scan.
  not_scanning,    ///< Points were asked for, and no scan has been started.
  gone,            ///< Unplugged: the port has vanished.
  stalled,         ///< The stream has stopped although the port is there.
  brown_out,       ///< The bytes stopped when the motor started: too little power.
  interference,    ///< Another program reads from or writes to the port.
  read_only,       ///< A file was to be asked or set, as if it were a device.
  bad_file,        ///< A file that holds nothing of use: no recording, or nothing in it is whole.
  end_of_input,    ///< A file or connection has ended.
  cancelled,       ///< Woken, from another thread or a signal handler.
  system,          ///< The system refused for a reason of its own; see `system_errno`.
};

/// How many problems there are.
inline constexpr std::size_t problem_count = static_cast<std::size_t>(problem::system) + 1;

/// One error. Trivially copyable, never allocates.
class G4LIDAR_API error {
 public:
  /// `subject` is what it is about (a path, an option and its value); cut at 95 bytes.
  error(task doing, problem what, std::string_view subject = {}, int system_errno = 0) noexcept;

  /// What was being done.
  [[nodiscard]] g4lidar::task doing() const noexcept { return doing_; }
  /// What went wrong.
  [[nodiscard]] problem what() const noexcept { return what_; }
  /// The system's own error number, or 0.
  [[nodiscard]] int system_errno() const noexcept { return errno_; }
  /// Good as long as this error.
  [[nodiscard]] std::string_view subject() const& noexcept { return {subject_.data(), size_}; }
  std::string_view subject() const&& = delete;

  /// Whether going on with the same object is of no use, so that a loop should end. Not fatal are
  /// timeout, wrong_answer, not_reached, scanning, read_only and cancelled: the object works as before.
  [[nodiscard]] bool is_fatal() const noexcept;

  /// What to try, a sentence; it lives for ever.
  [[nodiscard]] std::string_view advice() const noexcept;

  /// All of it: "opening /dev/ttyUSB0 of group dialout: this user may not open it (EACCES, Permission
  /// denied). Install the udev rule, or join ...". Allocates.
  [[nodiscard]] std::string message() const;

 private:
  std::array<char, 95> subject_{};
  std::uint8_t size_ = 0;
  int errno_ = 0;
  g4lidar::task doing_;
  problem what_;
};

/// The words of the tools and documents: "permission", "no_port". They live for ever.
[[nodiscard]] G4LIDAR_API std::string_view name_of(problem what) noexcept;
/// The same: "opening", "reading". They live for ever.
[[nodiscard]] G4LIDAR_API std::string_view name_of(task doing) noexcept;

/// A value, or the error that there is in its place.
template <class T>
using result = tl::expected<T, error>;

/// For `return failure(task::opening, problem::busy, path);` in a function that gives a result.
[[nodiscard]] inline tl::unexpected<error> failure(task doing, problem what,
                                                   std::string_view subject = {},
                                                   int system_errno = 0) noexcept {
  return tl::unexpected<error>(error(doing, what, subject, system_errno));
}

}  // namespace g4lidar
