// SPDX-License-Identifier: MIT
// A thread that runs one device; an eventfd ends it, and lets other threads use the device for a
// moment.
#include <poll.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <span>
#include <thread>
#include <utility>

#include "g4lidar/sim/pty_port.hpp"
#include "transport/owned_fd.hpp"

namespace g4lidar::sim {

class G4LIDAR_HIDDEN background_pty::state {
 public:
  state(pty_port port, owned_fd wake_descriptor)
      : port_(std::move(port)), path_(port_.path()), wake_descriptor_(std::move(wake_descriptor)) {
    thread_ = std::thread([this] { run(); });
  }
  ~state() {
    ending_ = true;
    ring();
    thread_.join();
  }
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  void with(const std::function<void(device&, std::int64_t)>& look) {
    const std::lock_guard lock(mutex_);  // recursive: `look` may use this, too
    look(port_.simulated(), port_.now_ns());
    ring();
  }
  [[nodiscard]] std::uint64_t bytes_lost() {
    const std::lock_guard lock(mutex_);
    return port_.bytes_lost();
  }

 private:
  void ring() const noexcept {
    [[maybe_unused]] const int ignored = ::eventfd_write(wake_descriptor_.get(), 1);
  }

  void run() {
    while (!ending_) {
      std::array<pollfd, 3> waiting{{{wake_descriptor_.get(), POLLIN, 0}, {-1, 0, 0}, {-1, 0, 0}}};
      std::int64_t sleep_ns = forever_ns;
      {
        const std::lock_guard lock(mutex_);
        const result<std::int64_t> next = port_.process();
        if (!next) return;
        if (*next != forever_ns) sleep_ns = *next - port_.now_ns();
        const pty_port::handles handles = port_.native_handles();
        waiting[1] = {handles.client, POLLIN, 0};
        waiting[2] = {handles.visitors, POLLIN, 0};
      }
      constexpr std::int64_t longest_ns = 3'600'000'000'000;
      sleep_ns = std::clamp<std::int64_t>(sleep_ns, 0, longest_ns);
      constexpr std::int64_t unit_ns = 1'000'000'000;
      const timespec sleep{static_cast<std::time_t>(sleep_ns / unit_ns),
                           static_cast<long>(sleep_ns % unit_ns)};
      if (::ppoll(waiting.data(), waiting.size(), &sleep, nullptr) > 0 && waiting[0].revents != 0) {
        eventfd_t rung = 0;
        [[maybe_unused]] const int ignored = ::eventfd_read(wake_descriptor_.get(), &rung);
      }
    }
  }

  pty_port port_;
  std::string path_;
  owned_fd wake_descriptor_;
  std::recursive_mutex mutex_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

background_pty::background_pty(std::unique_ptr<state> made) noexcept : state_(std::move(made)) {}
background_pty::background_pty(background_pty&&) noexcept = default;
background_pty& background_pty::operator=(background_pty&&) noexcept = default;
background_pty::~background_pty() = default;

result<background_pty> background_pty::open(device simulated, const std::string& link) {
  owned_fd wake_descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake_descriptor) return failure(task::opening, problem::system, "an eventfd", errno);
  result<pty_port> port = pty_port::open(std::move(simulated), link);
  if (!port) return tl::unexpected<error>(port.error());
  return background_pty(std::make_unique<state>(std::move(*port), std::move(wake_descriptor)));
}

const std::string& background_pty::path() const noexcept { return state_->path(); }

void background_pty::with(const std::function<void(device&, std::int64_t)>& look) {
  state_->with(look);
}

std::uint64_t background_pty::bytes_lost() const { return state_->bytes_lost(); }

}  // namespace g4lidar::sim
