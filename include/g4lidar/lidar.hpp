// SPDX-License-Identifier: MIT
// The driver: an opened G4 that is asked, started, read, and found again after an unplug.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "g4lidar/command.hpp"
#include "g4lidar/connector.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/point_ring.hpp"
#include "g4lidar/request.hpp"
#include "g4lidar/response.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/session.hpp"
#include "g4lidar/stream_counts.hpp"
#include "g4lidar/transport.hpp"

namespace g4lidar {

/// How a lidar is opened and used. Nothing need be set. A setting of the device that is not given
/// stays as the device has it; one that is given is set at each start, and again after a reconnect or
/// when the device seems to have begun anew.
struct lidar_options {
  /// Which one: empty for the only G4; a path; `serial:2021101000070073` (the lidar's own number);
  /// `usb:1-1.4` (a bus path); `tcp:host:port` (a raw bridge); `file:PATH` (a recording, or bytes as
  /// they came from a port). A recording can be named by its path alone.
  std::string device;
  /// Bits a second, of a serial port and of the one behind `tcp:`; others know their own.
  std::uint32_t baud = 230400;

  std::optional<ranging_frequency> ranging;         ///< Measurements a second.
  std::optional<scan_frequency> frequency;          ///< Revolutions a second, 5 to 12 Hz.
  std::optional<motor_direction> direction;         ///< Which way it turns.
  std::optional<constant_frequency> constant;       ///< Whether it holds its frequency.
  std::optional<low_power> idle;                    ///< Whether the motor rests when idle.
  std::optional<power_down_protection> protection;  ///< Stops when the host falls silent.

  bool reconnect = false;  ///< Whether to go on by itself after a loss; see lidar::next_event().
  std::chrono::milliseconds longest_backoff{1000};  ///< Between attempts; 1 ms to 1 s.
  std::chrono::milliseconds answer_time{300};       ///< An answer has come by then; 10 ms to 10 s.
  std::chrono::milliseconds stall_time{1000};       ///< A scan silent for so long; 100 ms to 1 min.
  /// Fewer wake-ups for more latency: bytes are read no more often than this. 0 to 100 ms.
  std::chrono::milliseconds batch{0};
  /// The least delay between measurement and arrival beside the line's own; see sensor_clock.
  std::chrono::nanoseconds transport_delay{0};
  bool partial_scans = false;  ///< Whether next_scan() gives pieces of revolutions, too.
};

/// What is wrong with `options`, as an error that names it; nothing where all is well. *Pure.*
[[nodiscard]] G4LIDAR_API std::optional<error> problem_with(const lidar_options& options) noexcept;

/// The lines to the device that `options` name, for who puts something between them and the driver; see
/// recorded(). lidar::open(options) is open(connector_for(options), options). Fails with bad_option,
/// bad_file or system.
[[nodiscard]] G4LIDAR_API result<std::unique_ptr<connector>> connector_for(
    const lidar_options& options);

/// Something that happened by itself.
struct lidar_event {
  /// What it can be; docs/errors.md says what to do about each.
  enum class kind : std::uint8_t {
    lost,                 ///< The stream broke off; `reason` says why.
    reconnected,          ///< The same device is there again, set and started as before.
    found_scanning,       ///< It scanned although nobody had asked; it was stopped.
    protection_starved,   ///< The caller looked too late to feed the protection; started again.
    protection_found_on,  ///< The protection was on unexpectedly: the same, and it is fed.
    restarted,            ///< The scan had ended by itself; the device is set and started again.
    health_warning,       ///< The device warns of its health when it is started.
    overflow,             ///< Events before this one were lost: nobody asked for them.
  };
  kind what;
  problem reason;        ///< Of a loss; else problem::timeout, and without a meaning.
  std::int64_t time_ns;  ///< When, by the monotonic clock.
};

/// The words of the tools and documents; they live for ever.
[[nodiscard]] G4LIDAR_API std::string_view name_of(lidar_event::kind what) noexcept;

/// Counts since open(), over all reconnects. At every moment bytes == stream.frame_bytes +
/// stream.skipped_bytes() + held.
struct lidar_counts {
  std::uint64_t bytes = 0;          ///< Taken in by the parser.
  std::uint64_t held = 0;           ///< Of an unfinished frame.
  stream_counts stream;             ///< Packets, points, skipped bytes by reason, ...
  std::uint64_t samples_lost = 0;   ///< That were measured and never came, by the angles.
  std::uint64_t scans = 0;          ///< Whole revolutions.
  std::uint64_t partial_scans = 0;  ///< Pieces of revolutions.
  std::uint64_t scans_missed = 0;   ///< Not taken by next_scan() before the next one was complete.
  std::uint64_t points_missed = 0;  ///< Not taken by next_points() before they were overwritten.
  std::uint64_t command_retries = 0;  ///< Commands that had to be sent again.
  std::uint64_t reconnects = 0;       ///< Times the device came back.
  std::int64_t largest_gap_ns = 0;    ///< Between two packets of one scan.
};

/// The points of the last two seconds and more.
using lidar_ring = point_ring<16384>;

/// One G4. *Single thread* but for wake() and the readers of points(). *Allocates on open*, and again
/// only when it reconnects. It has no thread of its own: time passes for it in its calls.
///
///     auto lidar = g4lidar::lidar::open();
///     if (!lidar) return report(lidar.error());
///     if (auto started = lidar->start(); !started) return report(started.error());
///     while (running) {
///       auto scan = lidar->next_scan(500ms);
///       if (scan) use(*scan);
///       else if (scan.error().is_fatal()) return report(scan.error());
///     }
///
/// The motor is stopped by stop(), close() and destruction, unless release() came first. Signals are the application's.
class G4LIDAR_API lidar {
 public:
  /// In which times are given to it.
  using milliseconds = std::chrono::milliseconds;

  /// Opens the device and learns who it is. A device that is found scanning is stopped first. About
  /// 60 ms on a healthy device. Errors: all of docs/errors.md but those of a running scan.
  [[nodiscard]] static result<lidar> open(const lidar_options& options = {});
  /// The same by name, see lidar_options::device.
  [[nodiscard]] static result<lidar> open(std::string_view device);
  /// On lines of another kind: a simulation, a test.
  [[nodiscard]] static result<lidar> open(std::unique_ptr<connector> line,
                                          const lidar_options& options = {});

  lidar(lidar&&) noexcept;
  lidar& operator=(lidar&&) noexcept;
  /// Stops the motor, as close() does.
  ~lidar();

  /// Asks for its health, sets what the options say, and starts the scan. Ends when the device has
  /// confirmed. Errors: unhealthy, not_reached, timeout, ...
  result<void> start();
  /// Stops the scan, and ends when the line is silent.
  result<void> stop();
  /// Stops, and gives the line free. Anything after that fails with gone.
  result<void> close();
  /// As close(), but the device is left as it is: what scans goes on, and nobody reads it. (Under
  /// power-down protection it stops by itself, 3 s after it was last fed.)
  void release() noexcept;

  /// The next revolution, good until the next call of anything here but counts(). Errors: timeout
  /// (go on), not_scanning; those that are fatal end the scan, unless reconnecting is on: then they
  /// are told by next_event(), and this goes on when the device is back.
  [[nodiscard]] result<scan> next_scan(milliseconds timeout);
  /// All points since the last call, one at least; good until the next call. Errors as next_scan().
  [[nodiscard]] result<std::span<const point>> next_points(milliseconds timeout);

  /// Every point, for readers in any thread; good as long as this lidar, however it is moved.
  [[nodiscard]] lidar_ring& points() noexcept;

  /// For an event loop: poll native_handle() for reading until next_deadline_ns(), then call
  /// process(), which never waits, or next_scan(0ms) until it times out. The handle stays the same over
  /// reconnects; -1 where the line has none.
  [[nodiscard]] int native_handle() const noexcept;
  /// Of std::chrono::steady_clock; never_ns where nothing is awaited but bytes.
  [[nodiscard]] std::int64_t next_deadline_ns() const noexcept;
  /// Takes in what is there. Scans that are not taken by next_scan() are counted as missed.
  result<void> process();

  /// Makes a call that waits, or the next one, end early with cancelled, once. What it had begun goes
  /// on in the calls that follow, and the same call made again goes on with it: start(), stop() and
  /// ask() come to their end however often they are woken. *Any thread*, and a signal handler, as long
  /// as the lidar lives and is not being moved.
  void wake() noexcept;

  /// Asks the device. While it scans this is refused with problem::scanning, unless the second
  /// argument allows to stop, ask, and start again. What is set so is set again like an option, at
  /// each start and after a reconnect. Errors: scanning, timeout, wrong_answer, not_reached, silence,
  /// garbage, gone, ...
  [[nodiscard]] result<answer> ask(const request& wanted,
                                   while_scanning how = while_scanning::refuse);
  /// The same in the type of the answer: ask_for<device_information>(requests::device_info()).
  template <class Answer>
  [[nodiscard]] result<Answer> ask_for(const request& wanted,
                                       while_scanning how = while_scanning::refuse) {
    return ask(wanted, how).and_then([](const answer& given) -> result<Answer> {
      if (const auto* value = std::get_if<Answer>(&given)) return *value;
      return failure(task::asking, problem::wrong_answer);
    });
  }

  /// Who it is, as it said when it was opened; good as long as this lidar.
  [[nodiscard]] const device_information& information() const noexcept;
  /// The line it is on now: "/dev/ttyUSB0". Good until the next call of anything but counts().
  [[nodiscard]] std::string_view name() const noexcept;
  /// Whether it was started and not stopped; while it is lost: no.
  [[nodiscard]] bool is_scanning() const noexcept;
  /// All counts as they are now.
  [[nodiscard]] lidar_counts counts() const noexcept;
  /// What happened by itself since the last call, the oldest first; nothing where nothing did.
  [[nodiscard]] std::optional<lidar_event> next_event() noexcept;

 private:
  class driver;
  explicit lidar(std::unique_ptr<driver> made) noexcept;
  std::unique_ptr<driver> driver_;
};

}  // namespace g4lidar
