// SPDX-License-Identifier: MIT
// A simulated G4 on a pseudo-terminal, and what it truly sent.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/pty_port.hpp"

namespace g4lidar::test {

/// A directory of its own, gone at the end.
class scratch_directory {
 public:
  scratch_directory() {
    std::string name = (std::filesystem::temp_directory_path() / "g4lidar.XXXXXX").string();
    if (::mkdtemp(name.data()) != nullptr) path_ = name;
    EXPECT_FALSE(path_.empty());
  }
  scratch_directory(const scratch_directory&) = delete;
  scratch_directory& operator=(const scratch_directory&) = delete;
  ~scratch_directory() {
    std::error_code none;
    if (!path_.empty()) std::filesystem::remove_all(path_, none);
  }
  [[nodiscard]] std::string file(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// A healthy G4 with a quick motor, of which no two samples are alike, so that scans can be told
/// apart. It keeps the truth of 300,000 samples, 33 s.
inline sim::device_options quick_g4(std::uint64_t seed = 1) {
  sim::device_options options;
  options.scanner.seed = seed;
  options.scanner.noise_mm = 20.0;
  options.acceleration_mhz_per_s = 60'000;
  options.standstill_ns = 10'000'000;
  options.truth_capacity = 300'000;
  return options;
}

/// The readings of one revolution, in quarters of a millimetre.
using readings = std::vector<std::uint16_t>;

inline readings readings_of(const scan& seen) {
  readings all;
  for (const point& p : seen.points) {
    all.push_back(static_cast<std::uint16_t>(std::lround(p.range_mm * 4.0F)));
  }
  return all;
}

/// For tests of something else than the driver's patience, which another program on the machine may
/// try for a second.
inline lidar_options patient_options(std::string device = {}) {
  lidar_options options;
  options.device = std::move(device);
  options.answer_time = std::chrono::seconds(10);
  options.stall_time = std::chrono::seconds(60);
  return options;
}

/// The shortest of some measurements, of which there are more only until one is below `bound`: the
/// machine may be busy with something else.
template <class Measure>
std::chrono::nanoseconds best_of(int most, std::chrono::nanoseconds bound, Measure&& measure) {
  auto best = std::chrono::nanoseconds::max();
  for (int i = 0; i < most && best >= bound; ++i) {
    best = std::min<std::chrono::nanoseconds>(best, measure());
    if (testing::Test::HasFatalFailure()) break;
  }
  return best;
}

class twin_on_pty {
 public:
  explicit twin_on_pty(const sim::device_options& options = quick_g4(),
                       std::span<const sim::fault> faults = {})
      : path_(directory_.file("g4")) {
    auto opened =
        sim::background_pty::open(sim::device(sim::built_in_world(), options, faults), path_);
    EXPECT_TRUE(opened) << opened.error().message();
    if (opened) port_ = std::make_unique<sim::background_pty>(std::move(*opened));
  }

  /// The same wherever it is plugged in.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  template <class Look>
  void with(Look&& look) {
    port_->with(look);
  }
  /// When, by the steady clock.
  std::chrono::steady_clock::time_point unplug() {
    std::chrono::steady_clock::time_point when;
    with([&](sim::device& twin, std::int64_t now_ns) {
      twin.unplug(now_ns);
      when = std::chrono::steady_clock::now();
    });
    return when;
  }
  void replug() {
    with([](sim::device& twin, std::int64_t now_ns) { twin.replug(now_ns); });
  }

  /// What was sent and found no place on the line, since we did not read: an accident of the machine,
  /// or of the driver, if it happens each time.
  [[nodiscard]] std::uint64_t bytes_lost() const { return port_->bytes_lost(); }

  /// Whether it becomes so within thirty seconds.
  [[nodiscard]] bool becomes_idle_and_silent() {
    for (int i = 0; i < 3000; ++i) {
      bool idle = false;
      with([&](sim::device& twin, std::int64_t now_ns) { idle = twin.is_idle_and_silent(now_ns); });
      if (idle) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

  [[nodiscard]] sim::device_settings settings() {
    sim::device_settings found;
    with([&](const sim::device& twin, std::int64_t) { found = twin.settings(); });
    return found;
  }

  /// Everything that it has sent and that was not taken yet.
  [[nodiscard]] std::vector<sim::sent_sample> take_truth() {
    std::vector<sim::sent_sample> all;
    with([&](sim::device& twin, std::int64_t) {
      EXPECT_EQ(twin.truth_missed(), 0U);
      std::array<sim::sent_sample, 256> some;
      while (const std::size_t count = twin.take_truth(some)) {
        all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(count));
      }
    });
    return all;
  }

 private:
  scratch_directory directory_;
  std::string path_;
  std::unique_ptr<sim::background_pty> port_;
};

/// What was sent, cut at the zero packets: the revolutions that began with one.
inline std::vector<readings> revolutions_of(const std::vector<sim::sent_sample>& sent) {
  std::vector<readings> all;
  for (const sim::sent_sample& sample : sent) {
    if (sample.zero) all.emplace_back();
    if (!all.empty()) all.back().push_back(sample.truth.raw);
  }
  return all;
}

/// How many of the scans, which are in order, are exactly a revolution that was sent, in order.
inline std::size_t found_in_order(const std::vector<readings>& scans,
                                  const std::vector<readings>& sent) {
  std::size_t found = 0;
  auto from = sent.begin();
  for (const readings& each : scans) {
    const auto at = std::find(from, sent.end(), each);
    if (at == sent.end()) continue;
    from = std::next(at);
    ++found;
  }
  return found;
}

/// Makes an attempt that loses nothing, and gives whether it was one in which the line lost nothing
/// either: a machine that is held up for longer than a pseudo-terminal can hold what comes is no fault
/// of ours, unless it is so each time.
template <class Attempt>
void until_the_line_holds(Attempt&& attempt) {
  for (int i = 0; i < 6; ++i) {
    if (attempt() || testing::Test::HasFatalFailure()) return;
  }
  ADD_FAILURE() << "the line is not read in time";
}

inline void expect_identity(const lidar_counts& counts) {
  EXPECT_EQ(counts.bytes, counts.stream.frame_bytes + counts.stream.skipped_bytes() + counts.held);
}

}  // namespace g4lidar::test
