// SPDX-License-Identifier: MIT
#include "live_lidar.hpp"

#include <algorithm>

#include "g4lidar/transport/transport.hpp"
#include "g4lidar/wall_clock.hpp"

namespace g4lidar::python {
namespace {

/// As long as the device needs at most for its first packet.
constexpr live_lidar::milliseconds longest_spin_up{10'000};
constexpr live_lidar::milliseconds a_year{std::chrono::hours(24 * 365)};

/// All that were made. Guarded by the GIL.
std::vector<live_lidar*>& all_lidars() {
  static std::vector<live_lidar*> all;
  return all;
}

}  // namespace

live_lidar::milliseconds in_milliseconds(double seconds) {
  if (!(seconds >= 0.0)) throw nb::value_error("a timeout is a number of seconds, 0 or more");
  return live_lidar::milliseconds(
      static_cast<std::int64_t>(std::min(seconds * 1e3, static_cast<double>(a_year.count()))));
}

live_lidar::live_lidar(lidar&& opened, foundation on)
    : on_(std::move(on)), lidar_(std::move(opened)) {
  if (!on_.mutex) on_.mutex = std::make_shared<std::timed_mutex>();
  all_lidars().push_back(this);
}

live_lidar::~live_lidar() {
  std::erase(all_lidars(), this);
  if (process_.is_this_one()) {
    const nb::gil_scoped_release free;
    const std::lock_guard lock(*on_.mutex);
    static_cast<void>(lidar_.close());
    return;
  }
  // The device, its port and its locks belong to the parent: nothing is stopped or restored.
  new lidar(std::move(lidar_));
  new foundation(std::move(on_));
}

std::unique_lock<std::timed_mutex> live_lidar::locked(bool closes) {
  process_.check("this lidar");
  std::unique_lock lock(*on_.mutex, std::try_to_lock);
  while (!lock) {
    {
      if (closes) lidar_.wake();
      const nb::gil_scoped_release free;
      static_cast<void>(lock.try_lock_for(std::chrono::milliseconds(50)));
    }
    if (!lock && PyErr_CheckSignals() != 0) throw nb::python_error();
  }
  return lock;
}

void live_lidar::start() {
  may_stop_ = !on_.has_own_clock;
  run([](lidar& on) { return on.start(); });
  spin_up_left_ = longest_spin_up;
}

void live_lidar::stop() {
  run([](lidar& on) { return on.stop(); });
  may_stop_ = false;
}

void live_lidar::wake() {
  process_.check("this lidar");
  woken_ = true;
  lidar_.wake();
}

void live_lidar::close() {
  if (closed_.exchange(true)) return;
  result<void> stopped;
  try {
    do {
      const interruption signals(lidar_);
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      const auto stop = [this](lidar& on) { return may_stop_ ? on.stop() : result<void>(); };
      stopped = alone(stop, true);
    } while (!stopped && stopped.error() == problem::cancelled);
  } catch (const nb::python_error&) {
    closed_ = false;  // close_all() stops it
    throw;
  }
  const auto written = alone(
      [&](lidar& on) {
        if (stopped) stopped = on.close();
        on.release();
        return on_.recording ? on_.recording->close() : result<void>();
      },
      true);
  check(written);
  if (!stopped && stopped.error() != problem::gone) raise(stopped.error());
}

void live_lidar::release() {
  const auto lock = locked();
  closed_ = true;
  lidar_.release();
}

nb::object live_lidar::keep(copied_scan& found) {
  spin_up_left_ = milliseconds(0);
  found.about.points = found.points;
  return nb::cast(
      kept_scan(found.about, on_.has_own_clock ? on_.wall_ahead_ns : wall_clock().ahead().count()));
}

nb::object live_lidar::next_scan(milliseconds timeout, bool may_time_out) {
  const auto due = std::chrono::steady_clock::now() + timeout;
  const auto wait = [&](lidar& on) -> result<std::optional<copied_scan>> {
    // Less after a signal, but for clocks other than that of the caller.
    const auto left = on_.has_own_clock
                          ? timeout
                          : std::chrono::ceil<milliseconds>(due - std::chrono::steady_clock::now());
    const auto found = on.next_scan(std::max(left, milliseconds(0)));
    if (!found) {
      if (may_time_out && found.error() == problem::timeout) return std::nullopt;
      return tl::unexpected(found.error());
    }
    if (on_.recording && !found->is_piece()) {
      on_.recording->scan(*found);
      if (const auto why = on_.recording->take_error()) return tl::unexpected(*why);
    }
    return copied_scan{*found, {found->points.begin(), found->points.end()}};
  };
  return run(wait,
             [&](std::optional<copied_scan>& found) { return found ? keep(*found) : nb::none(); });
}

/// The newest scan that has arrived; at least `found`.
nb::object live_lidar::newer(nb::object found) {
  while (!on_.plays_at_once) {
    nb::object next = next_scan(milliseconds(0), true);
    if (next.is_none()) break;
    found = std::move(next);
    ++dropped_;
  }
  return found;
}

nb::object live_lidar::poll_scan(bool newest) {
  try {
    nb::object found = next_scan(milliseconds(0), true);
    return newest && !found.is_none() ? newer(std::move(found)) : found;
  } catch (nb::python_error& raised) {
    if (!raised.matches(nb::module_::import_("g4lidar.errors").attr("Reconnecting"))) throw;
    return nb::none();
  }
}

nb::object live_lidar::next_deadline() {
  const std::int64_t due_ns = look([](lidar& on) { return on.next_deadline_ns(); });
  if (due_ns == never_ns) return nb::none();
  return nb::float_(on_.has_own_clock ? 0.0 : static_cast<double>(due_ns) * 1e-9);
}

nb::object live_lidar::next_in_loop(std::optional<milliseconds> timeout, bool newest) {
  const milliseconds wait = timeout.value_or(a_year);
  while (!closed_) {
    try {
      nb::object found = next_scan(wait);
      return newest ? newer(std::move(found)) : found;
    } catch (nb::python_error& raised) {
      const nb::module_ errors = nb::module_::import_("g4lidar.errors");
      if (on_.has_own_clock && raised.matches(errors.attr("EndOfInput"))) return nb::none();
      if (closed_ &&
          (raised.matches(errors.attr("Cancelled")) || raised.matches(errors.attr("Gone")))) {
        return nb::none();
      }
      if (raised.matches(errors.attr("Reconnecting"))) continue;
      if (!raised.matches(errors.attr("Timeout")) || spin_up_left_.count() <= 0) throw;
      spin_up_left_ -= std::max(wait, milliseconds(1));
    }
  }
  return nb::none();
}

void live_lidar::close_all() {
  for (live_lidar* const each : std::vector(all_lidars())) {
    if (!each->process_.is_this_one()) continue;
    try {
      each->close();
    } catch (nb::python_error& raised) {
      raised.discard_as_unraisable("g4lidar at the end of the program");
    }
  }
}

}  // namespace g4lidar::python
