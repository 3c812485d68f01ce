// SPDX-License-Identifier: MIT
#include "g4lidar/background_reader.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "driver.hpp"
#include "event_queue.hpp"
#include "scan_queue.hpp"

namespace g4lidar {

struct G4LIDAR_HIDDEN background_reader::state {
  explicit state(lidar&& given) noexcept : device(std::move(given)) {}

  void run() {
    while (!stopping.load(std::memory_order_acquire)) {
      const auto waited = wait(longest_wait);
      publish();
      if (waited || !waited.error().is_fatal()) continue;
      const std::lock_guard lock(mutex);
      failure = waited.error();
      scans.end();
      return;
    }
  }

  /// Waits until a scan arrives, or something is due.
  result<void> wait(lidar::milliseconds timeout) {
    const auto scan = device.next_scan(timeout);
    detail.store(scan ? error_detail::usual : scan.error().detail(), std::memory_order_relaxed);
    if (!scan) return tl::unexpected(scan.error());
    scans.put(*scan);
    return {};
  }

  void publish() {
    const std::lock_guard lock(mutex);
    counts = device.counts();
    while (const auto found = device.next_event()) events.put(*found);
  }

  void stop() noexcept {
    stopping.store(true, std::memory_order_release);
    if (!thread.joinable()) return;
    device.wake();
    thread.join();
    // The thread may have ended without being woken.
    const auto stopped = device.stop();
    if (!stopped && stopped.error() == problem::cancelled) static_cast<void>(device.stop());
    while (wait(lidar::milliseconds(0))) {  // what was measured before the stop
    }
    scans.end();
    publish();
  }

  static constexpr std::chrono::milliseconds longest_wait{100};

  lidar device;
  scan_queue scans;
  std::atomic<bool> stopping = false;
  std::atomic<error_detail> detail = error_detail::usual;  // why no scan has come
  mutable std::mutex mutex;                                // protects the following members
  lidar_counts counts;
  event_queue events;
  std::optional<error> failure;
  std::mutex stop_mutex;  // for stop() by several threads at once
  std::thread thread;
};

background_reader::background_reader(std::unique_ptr<state> made) noexcept
    : state_(std::move(made)) {}
background_reader::background_reader(background_reader&&) noexcept = default;

background_reader& background_reader::operator=(background_reader&& other) noexcept {
  if (this != &other) {
    stop();
    state_ = std::move(other.state_);
  }
  return *this;
}

background_reader::~background_reader() { stop(); }

result<background_reader> background_reader::start(lidar&& device) {
  auto made = std::make_unique<state>(std::move(device));
  if (auto started = made->device.start(); !started) return tl::unexpected(started.error());
  try {
    made->thread = std::thread([running = made.get()] { running->run(); });
  } catch (const std::system_error& refused) {
    return g4lidar::failure(task::starting, problem::system, "a thread", refused.code().value());
  }
  return background_reader(std::move(made));
}

void background_reader::stop() noexcept {
  if (state_ == nullptr) return;
  const std::lock_guard lock(state_->stop_mutex);
  state_->stop();
}

view_result<scan> background_reader::next_scan(lidar::milliseconds timeout) {
  if (state_ == nullptr) return moved_from();
  constexpr lidar::milliseconds longest = std::chrono::hours(24 * 365);
  const auto wait = std::clamp(timeout, lidar::milliseconds(0), longest);
  if (const auto found = state_->scans.take(std::chrono::steady_clock::now() + wait)) return *found;
  if (const auto why = failed()) return tl::unexpected(*why);
  const bool stopped = state_->stopping.load(std::memory_order_acquire);
  if (stopped) return g4lidar::failure(task::reading, problem::not_scanning);
  return g4lidar::failure(task::reading, problem::timeout, {}, 0,
                          state_->detail.load(std::memory_order_relaxed));
}

const lidar_ring& background_reader::points() const noexcept {
  return state_ ? state_->device.points() : empty_ring();
}

std::optional<error> background_reader::failed() const {
  if (state_ == nullptr) return moved_from().value();
  const std::lock_guard lock(state_->mutex);
  return state_->failure;
}

lidar_counts background_reader::counts() const {
  if (state_ == nullptr) return {};
  const std::lock_guard lock(state_->mutex);
  lidar_counts all = state_->counts;
  all.scans_missed += state_->scans.missed();
  return all;
}

std::optional<lidar_event> background_reader::next_event() {
  if (state_ == nullptr) return std::nullopt;
  const std::lock_guard lock(state_->mutex);
  return state_->events.take();
}

}  // namespace g4lidar
