// SPDX-License-Identifier: MIT
// The requests of other threads to the thread of a station, and its state for them.
#pragma once

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/exit_code.hpp"
#include "g4lidar/lidar.hpp"
#include "interrupt.hpp"
#include "station.hpp"

namespace g4_tool {

/// A descriptor that is readable after ring(), until wait() has seen it. *Any thread.*
class bell {
 public:
  bell() : fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (fd_ >= 0) return;
    if (errno != EMFILE) throw failure(exit_code::internal, "the system gives no eventfd.");
    throw failure(exit_code::bad_file, "Too many files are open. Raise the limit: ulimit -n 1024.");
  }
  bell(const bell&) = delete;
  bell& operator=(const bell&) = delete;
  ~bell() { ::close(fd_); }

  void ring() const noexcept { static_cast<void>(::eventfd_write(fd_, 1)); }
  /// Until it rings, `other` can be read (below 0: nothing), or the time has come.
  void wait(int other, std::chrono::steady_clock::time_point until) const noexcept {
    using namespace std::chrono_literals;
    const auto left = until == no_deadline ? 1h : until - std::chrono::steady_clock::now();
    const std::chrono::nanoseconds time = std::clamp<std::chrono::nanoseconds>(left, 0ns, 1h);
    const timespec longest{static_cast<std::time_t>(time / 1s),
                           static_cast<long>((time % 1s).count())};
    std::array<pollfd, 2> waiting{{{fd_, POLLIN, 0}, {other, POLLIN, 0}}};
    static_cast<void>(::ppoll(waiting.data(), waiting.size(), &longest, nullptr));
    eventfd_t rung = 0;
    static_cast<void>(::eventfd_read(fd_, &rung));
  }

 private:
  int fd_;
};

/// What other threads want of a station.
struct station_requests {
  bool stops = false;
  bool rests = false;
  std::optional<bool> pauses{};
  std::optional<double> speed{};
  std::optional<double> seek_s{};
  std::vector<std::function<void(g4lidar::lidar*)>> questions{};
};

/// What other threads see of it.
struct station_view {
  station_state state = station_state::opening;
  std::string why{};
  std::exception_ptr failure{};
  lidar_counts counts{};
  std::optional<device_information> identity{};
  std::string name{};
  std::optional<playback> player{};
};

/// Both, for *any thread*.
class station_board {
 public:
  template <class Change>
  void request(Change change) {
    {
      const std::lock_guard lock(mutex_);
      change(requests_);
    }
    bell_.ring();
  }
  /// What is wanted: `stops` and `rests` until they change, all else once.
  [[nodiscard]] station_requests take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(requests_, {.stops = requests_.stops, .rests = requests_.rests});
  }
  [[nodiscard]] bool has_to_stop() const {
    const std::lock_guard lock(mutex_);
    return requests_.stops;
  }
  /// Waits for a request, or as bell::wait().
  void wait(std::chrono::steady_clock::time_point until = no_deadline, int other = -1) const {
    bell_.wait(other, until);
  }

  template <class Change>
  void show(Change change) {
    const std::lock_guard lock(mutex_);
    change(view_);
  }
  [[nodiscard]] station_view view() const {
    const std::lock_guard lock(mutex_);
    return view_;
  }
  [[nodiscard]] station_state state() const {
    const std::lock_guard lock(mutex_);
    return view_.state;
  }

 private:
  bell bell_;
  mutable std::mutex mutex_;
  station_requests requests_;
  station_view view_;
};

}  // namespace g4_tool
