// SPDX-License-Identifier: MIT
#include "g4lidar/background_reader.hpp"

#include <atomic>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "event_queue.hpp"

namespace g4lidar {

struct G4LIDAR_HIDDEN background_reader::state {
  explicit state(lidar&& given) noexcept : device(std::move(given)) {}

  void run() {
    while (!stopping.load(std::memory_order_acquire)) {
      const auto waited = wait();
      publish();
      if (waited || !waited.error().is_fatal()) continue;
      const std::lock_guard lock(mutex);
      failure = waited.error();
      return;
    }
  }

  /// Until bytes come or something is due. The scans are for nobody here.
  result<void> wait() {
    const auto scan = device.next_scan(longest_wait);
    if (scan) return {};
    return tl::unexpected(scan.error());
  }

  void publish() {
    const std::lock_guard lock(mutex);
    counts = device.counts();
    while (const auto told = device.next_event()) events.put(*told);
  }

  void stop() noexcept {
    stopping.store(true, std::memory_order_release);
    if (!thread.joinable()) return;
    device.wake();
    thread.join();
    // The thread may have ended without having been woken.
    const auto stopped = device.stop();
    if (!stopped && stopped.error().what() == problem::cancelled) static_cast<void>(device.stop());
    publish();
  }

  static constexpr std::chrono::milliseconds longest_wait{100};

  lidar device;
  std::atomic<bool> stopping = false;
  mutable std::mutex mutex;  // of what follows
  lidar_counts counts;
  event_queue events;
  std::optional<error> failure;
  std::mutex stop_mutex;  // stop() by several threads at once
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

lidar_ring& background_reader::points() noexcept { return state_->device.points(); }

std::optional<error> background_reader::failed() const {
  const std::lock_guard lock(state_->mutex);
  return state_->failure;
}

lidar_counts background_reader::counts() const {
  const std::lock_guard lock(state_->mutex);
  return state_->counts;
}

std::optional<lidar_event> background_reader::next_event() {
  const std::lock_guard lock(state_->mutex);
  return state_->events.take();
}

}  // namespace g4lidar
