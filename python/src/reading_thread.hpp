// SPDX-License-Identifier: MIT
// A lidar that a thread of the library reads: Python's class BackgroundReader.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <mutex>
#include <optional>

#include "g4lidar/background_reader.hpp"
#include "live_lidar.hpp"

namespace g4lidar::python {

/// Calls of several threads for scans wait for each other, without the GIL. In a process made by fork() every call fails
/// with RuntimeError.
class reading_thread {
 public:
  /// `wall_ahead_ns`: of a file.
  reading_thread(background_reader&& started, foundation base,
                 std::optional<std::int64_t> wall_ahead_ns);
  reading_thread(const reading_thread&) = delete;
  reading_thread& operator=(const reading_thread&) = delete;
  ~reading_thread();

  /// The next scan. Ended by a signal whose handler raises. Raises Timeout, and why the thread has ended.
  [[nodiscard]] nb::object next_scan(live_lidar::milliseconds timeout);
  /// For a loop: without a limit. Raises StopIteration at the end of a file, and after stop().
  [[nodiscard]] nb::object next_in_loop();
  void stop();
  /// What another thread may call at any time.
  [[nodiscard]] background_reader& reader() {
    process_.check("this reader");
    return *reader_;
  }
  /// Stops every one of this process: at the end of the program.
  static void stop_all();

 private:
  /// The next scan, or why there is none.
  [[nodiscard]] result<copied_scan> wait(live_lidar::milliseconds timeout);

  foundation on_;
  std::unique_ptr<background_reader> reader_;
  std::optional<std::int64_t> wall_ahead_ns_;
  process process_;
  std::timed_mutex mutex_;
};

/// The class, and Lidar.background().
void bind_background(nb::module_& module, nb::class_<live_lidar>& bound);

}  // namespace g4lidar::python
