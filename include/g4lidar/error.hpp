// SPDX-License-Identifier: MIT
// Errors: what was being done, what went wrong, and what to try; and text that is safe to print.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include <tl/expected.hpp>

#include "g4lidar/detail/api.hpp"

namespace g4lidar {

/// What was being done when something went wrong.
enum class task : std::uint8_t {
  finding,      ///< Looking for a port or a device.
  opening,      ///< Opening a port, a connection or a file.
  configuring,  ///< Setting options, of the port or of the device.
  asking,       ///< Waiting for the reply to a command.
  starting,     ///< Starting the scan.
  reading,      ///< Reading the stream.
  writing,      ///< Sending a command.
  stopping,     ///< Stopping the scan.
};

/// Every problem. A closed set: `docs/errors.md` has a paragraph for each.
enum class problem : std::uint8_t {
  bad_option,      ///< A value that is invalid for an option.
  no_port,         ///< No serial port, or none to which a lidar may be attached.
  several_ports,   ///< More than one lidar, and the caller did not name one.
  permission,      ///< This user may not open it.
  busy,            ///< Another program has it open, exclusively.
  not_serial,      ///< The path is no serial port.
  bad_baud_rate,   ///< The port cannot do the baud rate.
  cannot_connect,  ///< The remote end of a network connection does not answer.
  silence,         ///< Not a single byte arrived.
  garbage,         ///< Bytes arrived, none of them valid: the wrong baud rate or another device.
  other_device,    ///< A device answers that is not the model that was expected.
  does_not_stop,   ///< The device scans and does not react to a stop command.
  unhealthy,       ///< The device reports an error of its own.
  timeout,         ///< What was awaited did not arrive in time; a retry may help.
  wrong_answer,    ///< Replies arrived, none of them valid for the command.
  not_reached,     ///< The device did not reach the wanted setting.
  bad_setting,     ///< Refused: the model cannot be set to this value. Nothing was sent.
  scanning,        ///< Refused: the command would disturb the running scan.
  not_scanning,    ///< Points were requested, but no scan has been started.
  reconnecting,    ///< The lidar was lost, and the driver is looking for it.
  gone,            ///< Unplugged: the port does not exist any more.
  stalled,         ///< The stream has stopped although the port is there.
  brown_out,       ///< The bytes stopped when the motor started: insufficient power.
  interference,    ///< Another program reads from or writes to the port.
  read_only,       ///< A file was queried or configured like a device.
  bad_file,        ///< A file without usable content: not a recording, or no intact part.
  end_of_input,    ///< A file or connection has ended.
  cancelled,       ///< Woken from another thread or a signal handler.
  system,          ///< The system refused for another reason; see `system_errno`.
  not_supported,   ///< Refused: this model of lidar has no such command. Nothing was sent.
};

/// The number of problems.
inline constexpr std::size_t problem_count = static_cast<std::size_t>(problem::not_supported) + 1;

/// Distinguishes errors of one problem that need different advice.
enum class error_detail : std::uint8_t {
  usual,          ///< The only case of most problems.
  spinning_up,    ///< timeout: no scan has come since the start, because the motor spins up.
  searching,      ///< timeout: the lidar was lost, or is not there yet, and is looked for.
  missing_port,   ///< no_port: the port that was named does not exist.
  missing_path,   ///< no_port: neither a port nor a file has the name that was given.
  not_attached,   ///< no_port: no lidar has the number, or no port the USB path, that was given.
  bad_name,       ///< bad_option: the name of a lidar that is none.
  simulated,      ///< bad_option, bad_file: no simulated lidar can be made of what `sim:` names.
  no_simulator,   ///< bad_option: `sim:`, in a library that was built without the simulator.
  motor_line,     ///< brown_out: a motor that the line DTR drives has never turned.
  unknown_model,  ///< bad_file: a recording of a model, or in a version, that is not known.
  unsupported_product,  ///< other_device: a product of the manufacturer with another protocol.
  answered_before,  ///< silence, garbage: the lidar had identified itself, so its model and its baud rate are right.
  searched,  ///< silence: no model was named, and no lidar answered or sent at any rate that was tried.
  no_revolution,   ///< timeout: packets arrive, but no revolution was complete.
  resting,         ///< timeout: the motor stands, because background_reader::rest() was called.
  of_file,         ///< timeout: no scan of the file that is played was due.
  not_sent,        ///< timeout: the port did not accept the bytes of a command.
  other_source,    ///< bad_option: the option is for another kind of source (transport/source.hpp).
  several_models,  ///< bad_file: the parts of a recording state different models of lidar.
  other_samples,  ///< other_device: packets whose samples have another size than those of the named model.
  other_maker,  ///< other_device: packets of another maker, or of another kind of device.
  not_passed,  ///< permission: not by the mode of the port: a container or a sandbox may not use the device.
  other_bridges,  ///< no_port: there are ports that were not looked at, because they have another USB bridge.
  only_listens,  ///< not_supported: the lidar is only listened to (lidar_options::listen_only), or answers nothing.
  known_bytes,  ///< garbage: text, an echo, or bytes that were changed on their way; the subject has what to do.
};
/// The last one: the rows of a table of texts are counted by it.
inline constexpr error_detail last_error_detail = error_detail::known_bytes;

/// One error. Trivially copyable, never allocates.
class G4LIDAR_API error {
 public:
  /// `subject` is what the error is about (a path, an option and its value); cut at 159 bytes. Control characters and
  /// what is not valid UTF-8 become escapes such as `\x0A`.
  error(task doing, problem code, std::string_view subject = {}, int system_errno = 0,
        error_detail detail = error_detail::usual) noexcept;

  /// What was being done.
  [[nodiscard]] g4lidar::task doing() const noexcept { return doing_; }
  /// What went wrong.
  [[nodiscard]] problem code() const noexcept { return code_; }
  /// Which case of that problem it is.
  [[nodiscard]] error_detail detail() const noexcept { return detail_; }
  /// The error number of the system, or 0.
  [[nodiscard]] int system_errno() const noexcept { return errno_; }
  /// Valid as long as this error.
  [[nodiscard]] std::string_view subject() const& noexcept { return {subject_.data(), size_}; }
  std::string_view subject() const&& = delete;

  /// Whether further calls on the same object cannot succeed, so that a loop should end. Not fatal:
  /// timeout, wrong_answer, not_reached, scanning, reconnecting, read_only, cancelled and not_supported; the
  /// object works as before.
  [[nodiscard]] bool is_fatal() const noexcept;
  /// Whether another attempt to open and start the same lidar may succeed, because a cause outside of the program may
  /// pass: a missing port, a missing permission before udev has set it, another program. Not for a mistake in the
  /// options, another model, the content of a file, or a refusal of the system. lidar_options::device_wait covers
  /// these errors, and no others.
  [[nodiscard]] bool may_pass() const noexcept;

  /// What to try, a sentence. Valid forever.
  [[nodiscard]] std::string_view advice() const noexcept;

  /// The complete text: "opening /dev/ttyUSB0 of group dialout: this user may not open it (EACCES,
  /// Permission denied). Install the udev rule, or join ...". Allocates.
  [[nodiscard]] std::string message() const;

  /// Whether the problem is this one: `if (scan.error() == problem::timeout)`.
  [[nodiscard]] friend bool operator==(const error& a, problem b) noexcept { return a.code_ == b; }

 private:
  std::array<char, 159> subject_{};
  std::uint8_t size_ = 0;
  int errno_ = 0;
  g4lidar::task doing_;
  problem code_;
  error_detail detail_;
};

/// The name in tools and documents: "permission", "no_port". Valid forever.
[[nodiscard]] G4LIDAR_API std::string_view name_of(problem code) noexcept;
/// A description: "this user may not open it". Valid forever.
[[nodiscard]] G4LIDAR_API std::string_view description_of(problem code) noexcept;
/// The name in tools and documents: "opening", "reading". Valid forever.
[[nodiscard]] G4LIDAR_API std::string_view name_of(task doing) noexcept;

/// A value, or an error instead of it.
template <class T>
using result = tl::expected<T, error>;

/// A result whose value is a view into the object that returned it. In a variable it is used like
/// any result. A temporary gives only a copy of the view: `for (auto& p : *lidar->try_scan(2s))`
/// is correct, and `lidar->try_scan(2s)->points`, a use after the end of the view, does not
/// compile.
template <class View>
class view_result : public result<View> {
 public:
  using result<View>::result;
  /// From any result.
  view_result(result<View> given) noexcept : result<View>(std::move(given)) {}

  /// The view; of a temporary a copy of it.
  [[nodiscard]] const View& operator*() const& noexcept { return result<View>::operator*(); }
  /// The same.
  [[nodiscard]] View operator*() && noexcept { return result<View>::operator*(); }
  /// The same.
  [[nodiscard]] const View* operator->() const& noexcept { return result<View>::operator->(); }
  const View* operator->() && = delete;
  /// The same, checked: throws tl::bad_expected_access where there is an error.
  [[nodiscard]] const View& value() const& { return result<View>::value(); }
  /// The same.
  [[nodiscard]] View value() && { return result<View>::value(); }
};

/// For `return failure(task::opening, problem::busy, path);` in a function that returns a result.
[[nodiscard]] inline tl::unexpected<error> failure(task doing, problem code,
                                                   std::string_view subject = {},
                                                   int system_errno = 0,
                                                   error_detail detail = {}) noexcept {
  return tl::unexpected<error>(error(doing, code, subject, system_errno, detail));
}

/// `text` as one line without control characters: printable ASCII and other characters of valid
/// UTF-8 unchanged, a backslash as `\\`, each other byte (control characters, C1 controls, invalid
/// UTF-8) as `\x1B`. The result contains no byte that a terminal interprets. *Pure*, allocates the
/// result.
[[nodiscard]] G4LIDAR_API std::string printable(std::string_view text);

}  // namespace g4lidar
