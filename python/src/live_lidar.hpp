// SPDX-License-Identifier: MIT
// A lidar as Python uses it: from several threads, with signals, and after fork().
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "errors.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/recording/writer.hpp"
#include "interruption.hpp"
#include "kept_scan.hpp"
#include "process.hpp"
#include "readable_notice.hpp"

namespace g4lidar::python {

class reading_thread;

/// What a lidar stands on; everything may be absent.
struct foundation {
  std::shared_ptr<void> simulation;             ///< Outlives the lidar.
  std::shared_ptr<recording_writer> recording;  ///< To which the lidar is recorded; outlives it.
  std::shared_ptr<std::timed_mutex> mutex;      ///< Shared by all users of a virtual clock.
  bool is_virtual = false;                      ///< A simulation in virtual time.
};

/// A scan, whose points are not those of the lidar.
struct copied_scan {
  copied_scan(const scan& scan, std::int64_t ahead_ns)
      : about(scan), points(scan.points.begin(), scan.points.end()), wall_ahead_ns(ahead_ns) {}
  /// The object of Python. Needs the GIL.
  [[nodiscard]] nb::object kept() {
    about.points = points;
    return nb::cast(kept_scan(about, wall_ahead_ns));
  }

  scan about;
  std::vector<point> points;
  std::int64_t wall_ahead_ns;
};

/// The lidar of Python's class Lidar. Calls of several threads wait for each other, without the GIL. No code in Python
/// runs while the mutex is held: handlers of signals and finalizers may use the same lidar. In a process made by fork()
/// every call fails with RuntimeError, and the destructor leaves the lidar as it is: it belongs to the parent.
class live_lidar {
 public:
  using milliseconds = lidar::milliseconds;

  live_lidar(lidar&& opened, foundation base);
  live_lidar(const live_lidar&) = delete;
  live_lidar& operator=(const live_lidar&) = delete;
  ~live_lidar();

  /// `then(value)` with the value of `call(lidar)`, which may wait: without the GIL, and ended by a signal whose handler
  /// raises. Raises the error of the call. What the value refers to must be a copy: other threads may use the lidar.
  template <class Call, class Then>
  auto run(const Call& call, const Then& then);
  /// The same, if there is nothing to convert.
  template <class Call>
  auto run(const Call& call) {
    return run(call, [](auto&&... value) { return (value, ...); });
  }
  /// `call(lidar)`, which never waits.
  template <class Call>
  auto look(const Call& call) {
    const lock held = locked();
    return call(*lidar_);
  }
  /// The value of `call(player)` with the player of a file; raises its error, BadOption for another lidar, and Gone after
  /// close(). Calls of other threads that wait begin to wait again.
  template <class Call>
  auto with_player(const Call& call);
  /// Whether there is one.
  [[nodiscard]] bool has_player() const noexcept { return has_player_ && !closed_; }

  void start();
  void stop();
  /// Ended by a signal whose handler raises; then the lidar is still open.
  void close();
  void release();
  /// Wakes a waiting call of another thread.
  void wake();
  /// The next scan; empty at the timeout, if `may_time_out`.
  [[nodiscard]] nb::object try_scan(milliseconds timeout, bool may_time_out = false);
  /// For a loop: a scan, or None if none came within `slice`, and the loop goes on. Raises StopIteration at the end of a
  /// recording, and after close(). With `newest` only the newest complete scan.
  [[nodiscard]] nb::object advance(scan_loop& loop, milliseconds slice, bool newest);
  /// The same until there is a scan, with a loop that has not begun.
  [[nodiscard]] nb::object next_in_loop(scan_loop loop, bool newest);
  /// Readable when a loop that waits for the lidar must call advance().
  [[nodiscard]] int notice_fileno() const noexcept { return notice_.fileno(); }

  /// What has arrived, without waiting: a scan, or None.
  [[nodiscard]] nb::object poll_scan(bool newest);
  /// The latest time for the next call, in seconds of time.monotonic(); None if only bytes are awaited.
  [[nodiscard]] nb::object next_deadline();

  /// Gives the lidar to a thread of the library, and is closed then: see BackgroundReader.
  [[nodiscard]] reading_thread* hand_over(bool newest);
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }
  [[nodiscard]] bool is_closed() const noexcept { return closed_; }
  /// Closes every lidar of this process: at the end of the program.
  static void close_all();

 private:
  using lock = std::unique_lock<std::timed_mutex>;

  /// Waits without the GIL. `wakes`: calls that wait are woken.
  [[nodiscard]] lock locked(bool wakes = false);
  /// The scan of `wait(lidar)`, or None.
  template <class Wait>
  [[nodiscard]] nb::object take_scan(const Wait& wait);
  /// `call(lidar)` with the mutex and without the GIL.
  template <class Call>
  auto alone(lock held, const Call& call);
  /// Whether timeouts are in a time that passes by reading alone.
  [[nodiscard]] bool counts_time(lidar& on) const;
  [[nodiscard]] nb::object newer(nb::object found);

  foundation on_;
  std::unique_ptr<lidar> lidar_;
  bool has_player_;
  process process_;
  readable_notice notice_;
  std::atomic<bool> woken_{false};  // by wake(), not by a signal
  std::atomic<bool> closed_{false};
  bool may_stop_ = false;  // started, and neither stopped nor lost
  std::uint64_t dropped_ = 0;
};

template <class Call>
auto live_lidar::alone(lock held, const Call& call) {
  const without_gil free;
  auto given = call(*lidar_);
  held.unlock();  // nobody waits for the GIL with the mutex
  return given;
}

template <class Call, class Then>
auto live_lidar::run(const Call& call, const Then& then) {
  while (true) {
    const interruption signals(*lidar_);
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    auto given = alone(locked(), call);
    if (given) {
      if constexpr (std::is_void_v<typename decltype(given)::value_type>) {
        return;
      } else {
        return then(*given);
      }
    }
    // After the handler of a signal that does not raise, and after a call of the player, the call goes on.
    const bool goes_on = given.error() == problem::cancelled && !woken_.exchange(false) && !closed_;
    if (goes_on) continue;
    if (given.error().is_fatal()) may_stop_ = false;
    raise(given.error());
  }
}

template <class Call>
auto live_lidar::with_player(const Call& call) {
  process_.check("this lidar");
  if (closed_) raise(error(task::reading, problem::gone, "this lidar, which was closed"));
  auto given = [&]() -> std::invoke_result_t<Call, player&> {
    const lock held = locked(true);
    if (player* const of = lidar_->player()) return call(*of);
    return failure(task::configuring, problem::bad_option,
                   "player: only recordings and raw bytes have one");
  }();
  notice_.give();
  if (!given) raise(given.error());
  if constexpr (!std::is_void_v<typename decltype(given)::value_type>) return *given;
}

/// A timeout in seconds.
[[nodiscard]] live_lidar::milliseconds in_milliseconds(double seconds);

/// As Lidar.counts(), but 'scans_dropped'.
[[nodiscard]] nb::dict dict_of(const lidar_counts& from);

void bind_lidar(nb::module_& module);
void bind_opening(nb::module_& module);
void bind_player(nb::module_& module, nb::class_<live_lidar>& bound);

}  // namespace g4lidar::python
