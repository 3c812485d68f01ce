// SPDX-License-Identifier: MIT
// A simulated G4 on a pseudo-terminal, and its true values.
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
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "support/machine_watch.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {

/// A temporary directory, removed at the end.
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

/// A healthy G4 with a quick motor and without equal samples, so that scans can be distinguished.
/// It stores the true values of 300,000 samples, 33 s.
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

/// For tests that do not examine the timeouts of the driver: another program on the machine may
/// delay the test for a second.
inline lidar_options patient_options(std::string device = {}) {
  lidar_options options;
  options.device = std::move(device);
  options.tuning.answer_time = std::chrono::seconds(10);
  options.tuning.stall_time = std::chrono::seconds(60);
  return options;
}

class device_on_pty {
 public:
  explicit device_on_pty(const sim::device_options& options = quick_g4(),
                         std::span<const sim::fault> faults = {})
      : path_(directory_.file("g4")) {
    auto opened =
        sim::background_pty::open(sim::device(sim::built_in_world(), options, faults), path_);
    EXPECT_TRUE(opened) << opened.error().message();
    if (opened) port_ = std::make_unique<sim::background_pty>(std::move(*opened));
  }

  /// The path, which does not change.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  template <class Look>
  void with(Look&& look) {
    port_->with(look);
  }
  /// The time, by the steady clock.
  std::chrono::steady_clock::time_point unplug() {
    std::chrono::steady_clock::time_point when;
    with([&](sim::device& simulated, std::int64_t now_ns) {
      simulated.unplug(now_ns);
      when = std::chrono::steady_clock::now();
    });
    return when;
  }
  void replug() {
    with([](sim::device& simulated, std::int64_t now_ns) { simulated.replug(now_ns); });
  }

  /// Bytes that were lost because the test did not read: caused by the machine, or by the driver if
  /// it happens each time.
  [[nodiscard]] std::uint64_t bytes_lost() const { return port_->bytes_lost(); }

  /// Whether it becomes idle and silent within `patience`.
  [[nodiscard]] bool becomes_idle_and_silent() {
    return comes_true([&] {
      bool idle = false;
      with([&](sim::device& simulated, std::int64_t now_ns) {
        idle = simulated.is_idle_and_silent(now_ns);
      });
      return idle;
    });
  }

  [[nodiscard]] sim::device_settings settings() {
    sim::device_settings found;
    with([&](const sim::device& simulated, std::int64_t) { found = simulated.settings(); });
    return found;
  }

  /// All sent samples that were not taken yet.
  [[nodiscard]] std::vector<sim::sent_sample> take_truth() {
    std::vector<sim::sent_sample> all;
    with([&](sim::device& simulated, std::int64_t) {
      EXPECT_EQ(simulated.truth_missed(), 0U);
      std::array<sim::sent_sample, 256> some;
      while (const std::size_t count = simulated.take_truth(some)) {
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

/// The sent samples, cut at the zero packets: the revolutions that began with one.
inline std::vector<readings> revolutions_of(const std::vector<sim::sent_sample>& sent) {
  std::vector<readings> all;
  for (const sim::sent_sample& sample : sent) {
    if (sample.zero) all.emplace_back();
    if (!all.empty()) all.back().push_back(sample.truth.raw);
  }
  return all;
}

/// How many of the scans, which are in order, are exactly a sent revolution, in order.
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

inline void expect_identity(const lidar_counts& counts) {
  EXPECT_EQ(counts.bytes, counts.stream.parsed_bytes + counts.stream.skipped_bytes() + counts.held);
}

}  // namespace g4lidar::test
