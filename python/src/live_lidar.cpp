// SPDX-License-Identifier: MIT
#include "live_lidar.hpp"

#include <algorithm>

#include "g4lidar/core/wall_clock.hpp"
#include "g4lidar/transport/transport.hpp"
#include "gil.hpp"
#include "reading_thread.hpp"

namespace g4lidar::python {
namespace {

/// The longest wait of a loop in one call, after which other threads may use the lidar.
constexpr live_lidar::milliseconds slice{500};
constexpr live_lidar::milliseconds a_year{std::chrono::hours(24 * 365)};

/// All that exist. Guarded by the GIL. Never destroyed: a lidar may be, after everything else.
std::vector<live_lidar*>& all_lidars() {
  static auto* const all = new std::vector<live_lidar*>;
  return *all;
}

/// Whether the program ends, so that threads may never release what they hold. Guarded by the GIL.
bool program_ends = false;

bool is_error(const nb::python_error& raised, const char* name) {
  return in_python(
      [&] { return raised.matches(nb::module_::import_("g4lidar.errors").attr(name)); });
}

}  // namespace

live_lidar::milliseconds in_milliseconds(double seconds) {
  if (!(seconds >= 0.0)) raise_impossible("a timeout is a number of seconds, 0 or more", seconds);
  return live_lidar::milliseconds(
      static_cast<std::int64_t>(std::min(seconds * 1e3, static_cast<double>(a_year.count()))));
}

live_lidar::live_lidar(lidar&& opened, foundation base)
    : on_(std::move(base)),
      lidar_(std::make_unique<lidar>(std::move(opened))),
      has_player_(lidar_->player() != nullptr) {
  if (!on_.mutex) on_.mutex = std::make_shared<std::timed_mutex>();
  all_lidars().push_back(this);
}

live_lidar::~live_lidar() {
  std::erase(all_lidars(), this);
  if (process_.is_this_one()) {
    lock held(*on_.mutex, std::defer_lock);
    const without_gil free;
    if (!program_ends) held.lock();
    if (held || held.try_lock()) {
      static_cast<void>(lidar_->close());
      return;
    }
  }
  // The device, its port and its locks belong to the parent, or to a thread that has not ended: nothing is stopped or
  // restored.
  static_cast<void>(lidar_.release());
  new foundation(std::move(on_));
}

live_lidar::lock live_lidar::locked(bool wakes) {
  process_.check("this lidar");
  return lock_of(*on_.mutex, [&] {
    if (wakes) lidar_->wake();
  });
}

void live_lidar::start() {
  may_stop_ = !on_.is_virtual;
  run([](lidar& on) { return on.start(); });
}

void live_lidar::stop() {
  run([](lidar& on) { return on.stop(); });
  may_stop_ = false;
}

void live_lidar::wake() {
  process_.check("this lidar");
  woken_ = true;
  lidar_->wake();
  notice_.give();
}

void live_lidar::close() {
  if (closed_.exchange(true)) return;
  notice_.give();
  result<void> stopped;
  result<void> written;
  try {
    do {
      const interruption signals(*lidar_);
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      auto held = locked(true);
      const auto stop = [may = may_stop_](lidar& to) { return may ? to.stop() : result<void>(); };
      stopped = alone(std::move(held), stop);
    } while (!stopped && stopped.error() == problem::cancelled);
    written = alone(locked(true), [&](lidar& on) {
      if (stopped) stopped = on.close();
      on.release();
      return on_.recording ? on_.recording->close() : result<void>();
    });
  } catch (const nb::python_error&) {
    closed_ = false;  // close_all() stops it
    throw;
  }
  check(written);
  if (!stopped && stopped.error() != problem::gone) raise(stopped.error());
}

void live_lidar::release() {
  const lock held = locked();
  closed_ = true;
  lidar_->release();
  notice_.give();
}

reading_thread* live_lidar::hand_over(bool newest) {
  if (on_.is_virtual) raise_bad_option("background: this Simulator has virtual time");
  if (on_.recording) raise_bad_option("background: this lidar is recorded");
  if (!look([](lidar& on) { return on.is_scanning(); })) start();
  // With the GIL, so that no other thread wakes what is moved.
  const lock held = locked(true);
  const without_signals masked;
  std::optional<std::int64_t> ahead_ns;
  if (player* const of = lidar_->player()) ahead_ns = of->wall_ns(0);
  auto started = background_reader::start(std::move(*lidar_), {.newest_only = newest});
  may_stop_ = false;
  closed_ = true;
  notice_.give();
  return new reading_thread(value_of(std::move(started)), on_, ahead_ns);
}

bool live_lidar::counts_time(lidar& on) const {
  const player* const of = on.player();
  return on_.is_virtual || (of != nullptr && of->speed() == 0);
}

template <class Wait>
nb::object live_lidar::take_scan(const Wait& wait) {
  const auto copy = [&](lidar& on) -> result<std::optional<copied_scan>> {
    const result<std::optional<scan>> found = wait(on);
    if (!found) return tl::unexpected(found.error());
    if (!*found) return std::nullopt;
    const scan& next = **found;
    if (on_.recording && !next.is_piece()) {
      on_.recording->scan(next);
      if (const auto why = on_.recording->take_error()) return tl::unexpected(*why);
    }
    player* const of = on.player();
    const std::int64_t ahead_ns = of != nullptr    ? of->wall_ns(next.time_ns()) - next.time_ns()
                                  : on_.is_virtual ? 0
                                                   : wall_clock().ahead().count();
    return copied_scan(next, ahead_ns);
  };
  return run(copy, [](std::optional<copied_scan>& found) {
    return found ? found->kept() : nb::object(nb::none());
  });
}

nb::object live_lidar::try_scan(milliseconds timeout, bool may_time_out) {
  const auto due = std::chrono::steady_clock::now() + timeout;
  return take_scan([&](lidar& on) -> result<std::optional<scan>> {
    // Less after a signal, but for clocks other than that of the caller.
    const auto left = counts_time(on)
                          ? timeout
                          : std::chrono::ceil<milliseconds>(due - std::chrono::steady_clock::now());
    const auto found = on.try_scan(std::max(left, milliseconds(0)));
    if (found) return *found;
    if (may_time_out && found.error() == problem::timeout) return std::nullopt;
    return tl::unexpected(found.error());
  });
}

/// The newest scan that has arrived; at least `found`. What is raised during that is raised by the next call.
nb::object live_lidar::newer(nb::object found) {
  try {
    while (!look([](lidar& on) { return on.player() != nullptr && on.player()->speed() == 0; })) {
      nb::object next = try_scan(milliseconds(0), true);
      if (next.is_none()) break;
      found = std::move(next);
      ++dropped_;
    }
  } catch (nb::python_error& raised) {
    if (!is_error(raised, "Error")) throw;
    if (is_error(raised, "Cancelled")) wake();
  }
  return found;
}

nb::object live_lidar::poll_scan(bool newest) {
  try {
    nb::object found = try_scan(milliseconds(0), true);
    return newest && !found.is_none() ? newer(std::move(found)) : found;
  } catch (nb::python_error& raised) {
    if (!is_error(raised, "Reconnecting")) throw;
    return nb::none();
  }
}

nb::object live_lidar::next_deadline() {
  const std::int64_t due_ns = look([](lidar& on) { return on.event_loop().next_deadline_ns(); });
  if (due_ns == never_ns) return nb::none();
  return nb::float_(on_.is_virtual ? 0.0 : static_cast<double>(due_ns) * 1e-9);
}

nb::object live_lidar::advance(scan_loop& loop, milliseconds slice, bool newest) {
  try {
    if (!closed_) {
      notice_.take();
      nb::object found = take_scan([&](lidar& on) { return loop.wait(on, slice); });
      return newest && !found.is_none() ? newer(std::move(found)) : found;
    }
  } catch (nb::python_error& raised) {
    const bool has_ended = is_error(raised, "EndOfInput");
    const bool was_closed = closed_ && (is_error(raised, "Cancelled") || is_error(raised, "Gone"));
    if (!has_ended && !was_closed) throw;
  }
  throw nb::stop_iteration();
}

nb::object live_lidar::next_in_loop(scan_loop loop, bool newest) {
  while (true) {
    nb::object found = advance(loop, slice, newest);
    if (!found.is_none()) return found;
  }
}

/// The references keep the lidars, although other code runs at the same time.
void live_lidar::close_all() {
  program_ends = true;
  std::vector<nb::object> all;
  for (live_lidar* const each : all_lidars()) {
    if (nb::object found = nb::find(each); found.is_valid()) all.push_back(std::move(found));
  }
  for (const nb::object& each : all) {
    auto& closed = nb::cast<live_lidar&>(each);
    if (!closed.process_.is_this_one()) continue;
    try {
      closed.close();
    } catch (nb::python_error& raised) {
      raised.discard_as_unraisable("g4lidar at the end of the program");
    }
  }
}

}  // namespace g4lidar::python
