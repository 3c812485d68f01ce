// SPDX-License-Identifier: MIT
// The scans of one lidar: their points are those of a scan_shaper, and only those that a sink wants.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "g4lidar/scan_shaper.hpp"
#include "service_bench.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

class ServiceScans : public Service {
 protected:
  /// The products of a scan_shaper, of the same recording; from scan `change_at` on by other options.
  static std::vector<seen_scan> shaped(const std::string& file, const shaping_options& options,
                                       std::size_t change_at = 0,
                                       const shaping_options& others = {}) {
    std::vector<seen_scan> all;
    scan_shaper shaper(options);
    auto device = lidar::open({.device = file});
    EXPECT_TRUE(device && device->start());
    while (const auto found = device->try_scan(1s)) {
      if (change_at > 0 && all.size() == change_at) shaper.set_options(others);
      shaper.shape(*found);
      service_scan made{.for_grid = shaper.for_grid(), .kept = shaper.kept()};
      made.first_ns = found->time_ns();
      made.duration_ns = found->duration_ns;
      all.emplace_back(made);
    }
    return all;
  }
};

TEST_F(ServiceScans, HaveThePointsOfAScanShaper) {
  const shaping_options wanted{
      .filter = {.in = frame::robot, .field_of_view = {-90, 90}, .least_range_mm = 500},
      .marks = {.speckle = speckle_limits{}, .edges = edge_limits{}, .near = near_limits{}},
      .deskew = deskewing::by_scans,
      .restamps = true};
  service_options options{.deskew = deskewing::by_scans, .restamps = true};
  options.filters.filter = wanted.filter;
  options.filters.marks = wanted.marks;
  heard.want({.for_grid = true, .kept = true});
  const std::string& file = recording();
  play(file, std::move(options));
  const auto expected = shaped(file, wanted);
  ASSERT_GT(expected.size(), 20U);
  ASSERT_EQ(heard.scans.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    expect_same_points(expected[i].kept, heard.scans[i].kept);
    expect_same_points(expected[i].for_grid, heard.scans[i].for_grid);
    EXPECT_EQ(heard.scans[i].about.first_ns, expected[i].about.first_ns);
    EXPECT_EQ(heard.scans[i].about.duration_ns, expected[i].about.duration_ns);
    EXPECT_EQ(heard.scans[i].about.ahead_ns, recorded_ahead_ns);
    EXPECT_EQ(heard.scans[i].about.stamp_ns(5), recorded_ahead_ns + 5);
    EXPECT_FALSE(heard.scans[i].about.is_upside_down);
  }
}

TEST_F(ServiceScans, OnlyWhatASinkWantsIsMade_AlsoWhenThatChanges) {
  sink_record other;
  other.want({});
  outputs.push_back({&other, delivery::in_reader});
  heard.want({});
  heard.during_scan = [&] {
    heard.want({.for_grid = heard.scans.size() == 2, .kept = heard.scans.size() == 4});
  };
  play(recording());
  ASSERT_GT(heard.scans.size(), 6U);
  ASSERT_EQ(other.scans.size(), heard.scans.size());
  for (std::size_t i = 0; i < heard.scans.size(); ++i) {
    EXPECT_EQ(heard.scans[i].for_grid.empty(), i != 2) << i;
    EXPECT_EQ(heard.scans[i].kept.empty(), i != 4) << i;
    EXPECT_EQ(heard.scans[i].about.made.for_grid, i == 2);
    EXPECT_EQ(other.scans[i].kept.empty(), i != 4) << "what another one wants";
    EXPECT_GT(heard.scans[i].about.duration_ns, 0);
  }
}

TEST_F(ServiceScans, AFilterHoldsFromTheNextScanOn) {
  heard.during_scan = [&] {
    if (heard.scans.size() != 5) return;
    EXPECT_EQ(service->change_now(0, {{"range_min", 1.5}, {"speckle", std::string("on")}}), "");
  };
  const std::string& file = recording();
  play(file);
  const auto expected = shaped(
      file, {}, 5, {.filter = {.least_range_mm = 1500}, .marks = {.speckle = speckle_limits{}}});
  ASSERT_EQ(heard.scans.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    expect_same_points(expected[i].kept, heard.scans[i].kept);
  EXPECT_EQ(value("range_min"), parameter_value(1.5));
}

TEST_F(ServiceScans, AWrongFilterChangesNothing) {
  heard.during_scan = [&] {
    if (heard.scans.size() != 5) return;
    EXPECT_THAT(service->change_now(0, {{"range_min", 1.5}, {"fov", std::string("left")}}),
                HasSubstr("fov"));
  };
  const std::string& file = recording();
  play(file);
  const auto expected = shaped(file, {});
  ASSERT_EQ(heard.scans.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    expect_same_points(expected[i].kept, heard.scans[i].kept);
  EXPECT_EQ(value("range_min"), parameter_value(0.0));
}

TEST_F(ServiceScans, AreMeasuredOnes_BeforeTheyAreShaped) {
  struct raw final : sink_record {
    void on_open(std::size_t, lidar& device) override { name = device.name(); }
    void on_measured(std::size_t, const scan& found) override {
      EXPECT_EQ(scans.size(), measured.size());
      measured.emplace_back(found.begin(), found.end());
    }
    std::string name;
    std::vector<std::vector<point>> measured;
  } sink;
  outputs = {{&sink, delivery::in_reader}, {&heard, delivery::in_reader}};
  const std::string& file = recording();
  service_options options;
  options.filters.filter.least_range_mm = 3000;
  play(file, std::move(options));
  const auto expected = shaped(file, {});
  ASSERT_EQ(sink.measured.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    expect_same_points(expected[i].kept, sink.measured[i]);
  EXPECT_EQ(sink.name, file);
}

/// By the clock of another program, which does not answer at first.
TEST_F(ServiceScans, StampsByAnotherClock_Are0UntilItIsKnown) {
  std::atomic<bool> is_known = false;
  service_options options{.gives_points = true};
  options.stamp_clock = [&](std::int64_t wall_ahead_ns) {
    return is_known ? std::optional(wall_ahead_ns + 3600 * second) : std::nullopt;
  };
  begin("sim:?seed=3", std::move(options));
  ASSERT_TRUE(heard.wait_for_scans(2));
  {
    const std::lock_guard lock(heard.mutex);
    EXPECT_FALSE(heard.scans.back().about.ahead_ns);
    EXPECT_EQ(heard.scans.back().about.stamp_ns(heard.scans.back().about.first_ns), 0);
    EXPECT_EQ(heard.times.back(), 0);
    heard.times.clear();
  }
  is_known = true;
  ASSERT_TRUE(heard.wait_for_scans(2));
  service->stop();
  const service_scan& last = heard.scans.back().about;
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  const std::int64_t expected = std::chrono::nanoseconds(wall).count() + 3600 * second;
  EXPECT_LT(std::abs(last.stamp_ns(last.first_ns) - expected), patience / 1ns);
  EXPECT_LT(std::abs(heard.times.back() - expected), patience / 1ns);
  EXPECT_TRUE(std::ranges::is_sorted(heard.times));
}

}  // namespace
}  // namespace g4lidar::test
