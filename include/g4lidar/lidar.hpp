// SPDX-License-Identifier: MIT
// A lidar: opened, queried, started, read, and reconnected after an unplug.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "g4lidar/core/point_ring.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/core/stream_counts.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/device_information.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

class connector;
class scan_range;

/// When a running scan is read, and the program woken.
enum class read_pace : std::uint8_t {
  automatic,    ///< As `revolutions`, until next_points() or points() is called; then as `packets`.
  packets,      ///< When a packet is complete: points arrive with little latency.
  revolutions,  ///< When a revolution is complete: a fifth of the system calls. Scans are not later.
};

/// How a lidar is opened and used. Every option has a default. A setting that is not given stays as the
/// device has it; one that is given is set at each start, after a reconnect, and when the device seems
/// to have rebooted.
struct lidar_options {
  /// Which lidar: empty for the only G4; a path; `serial:2021101000070073` (the number of the lidar);
  /// `usb:1-1.4` (a USB port); `tcp:host:port` (a raw bridge); `file:PATH` (a recording, or the bytes
  /// of a port). A recording can be named by its path alone.
  std::string device;
  /// Bits per second, of a serial port and of the one behind `tcp:`.
  std::uint32_t baud = 230400;

  std::optional<ranging_frequency> ranging;         ///< Measurements per second.
  std::optional<scan_frequency> frequency;          ///< Revolutions per second, 5 to 12 Hz.
  std::optional<motor_direction> direction;         ///< In which direction the head turns.
  std::optional<constant_frequency> constant;       ///< Whether the lidar regulates its frequency.
  std::optional<low_power> idle;                    ///< Whether the motor stops when idle.
  std::optional<power_down_protection> protection;  ///< Stops when the host sends nothing for 3 s.

  bool reconnect = false;  ///< Whether to reconnect after a loss; see lidar::next_event().
  std::chrono::milliseconds longest_backoff{1000};  ///< Between two attempts; 1 ms to 1 s.
  std::chrono::milliseconds answer_time{300};  ///< The longest wait for an answer; 10 ms to 10 s.
  std::chrono::milliseconds stall_time{1000};  ///< A scan without a packet; 100 ms to 1 min.
  /// See read_pace. A transport that does not know how many bytes the system keeps is read by packets.
  read_pace pace = read_pace::automatic;
  /// Bytes are read no more often than this, for every `pace`: fewer wake-ups, more latency. 0 to
  /// 100 ms.
  std::chrono::milliseconds batch{0};
  /// The least delay between measurement and arrival, that of the baud rate excluded; see sensor_clock.
  std::chrono::nanoseconds transport_delay{0};
  bool partial_scans = false;  ///< Whether next_scan() also gives pieces: scan::is_piece().
};

/// What is wrong with `options`, as an error that names the option; nothing if all can be used. *Pure.*
[[nodiscard]] G4LIDAR_API std::optional<error> problem_with(const lidar_options& options) noexcept;

/// The connector for the device that `options` name, for callers that wrap it; see recorded() and
/// transport/connector.hpp. lidar::open(options) is open(connector_for(options), options). Errors:
/// bad_option, bad_file, system.
[[nodiscard]] G4LIDAR_API result<std::unique_ptr<connector>> connector_for(
    const lidar_options& options);

/// Something that happened without a request of the caller.
struct lidar_event {
  /// The kinds of event; docs/errors.md describes what to do about each.
  enum class kind : std::uint8_t {
    lost,            ///< The connection was lost; `reason` has the cause.
    reconnected,     ///< The same device is back, with the same settings and state as before.
    found_scanning,  ///< It was scanning although it had not been started; it was stopped.
    protection_starved,  ///< The keep-alive was sent too late and the protection stopped the scan; started again.
    protection_found_on,  ///< The protection was on unexpectedly: started again, and kept alive.
    spinning_up,          ///< Started, and no point has come yet: the motor spins up.
    restarted,            ///< The scan had ended by itself; the device is set and started again.
    health_warning,       ///< The device reports a warning when it is started.
    other_lidar,  ///< While the lidar was lost, another one answered; it received no further commands.
    long_pause,  ///< The next data of a recording follows in more than a minute.
    overflow,    ///< Earlier events were dropped, because next_event() was not called.
  };
  kind what;
  problem reason;        ///< Of `lost`; else problem::timeout, without a meaning.
  std::int64_t time_ns;  ///< When, by the monotonic clock.
};

/// The name of the event in tools and documents. Valid forever.
[[nodiscard]] G4LIDAR_API std::string_view name_of(lidar_event::kind what) noexcept;

/// Counts since open(), over all reconnects. At every moment bytes == stream.parsed_bytes +
/// stream.skipped_bytes() + held.
struct lidar_counts {
  std::uint64_t bytes = 0;          ///< Parsed.
  std::uint64_t held = 0;           ///< Of an unfinished packet or response.
  stream_counts stream;             ///< Packets, points, skipped bytes by reason, ...
  std::uint64_t samples_lost = 0;   ///< Measured and never received, derived from the angles.
  std::uint64_t scans = 0;          ///< Revolutions that were completed.
  std::uint64_t partial_scans = 0;  ///< Pieces of revolutions.
  std::uint64_t scans_missed = 0;   ///< Not taken by next_scan() before the next one was complete.
  std::uint64_t points_missed = 0;  ///< Not returned by next_points(), if the program calls it.
  std::uint64_t command_retries = 0;  ///< Commands that had to be sent again.
  std::uint64_t reconnects = 0;       ///< How often the device was reconnected.
  std::int64_t largest_gap_ns = 0;    ///< Between two packets of one scan.
};

/// The points of at least the last two seconds.
using lidar_ring = point_ring<16384>;

/// One G4. *Single thread* except wake() and the readers of points(). *Allocates on open* and when
/// it reconnects. It starts no thread: it makes progress only within its calls. A moved-from lidar
/// behaves like a closed one.
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
/// stop(), close() and the destructor stop the motor, unless release() was called before. The
/// library installs no signal handlers.
class G4LIDAR_API lidar {
 public:
  /// The unit of timeouts. A value below zero counts as zero; the longest is a year.
  using milliseconds = std::chrono::milliseconds;

  /// Opens the device and queries its identity. A device that is scanning is stopped first. Takes
  /// about 60 ms with a healthy device, and at most 3 s with one fault; if many bytes are damaged, at
  /// most 15 s. If ports are queried first (see select_port()), each of them adds at most 2.5 s.
  /// Errors: all of docs/errors.md except those of a running scan.
  [[nodiscard]] static result<lidar> open(const lidar_options& options = {});
  /// The same by name; see lidar_options::device.
  [[nodiscard]] static result<lidar> open(std::string_view device);
  /// The same through another connector: a simulation, a test.
  [[nodiscard]] static result<lidar> open(std::unique_ptr<connector> from,
                                          const lidar_options& options = {});

  lidar(lidar&&) noexcept;
  lidar& operator=(lidar&&) noexcept;
  /// Like close(): stops the motor, and blocks as long.
  ~lidar();

  /// Queries the health, applies the settings of the options and starts the scan. Returns when the
  /// device has confirmed: after about 20 ms with a healthy device without settings. If an answer or
  /// the scan header is missing, the device may have rebooted, and the settings are applied once more.
  /// Blocks at most 7 s with one fault of the device or the connection (three starts without an
  /// answer), and at most 10 s if all settings are given. If many bytes are damaged: at most 15 s for
  /// each of at most 17 requests (docs/design/simulation.md).
  /// Errors: unhealthy, not_reached, timeout, ...
  [[nodiscard]] result<void> start();
  /// Stops the scan. Returns when the device has stopped sending: after about 50 ms, and after at
  /// most 1.5 s if it does not react; on a connection that damages most bytes after at most 15 s. If
  /// a setup is in progress (after a reconnect, or of a start() that was woken), it is completed
  /// first, which blocks at most as long as start(). While the device is lost it returns at once.
  [[nodiscard]] result<void> stop();
  /// Stops the scan and closes the connection. Every call after it fails with gone. Blocks at most as
  /// long as stop().
  [[nodiscard]] result<void> close();
  /// Like close(), but leaves the device as it is: a running scan continues, unread. (With
  /// power-down protection the device stops 3 s after the last keep-alive.) Never waits.
  void release() noexcept;

  /// The next revolution; valid until the next call of any function except counts(). Errors:
  /// timeout (try again), not_scanning, reconnecting. A fatal error ends the scan. With
  /// reconnecting on, a loss is not fatal: next_event() reports it, and scans continue when the
  /// device is back.
  [[nodiscard]] view_result<scan> next_scan(milliseconds timeout);
  /// The same for a loop: `for (const auto& scan : lidar.scans(500ms))`; see scan_range.
  [[nodiscard]] scan_range scans(milliseconds timeout) & noexcept;
  /// All points since the last call, at least one; valid until the next call. The first call begins
  /// with the current revolution; earlier points count as missed. Errors: as next_scan().
  [[nodiscard]] view_result<std::span<const point>> next_points(milliseconds timeout);

  /// Every point, for readers in any thread. The ring is written from the first call on, so it costs
  /// a program that takes only scans nothing. *Any thread.* Valid as long as this lidar, also after
  /// a move.
  [[nodiscard]] const lidar_ring& points() const noexcept;

  /// For an event loop: poll native_handle() for reading until next_deadline(), then call
  /// process(), which never waits, or next_scan(0ms) until it times out. The handle does not change
  /// at a reconnect; it is -1 if the transport has none.
  [[nodiscard]] int native_handle() const noexcept;
  /// The latest time for the next call; time_point::max() if only bytes are awaited.
  [[nodiscard]] std::chrono::steady_clock::time_point next_deadline() const noexcept;
  /// The same in nanoseconds of std::chrono::steady_clock; never_ns of transport.hpp for never.
  [[nodiscard]] std::int64_t next_deadline_ns() const noexcept;
  /// Processes what has arrived. Scans that next_scan() does not take are counted as missed.
  [[nodiscard]] result<void> process();

  /// Makes a waiting call, or the next one, return early with cancelled, once. The next calls
  /// continue what the woken call had begun, and the same call continues it to its end: start(),
  /// stop() and ask() complete regardless of how often they are woken. *Any thread*, and a signal
  /// handler, as long as the lidar exists and is not being moved.
  void wake() noexcept;

  /// Sends a request: `lidar.ask(requests::health())` returns a result<health>. During a scan it is
  /// refused with problem::scanning, unless the second argument allows to stop, ask, and start
  /// again. A setting that was set in this way is set again like an option, at each start and after
  /// a reconnect. Returns as soon as the device has answered. Blocks at most 15 s (no further command
  /// is sent after 10 s), and 20 s if a scan is resumed; after requests::restart() of a device that
  /// scans, also as long as start(). Errors: scanning, timeout, wrong_answer, not_reached, silence,
  /// garbage, gone, ...
  template <class Answer>
  [[nodiscard]] result<Answer> ask(const request_for<Answer>& wanted,
                                   while_scanning how = while_scanning::refuse) {
    const auto given = ask(static_cast<const request&>(wanted), how);
    if (!given) return tl::unexpected(given.error());
    if constexpr (std::is_void_v<Answer>) {
      return {};
    } else {
      if (const auto* value = std::get_if<Answer>(&*given)) return *value;
      return failure(task::asking, problem::wrong_answer);
    }
  }
  /// The same for a request that is chosen at run time.
  [[nodiscard]] result<answer> ask(const request& wanted,
                                   while_scanning how = while_scanning::refuse);
  /// Sets one setting: `lidar.set(scan_frequency::hz(10))` returns the value that the device
  /// reports afterwards. The same as ask(requests::set(wanted)), and blocks at most as long.
  template <class Setting>
    requires requires(Setting wanted) { requests::set(wanted); }
  [[nodiscard]] result<Setting> set(Setting wanted, while_scanning how = while_scanning::refuse) {
    return ask(requests::set(wanted), how);
  }

  /// What the device reported about itself when it was opened. Valid as long as this lidar.
  [[nodiscard]] const device_information& information() const noexcept;
  /// The name of the transport in use: "/dev/ttyUSB0". Valid until the next call of anything but
  /// counts().
  [[nodiscard]] std::string_view name() const noexcept;
  /// Whether a scan was started and not stopped; false while the device is lost.
  [[nodiscard]] bool is_scanning() const noexcept;
  /// All counts as they are now.
  [[nodiscard]] lidar_counts counts() const noexcept;
  /// The oldest event that was not taken yet; nothing if there is none.
  [[nodiscard]] std::optional<lidar_event> next_event() noexcept;

 private:
  class driver;
  explicit lidar(std::unique_ptr<driver> made) noexcept;
  std::unique_ptr<driver> driver_;
};

/// The scans of a lidar as an input range. It ends at the first error of next_scan(), also at a
/// timeout; why_ended() returns that error. *Single thread*; valid as long as the lidar.
///
///     auto scans = lidar->scans(500ms);
///     for (const g4lidar::scan& scan : scans) use(scan);  // each valid until the next one
///     return report(*scans.why_ended());
class scan_range {
 public:
  /// One position in the range: the last scan of next_scan().
  class iterator {
   public:
    using value_type = scan;                 ///< For std::input_iterator.
    using difference_type = std::ptrdiff_t;  ///< The same.

    /// Made by begin().
    explicit iterator(scan_range& of) noexcept : of_(&of) {}
    /// Valid until the iterator moves on.
    [[nodiscard]] const scan& operator*() const noexcept { return *of_->current_; }
    /// The same.
    [[nodiscard]] const scan* operator->() const noexcept { return of_->current_.operator->(); }
    /// Waits for the next scan.
    iterator& operator++() {
      of_->advance();
      return *this;
    }
    /// The same.
    void operator++(int) { of_->advance(); }
    /// Whether the range has ended.
    [[nodiscard]] bool operator==(std::default_sentinel_t) const noexcept { return !of_->current_; }

   private:
    scan_range* of_;
  };

  /// Waits for the next scan. After the end it begins again.
  [[nodiscard]] iterator begin() {
    advance();
    return iterator(*this);
  }
  /// The end of the range.
  [[nodiscard]] std::default_sentinel_t end() const noexcept { return {}; }

  /// The error that ended the range; nothing as long as the range has not ended. After timeout or
  /// cancelled, a new loop over the same range continues.
  [[nodiscard]] std::optional<error> why_ended() const {
    return current_ ? std::nullopt : std::optional(current_.error());
  }

 private:
  friend class lidar;
  scan_range(lidar& from, lidar::milliseconds timeout) noexcept : from_(&from), timeout_(timeout) {}
  void advance() { current_ = from_->next_scan(timeout_); }

  lidar* from_;
  lidar::milliseconds timeout_;
  view_result<scan> current_{scan{}};
};

inline scan_range lidar::scans(milliseconds timeout) & noexcept { return {*this, timeout}; }

}  // namespace g4lidar
