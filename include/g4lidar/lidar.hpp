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
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/core/point_ring.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/lidar_event.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/recording/player.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/settings.hpp"
#include "g4lidar/transport/recognition.hpp"

namespace g4lidar {

class scan_loop;
class scan_range;
class lidar_event_loop;

/// The points of at least the last 1.8 seconds.
using lidar_ring = point_ring<std::dynamic_extent>;

/// One lidar, or a file of one. *Single thread* except wake() and the readers of points(). *Allocates on open* and when
/// it reconnects. It starts no thread: it makes progress only within its calls. A moved-from lidar
/// behaves like a closed one.
///
///     auto lidar = g4lidar::lidar::open("/dev/ttyUSB0", {.reconnect = true});
///     if (!lidar) return report(lidar.error());
///     if (auto started = lidar->start(); !started) return report(started.error());
///     auto scans = lidar->scans(500ms);
///     for (const auto& scan : scans) use(scan);
///     return report(*scans.why_ended());
///
/// stop(), close() and the destructor stop the motor, unless release() was called before. The
/// library installs no signal handlers.
class G4LIDAR_API lidar {
 public:
  /// The unit of timeouts. A value below zero counts as zero; the longest is a year.
  using milliseconds = std::chrono::milliseconds;

  /// Opens the source that `options.device` names (transport/source.hpp) and queries the identity of the lidar. A
  /// device that is scanning is stopped first. For at most options.device_wait it waits, and begins again, until
  /// a lidar answers or options.is_cancelled() ends it; the times below are those of an attempt. Takes
  /// about 60 ms with a healthy device, and at most 3 s with one fault; if many bytes are damaged, at
  /// most 15 s. A two-way model that was named and is silent at its only baud rate, at a port, is then searched at the
  /// other rates: 5 s more. If ports are queried first (see select_port()), each of them adds at most 4 s.
  /// Errors: all of docs/errors.md except those of a running scan.
  [[nodiscard]] static result<lidar> open(const lidar_options& options = {});
  /// The same by name, which takes the place of lidar_options::device.
  [[nodiscard]] static result<lidar> open(std::string_view device,
                                          const lidar_options& options = {});
  /// The same through another connector: a simulation, a test.
  [[nodiscard]] static result<lidar> open(std::unique_ptr<connector> connector,
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

  /// The next revolution, if it is complete within the timeout; valid until the next call of any
  /// function except counts(). Returns within the timeout in every state, also while the motor spins
  /// up or a lost lidar is looked for: error::detail() is then spinning_up or searching. So an error
  /// is no reason to end a loop, unless it is fatal: see wait_scan(). Errors: timeout (try again),
  /// not_scanning, reconnecting. A fatal error ends the scan. With reconnecting on, a loss is not
  /// fatal: the waiting call returns reconnecting at once, next_event() reports the loss, and scans
  /// continue when the device is back.
  [[nodiscard]] view_result<scan> try_scan(milliseconds timeout);
  /// The next revolution, for a loop: it waits longer while no scan is due. While the motor spins up after a
  /// start, a restart or a reconnect, it waits until the first scan, at most 10 s or the timeout, if
  /// that is longer. With reconnecting on it waits without limit while the lidar is lost. So it
  /// returns an error only at the end of a file (end_of_input), at a fatal error, when it is woken
  /// (cancelled), when the lidar is not scanning, and when a scan that is due does not come within
  /// the timeout. A recording counts as it was recorded: what is due in it is due; while it is paused,
  /// nothing is.
  [[nodiscard]] view_result<scan> wait_scan(milliseconds timeout);
  /// The same as a range: `for (const auto& scan : lidar.scans(500ms))`; see scan_range.
  [[nodiscard]] scan_range scans(milliseconds timeout) & noexcept;
  /// All points since the last call, at least one; valid until the next call. The first call begins
  /// with the current revolution; earlier points count as missed. Errors: as try_scan().
  [[nodiscard]] view_result<std::span<const point>> next_points(milliseconds timeout);

  /// Every point, for readers in any thread. The ring is written from the first call on, so it costs
  /// a program that takes only scans nothing. *Any thread.* Valid as long as this lidar, also after
  /// a move.
  [[nodiscard]] const lidar_ring& points() const noexcept;

  /// What an event loop of the program needs. Valid as long as this lidar, until it is moved.
  [[nodiscard]] lidar_event_loop event_loop() & noexcept;

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
                                   while_scanning if_scanning = while_scanning::refuse) {
    const auto given = ask(static_cast<const request&>(wanted), if_scanning);
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
                                   while_scanning if_scanning = while_scanning::refuse);
  /// Sets one setting: `lidar.set(scan_frequency::hz(10))` returns the value that the device
  /// reports afterwards. The same as ask(requests::set(wanted)), and blocks at most as long.
  template <class Setting>
    requires requires(Setting wanted) { requests::set(wanted); }
  [[nodiscard]] result<Setting> set(Setting wanted,
                                    while_scanning if_scanning = while_scanning::refuse) {
    return ask(requests::set(wanted), if_scanning);
  }

  /// What the device reported about itself when it was opened; what a one-way lidar has sent so far, which
  /// may be nothing: device_information::is_known(). See recognition(), too. Valid as long as this lidar.
  [[nodiscard]] const device_information& information() const noexcept;
  /// As which model it is read, from what that is known, and what contradicts it. If it is not yours, name yours with
  /// lidar_options::model. One candidate alone if it was named, stated by a file or `sim:`, or if the device answers.
  /// Valid as long as this lidar. *Never waits.*
  [[nodiscard]] g4lidar::recognition recognition() const noexcept;
  /// What its turning part has reported, if that differs: some two-way lidars send it when they
  /// start.
  [[nodiscard]] std::optional<device_information> module_information() const noexcept;
  /// The player of a recording, or of raw bytes in a file; null for everything else, and after close().
  /// Valid as long as this lidar is open.
  [[nodiscard]] g4lidar::player* player() noexcept;
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
  friend class lidar_event_loop;
  friend class scan_loop;
  class driver;
  explicit lidar(std::unique_ptr<driver> made) noexcept;
  std::unique_ptr<driver> driver_;
};

/// A lidar in an event loop of the program, which waits for other things, too: poll native_handle()
/// for reading until next_deadline(), then call process(), which never waits, or try_scan(0ms) until
/// it times out. *Single thread*: that of the lidar.
class G4LIDAR_API lidar_event_loop {
 public:
  /// It does not change at a reconnect; it is -1 if the transport has none.
  [[nodiscard]] int native_handle() const noexcept;
  /// The latest time for the next call; time_point::max() if only bytes are awaited.
  [[nodiscard]] std::chrono::steady_clock::time_point next_deadline() const noexcept;
  /// The same in nanoseconds of std::chrono::steady_clock; never_ns of transport/transport.hpp for never.
  [[nodiscard]] std::int64_t next_deadline_ns() const noexcept;
  /// Processes what has arrived. Scans that try_scan() does not take are counted as missed.
  [[nodiscard]] result<void> process();
  /// For a loop that waits like wait_scan(): for how long from now no scan is due. 0: one is due, and
  /// a wait ends at its timeout; milliseconds::max() while a lost lidar is looked for.
  [[nodiscard]] lidar::milliseconds scan_due_in() const noexcept;

 private:
  friend class lidar;
  explicit lidar_event_loop(lidar& of) noexcept : of_(&of) {}

  lidar* of_;
};

/// The scans of a lidar as an input range. It ends at the first error of lidar::wait_scan(), whose
/// rule it follows: not while the motor spins up, and not at an unplug if reconnecting is on.
/// why_ended() returns that error. *Single thread*; valid as long as the lidar.
///
///     auto scans = lidar->scans(500ms);
///     for (const g4lidar::scan& scan : scans) use(scan);  // each valid until the next one
///     return report(*scans.why_ended());
class scan_range {
 public:
  /// One position in the range: the last scan of lidar::wait_scan().
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
  scan_range(lidar& source, lidar::milliseconds timeout) noexcept
      : from_(&source), timeout_(timeout) {}
  void advance() { current_ = from_->wait_scan(timeout_); }

  lidar* from_;
  lidar::milliseconds timeout_;
  view_result<scan> current_{scan{}};
};

inline scan_range lidar::scans(milliseconds timeout) & noexcept { return {*this, timeout}; }

/// A loop over scans that waits in slices, because it also does other things: the rule of lidar::wait_scan(), which is
/// one such wait. *Single thread*: that of the lidar.
class G4LIDAR_API scan_loop {
 public:
  /// `timeout`: for each scan, as soon as it is due.
  explicit scan_loop(lidar::milliseconds timeout) noexcept : timeout_(timeout) {}

  /// Waits at most `slice` for the next scan; valid as that of lidar::wait_scan(). Nothing: none has come, and the loop
  /// goes on. Errors, which end the loop: as lidar::wait_scan(). After cancelled the next call continues the same wait.
  [[nodiscard]] result<std::optional<scan>> wait(lidar& device, lidar::milliseconds slice);
  /// How long from now a wait for the next scan can last; milliseconds::max() without limit.
  [[nodiscard]] lidar::milliseconds left(const lidar& from) const noexcept;

 private:
  lidar::milliseconds timeout_;
  std::optional<std::int64_t> deadline_ns_;  // of the next scan, by the clock of timeouts
};

/// A copy of a scan that owns its points. *Allocates* when it is constructed and copied, and throws
/// only what std::vector throws.
class owned_scan {
 public:
  /// Without points.
  owned_scan() = default;
  /// A copy of `source` and its points.
  explicit owned_scan(const scan& source) { *this = source; }
  /// The same; memory that is large enough is reused.
  owned_scan& operator=(const scan& source) {
    points_.assign(source.begin(), source.end());
    about_ = source;
    about_.points = {};
    return *this;
  }

  /// As a scan; valid until this object changes or is destroyed.
  [[nodiscard]] scan view() const& noexcept {
    scan made = about_;
    made.points = points_;
    return made;
  }
  scan view() const&& = delete;
  /// The same.
  [[nodiscard]] operator scan() const& noexcept { return view(); }
  operator scan() const&& = delete;

  /// The points, in the order in which they were measured. They may be changed.
  [[nodiscard]] std::vector<point>& points() & noexcept { return points_; }
  /// The same.
  [[nodiscard]] const std::vector<point>& points() const& noexcept { return points_; }
  /// The points of a temporary object.
  [[nodiscard]] std::vector<point> points() && noexcept { return std::move(points_); }

 private:
  std::vector<point> points_;
  scan about_;
};

}  // namespace g4lidar
