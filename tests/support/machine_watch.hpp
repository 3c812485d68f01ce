// SPDX-License-Identifier: MIT
// For tests that measure real time: whether the machine stopped the test.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

namespace g4lidar::test {

/// How long the threads of this process that exist have waited for a processor, in all.
inline std::chrono::nanoseconds waited_for_processor() {
  std::chrono::nanoseconds all{0};
  std::error_code ignored;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task", ignored)) {
    long long running_ns = 0;
    long long waiting_ns = 0;
    std::ifstream(thread.path() / "schedstat") >> running_ns >> waiting_ns;
    all += std::chrono::nanoseconds(waiting_ns);
  }
  return all;
}

/// A thread that sleeps for a millisecond again and again, and adds up the times by which it was late. Causes: other
/// programs, the host of a virtual machine, a debugger. On an idle machine each time is below 2 ms, and does not count.
/// Other programs delay threads that work more than one that sleeps: so the times count in which threads of the
/// test waited for a processor, too.
class machine_watch {
 public:
  machine_watch() : thread_([this] { watch(); }) {}
  machine_watch(const machine_watch&) = delete;
  machine_watch& operator=(const machine_watch&) = delete;
  ~machine_watch() {
    is_over_ = true;
    thread_.join();
  }

  /// Whether the test was stopped for so long that a measured time does not describe the tested program.
  [[nodiscard]] bool was_stopped() const noexcept {
    constexpr std::chrono::milliseconds long_stop{20};
    constexpr std::chrono::milliseconds long_wait{100};
    if (waited_for_processor() - waited_before_ > long_wait) return true;
    return late_.load() + lateness(clock::now() - awake_.load()) > long_stop;
  }

 private:
  using clock = std::chrono::steady_clock;

  static clock::duration lateness(clock::duration slept) noexcept {
    constexpr std::chrono::milliseconds usual{2};
    return slept > usual ? slept : clock::duration(0);
  }
  void watch() noexcept {
    while (!is_over_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      const auto now = clock::now();
      late_ = late_.load() + lateness(now - awake_.load());
      awake_ = now;
    }
  }

  std::chrono::nanoseconds waited_before_ = waited_for_processor();
  std::atomic<clock::duration> late_{clock::duration(0)};
  std::atomic<clock::time_point> awake_{clock::now()};
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

inline constexpr const char* machine_was_stopped =
    "the machine was stopped while the test measured times";

/// The time that `percent` of the times do not exceed (the nearest rank).
inline std::chrono::nanoseconds percentile_of(std::size_t percent,
                                              std::vector<std::chrono::nanoseconds> times) {
  if (times.empty()) return std::chrono::nanoseconds::max();
  std::sort(times.begin(), times.end());
  return times[(times.size() * percent + 99) / 100 - 1];
}

/// The time that `percent` of the runs do not exceed is below `limit`. A run that takes longer while the
/// machine is stopped is repeated; after as many of these as there are runs, the test is skipped.
template <class Measure>
void expect_percentile_below(std::chrono::nanoseconds limit, std::size_t percent, std::size_t runs,
                             Measure&& measure) {
  std::vector<std::chrono::nanoseconds> times;
  std::size_t stopped = 0;
  while (times.size() < runs && !testing::Test::HasFailure()) {
    const machine_watch machine;
    const std::chrono::nanoseconds time = measure();
    if (time < limit || !machine.was_stopped()) {
      times.push_back(time);
    } else if (++stopped >= runs) {
      GTEST_SKIP() << machine_was_stopped;
    }
  }
  EXPECT_LT(percentile_of(percent, times), limit);
}

/// Three of four attempts succeed; ends when the result is certain. An attempt fails if the machine delayed
/// the reader until the pseudo-terminal was full. If the machine was stopped, it does not count; after four of these,
/// the test is skipped.
template <class Attempt>
void expect_three_of_four(Attempt&& attempt) {
  int held = 0;
  int failed = 0;
  int stopped = 0;
  while (held < 3 && failed < 2 && !testing::Test::HasFailure()) {
    const machine_watch machine;
    if (attempt()) {
      ++held;
    } else if (!machine.was_stopped()) {
      ++failed;
    } else if (++stopped == 4) {
      GTEST_SKIP() << machine_was_stopped;
    }
  }
  EXPECT_EQ(held, 3);
}

}  // namespace g4lidar::test
