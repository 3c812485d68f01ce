// SPDX-License-Identifier: MIT
#include "service/sink_queue.hpp"

#include <algorithm>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "g4lidar/lidar.hpp"

namespace g4lidar {
namespace {

constexpr std::ptrdiff_t most_scans = 4;
constexpr std::ptrdiff_t most_others = 64;

/// A service_scan with all that it views.
struct scan_copy {
  service_scan made;
  owned_scan for_grid;
  owned_scan kept;
  std::vector<std::size_t> kept_of_each;

  explicit scan_copy(const service_scan& from)
      : made(from),
        for_grid(from.for_grid),
        kept(from.kept),
        kept_of_each(from.kept_of_each.begin(), from.kept_of_each.end()) {
    made.for_grid = for_grid.view();
    made.kept = kept.view();
    made.kept_of_each = kept_of_each;
  }
  scan_copy(const scan_copy&) = delete;
  scan_copy& operator=(const scan_copy&) = delete;
};

}  // namespace

result<void> sink_queue::start() {
  if (thread_.joinable()) return {};
  try {
    thread_ = std::thread([this] { run(); });
  } catch (const std::system_error& refused) {
    return failure(task::starting, problem::system, "a thread", refused.code().value());
  }
  return {};
}

void sink_queue::stop() noexcept {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void sink_queue::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_over_ || !calls_.empty(); });
    if (is_over_) return;
    const call next = std::move(calls_.front());
    calls_.pop_front();
    lock.unlock();
    next.make(target_);
    lock.lock();
  }
}

void sink_queue::drop_one(kind what) {
  const std::ptrdiff_t most = what == kind::scan ? most_scans : most_others;
  if (std::ranges::count(calls_, what, &call::what) <= most) return;
  calls_.erase(std::ranges::find(calls_, what, &call::what));
}

void sink_queue::add(call made) {
  {
    const std::lock_guard lock(mutex_);
    if (is_over_) return;
    // It replaces a state or a time of this lidar that was not delivered yet.
    const bool replaces = made.what == kind::state || made.what == kind::time;
    if (replaces) {
      std::erase_if(calls_, [&made](const call& each) {
        return each.what == made.what && each.lidar == made.lidar;
      });
    }
    const kind what = made.what;
    calls_.push_back(std::move(made));
    if (!replaces) drop_one(what);
  }
  changed_.notify_one();
}

void sink_queue::on_scan(const service_scan& made) {
  const auto copy = std::make_shared<scan_copy>(made);
  add({kind::scan, 0, [copy](service_sink& to) { to.on_scan(copy->made); }});
}

void sink_queue::on_odometry(const stamped_odometry& now, std::int64_t stamp_ns) {
  add({kind::other, 0, [=](service_sink& to) { to.on_odometry(now, stamp_ns); }});
}

void sink_queue::on_time(std::size_t lidar, std::int64_t stamp_ns) {
  add({kind::time, lidar, [=](service_sink& to) { to.on_time(lidar, stamp_ns); }});
}

void sink_queue::on_motion(bool is_known, const std::string& why) {
  add({kind::other, 0, [=](service_sink& to) { to.on_motion(is_known, why); }});
}

void sink_queue::on_event(std::size_t lidar, const lidar_event& event, std::int64_t stamp_ns) {
  add({kind::other, lidar, [=](service_sink& to) { to.on_event(lidar, event, stamp_ns); }});
}

void sink_queue::on_state(std::size_t lidar, reader_state state, const std::optional<error>& why) {
  add({kind::state, lidar, [=](service_sink& to) { to.on_state(lidar, state, why); }});
}

void sink_queue::on_values(std::size_t lidar, const std::string& refused) {
  add({kind::other, lidar, [=](service_sink& to) { to.on_values(lidar, refused); }});
}

}  // namespace g4lidar
