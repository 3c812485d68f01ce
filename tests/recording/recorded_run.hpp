// SPDX-License-Identifier: MIT
// Runs of a driver on the simulated device, recorded, and the same runs from the recording.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/sim/device.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar::test {

/// A path of its own, and nothing there before or after.
class temporary_path {
 public:
  explicit temporary_path(std::string_view end = ".mcap")
      : directory_(testing::TempDir() + "g4lidar-XXXXXX") {
    EXPECT_NE(::mkdtemp(directory_.data()), nullptr);
    path_ = directory_ + "/walk" + std::string(end);
  }
  temporary_path(const temporary_path&) = delete;
  temporary_path& operator=(const temporary_path&) = delete;
  ~temporary_path() {
    ::unlink(path_.c_str());
    for (int i = 1; i < 40; ++i) ::unlink(next(i).c_str());
    ::rmdir(directory_.c_str());
  }

  [[nodiscard]] const std::string& text() const noexcept { return path_; }
  /// Of the files that follow the first one.
  [[nodiscard]] std::string next(int number) const {
    std::string digits = std::to_string(number);
    return directory_ + "/walk-" + std::string(4 - digits.size(), '0') + digits + ".mcap";
  }

 private:
  std::string directory_;
  std::string path_;
};

/// What came out of a driver.
struct run_result {
  std::vector<point> points;
  std::vector<std::vector<point>> scans;
  lidar_counts counts;
  std::vector<lidar_event::kind> events;
  std::vector<sim::sent_sample> sent;  ///< By the simulated device, if only scans were read.
};

/// Takes what has come since the last time.
class collector {
 public:
  explicit collector(lidar& of) : reader_(of.points().make_reader()) {}

  void points(run_result& into) {
    while (true) {
      const ring_read read = reader_.read(memory_);
      EXPECT_EQ(read.missed, 0U);
      if (read.points == 0) return;
      into.points.insert(into.points.end(), memory_.begin(),
                         memory_.begin() + static_cast<std::ptrdiff_t>(read.points));
    }
  }

 private:
  lidar_ring::reader reader_;
  std::vector<point> memory_ = std::vector<point>(8192);
};

inline std::vector<sim::fault> faults_of(const std::vector<std::string_view>& texts) {
  std::vector<sim::fault> faults;
  for (const std::string_view text : texts) {
    faults.push_back(std::get<sim::fault>(sim::parse_fault(text)));
  }
  return faults;
}

/// Everything that a recording gives, from its beginning to its end.
inline run_result replayed(std::unique_ptr<connector> from, bool by_scans = true,
                           const lidar_options& options = {}) {
  using namespace std::chrono_literals;
  run_result run;
  auto opened = lidar::open(std::move(from), options);
  if (!opened) {
    ADD_FAILURE() << opened.error().message();
    return run;
  }
  collector all(*opened);
  EXPECT_TRUE(opened->start());
  while (true) {
    result<void> done;
    if (by_scans) {
      const auto scan = opened->try_scan(1000ms);
      if (scan) run.scans.emplace_back(scan->points.begin(), scan->points.end());
      if (!scan) done = tl::unexpected(scan.error());
    } else {
      done = opened->event_loop().process();
    }
    all.points(run);
    while (const auto event = opened->next_event()) run.events.push_back(event->what);
    if (!done && done.error().is_fatal()) {
      EXPECT_EQ(done.error().code(), problem::end_of_input) << done.error().message();
      break;
    }
  }
  EXPECT_TRUE(opened->close());
  run.counts = opened->counts();
  return run;
}

/// Compares, and shows the first difference.
inline void expect_same_points(const std::vector<point>& wanted, const std::vector<point>& got) {
  EXPECT_EQ(wanted.size(), got.size());
  for (std::size_t i = 0; i < std::min(wanted.size(), got.size()); ++i) {
    if (wanted[i] == got[i]) continue;
    ADD_FAILURE() << "point " << i << ": " << wanted[i].angle_deg << " deg " << wanted[i].range_mm
                  << " mm " << wanted[i].time_ns << " ns, revolution " << wanted[i].revolution
                  << "; got " << got[i].angle_deg << " deg " << got[i].range_mm << " mm "
                  << got[i].time_ns << " ns, revolution " << got[i].revolution;
    return;
  }
}

/// Records a healthy device for this time.
inline void record_device(recording_writer& into, std::int64_t until_ns,
                          bool with_metadata = true) {
  virtual_bench bench;
  auto from = recorded(std::make_unique<virtual_connector>(bench), into);
  auto device = lidar::open(std::move(*from));
  ASSERT_TRUE(device) << device.error().message();
  recorded_device known;
  known.information = device->information();
  if (with_metadata) into.device(known);
  ASSERT_TRUE(device->start());
  while (bench.now_ns < until_ns) {
    const auto scan = device->try_scan(std::chrono::milliseconds(500));
    if (scan) into.scan(*scan);
  }
}

}  // namespace g4lidar::test
