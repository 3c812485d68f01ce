// SPDX-License-Identifier: MIT
// The C interface, with extreme numbers: it refuses them, or what it gives can be used.
#include <g4lidar.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "numbers.hpp"
#include "recording/recorded_run.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::extreme;

constexpr std::int64_t most_ns = std::numeric_limits<std::int64_t>::max();

std::vector<g4lidar_point> any_points(test::dice& random) {
  std::vector<g4lidar_point> made(random.below(40));
  for (g4lidar_point& each : made) {
    each = {any<float>(random),         any<float>(random),        any<std::int64_t>(random),
            any<std::uint32_t>(random), any<std::uint8_t>(random), any<std::uint8_t>(random),
            any<std::uint16_t>(random)};
  }
  return made;
}
g4lidar_pose any_pose(test::dice& random) {
  return {any<double>(random), any<double>(random), any<double>(random)};
}
std::vector<g4lidar_stamped_pose> any_path(test::dice& random) {
  std::vector<g4lidar_stamped_pose> made(random.below(5));
  for (g4lidar_stamped_pose& each : made) each = {any<std::int64_t>(random), any_pose(random)};
  std::ranges::sort(made, {}, &g4lidar_stamped_pose::time_ns);
  return made;
}
unsigned any_turn(test::dice& random) {
  return random.below(2) == 0 ? 180U : any<unsigned>(random);
}

TEST(ExtremeC, Points) {
  many_times([](test::dice& random) {
    std::vector<g4lidar_point> points = any_points(random);
    const std::size_t count = points.size();
    std::vector<g4lidar_xy> places(count);
    std::vector<g4lidar_polar> polars(count);
    use(g4lidar_to_xy(points.data(), count, any<int>(random), any_turn(random), places.data()));
    use(g4lidar_to_polar(points.data(), count, static_cast<int>(random.below(2)), any_turn(random),
                         polars.data()));
    g4lidar_grid_options grid;
    g4lidar_grid_options_init(&grid, sizeof grid);
    if (random.below(2) == 0) grid.frame = any<std::int32_t>(random);
    if (random.below(2) == 0) grid.pick = any<std::int32_t>(random);
    if (random.below(2) == 0) grid.no_return = any<std::int32_t>(random);
    if (random.below(2) == 0) grid.longest_range_mm = any<float>(random);
    std::array<float, 64> ranges_m{};
    use(g4lidar_fill_grid(points.data(), count, &grid, ranges_m.data(), random.below(64)));
    use(g4lidar_grid_options_set_model(&grid, "x4"));
  });
}

TEST(ExtremeC, Shaper) {
  many_times(
      [](test::dice& random) {
        g4lidar_sector sector{any<double>(random), any<double>(random)};
        std::array<g4lidar_corner, 3> corners{};
        for (g4lidar_corner& each : corners) each = {any<float>(random), any<float>(random)};
        g4lidar_polygon mask{corners.data(), corners.size()};
        g4lidar_filter_options filter;
        g4lidar_filter_options_init(&filter, sizeof filter);
        filter.ignored_sectors = &sector;
        filter.ignored_sector_count = 1;
        filter.masks = &mask;
        filter.mask_count = 1;
        filter.field_of_view = {any<double>(random), any<double>(random)};
        filter.least_range_mm = any<float>(random);
        filter.greatest_range_mm = any<float>(random);
        g4lidar_near_options near;
        g4lidar_near_options_init(&near, sizeof near);
        near.shortest_mm = any<float>(random);
        near.revolutions = any<std::uint32_t>(random);
        g4lidar_shaper_options options;
        g4lidar_shaper_options_init(&options, sizeof options);
        options.filter = &filter;
        if (random.below(2) == 0) options.near_options = &near;
        g4lidar_outlier_options outliers;
        g4lidar_outlier_options_init(&outliers, sizeof outliers);
        if (random.below(4) == 0) outliers.window = any<std::uint32_t>(random);
        if (random.below(4) == 0) outliers.near_count = any<std::uint32_t>(random);
        if (random.below(4) == 0) outliers.near_m = any<float>(random);
        if (random.below(4) == 0) outliers.near_ratio = any<float>(random);
        if (random.below(4) == 0) outliers.edge_window = any<std::uint32_t>(random);
        if (random.below(4) == 0) outliers.least_angle_deg = any<float>(random);
        if (random.below(2) == 0) options.speckle = &outliers;
        if (random.below(2) == 0) options.edges = &outliers;
        const g4lidar_mounting mount{any_pose(random), any<bool>(random), {}};
        if (random.below(4) == 0) options.mount = &mount;
        options.deskew = static_cast<std::int32_t>(random.below(3));
        g4lidar_shaper* shaper = nullptr;
        if (g4lidar_shaper_create(&options, &shaper, nullptr) != G4LIDAR_OK) return;
        for (int i = 0; i < 3; ++i) {
          const auto points = any_points(random);
          const auto path = any_path(random);
          use(g4lidar_shaper_shape(shaper, points.data(), points.size(), any<bool>(random),
                                   path.data(), path.size()));
          std::size_t count = 0;
          use(g4lidar_shaper_kept(shaper, &count));
          use(g4lidar_shaper_for_grid(shaper, &count));
          use(g4lidar_shaper_outside(shaper));
        }
        g4lidar_shaper_free(shaper);
      },
      500);
}

TEST(ExtremeC, Estimator) {
  g4lidar_estimator* estimator = nullptr;
  ASSERT_EQ(g4lidar_estimator_create(&estimator, nullptr), G4LIDAR_OK);
  many_times(
      [&](test::dice& random) {
        const auto points = any_points(random);
        g4lidar_twist_estimate made;
        use(g4lidar_estimator_add_of_model(estimator, points.data(), points.size(), "tg30", &made));
      },
      300);
  g4lidar_estimator_free(estimator);
}

TEST(ExtremeC, Recordings) {
  many_times(
      [](test::dice& random) {
        const test::temporary_path file;
        g4lidar_recorder_options options;
        g4lidar_recorder_options_init(&options, sizeof options);
        if (random.below(4) == 0) options.rotate_bytes = any<std::uint64_t>(random);
        if (random.below(4) == 0) options.rotate_s = any<std::int32_t>(random);
        if (random.below(4) == 0) options.chunk_ms = any<std::int32_t>(random);
        if (random.below(4) == 0) options.scan_bins = any<std::uint32_t>(random);
        g4lidar_recorder* recorder = nullptr;
        if (g4lidar_recorder_create(file.text().c_str(), &options, &recorder, nullptr) !=
            G4LIDAR_OK)
          return;
        for (int i = 0; i < 5; ++i) {
          const std::array<std::uint8_t, 4> data{0xAA, 0x55, 0, 1};
          use(g4lidar_recorder_bytes(recorder, any<bool>(random), data.data(), data.size(),
                                     any<std::int64_t>(random)));
          const g4lidar_odometry odometry{
              any<std::int64_t>(random),
              any_pose(random),
              {any<double>(random), any<double>(random), any<double>(random)}};
          use(g4lidar_recorder_odometry(recorder, &odometry));
        }
        g4lidar_recorder_free(recorder);
        g4lidar_reader* reader = nullptr;
        if (g4lidar_reader_open(file.text().c_str(), &reader, nullptr) != G4LIDAR_OK) return;
        const g4lidar_item* item = nullptr;
        for (int i = 0; i < 12; ++i) {
          use(g4lidar_reader_next(reader, &item, nullptr));
          if (i % 4 == 3) use(g4lidar_reader_seek(reader, any<std::int64_t>(random), nullptr));
        }
        g4lidar_reader_free(reader);
        g4lidar_playback_options playback;
        g4lidar_playback_options_init(&playback, sizeof playback);
        playback.from_ns = any<std::int64_t>(random);
        playback.to_ns = any<std::int64_t>(random);
        playback.speed = any<double>(random);
        g4lidar_lidar* lidar = nullptr;
        if (g4lidar_open_recording(file.text().c_str(), &playback, nullptr, &lidar, nullptr) !=
            G4LIDAR_OK)
          return;
        use(g4lidar_set_speed(lidar, any<double>(random), nullptr));
        use(g4lidar_seek(lidar, any<std::int64_t>(random), nullptr));
        use(g4lidar_wall_ns(lidar, any<std::int64_t>(random)));
        g4lidar_free(lidar);
      },
      300);
}

class SimulatedLidar : public testing::Test {
 protected:
  void SetUp() override {
    g4lidar_simulator_options options;
    g4lidar_simulator_options_init(&options, sizeof options);
    options.virtual_time = true;
    ASSERT_EQ(g4lidar_simulator_create(&options, &simulator_, nullptr), G4LIDAR_OK);
    ASSERT_EQ(g4lidar_open_simulated(simulator_, nullptr, &lidar_, nullptr), G4LIDAR_OK);
  }
  void TearDown() override {
    g4lidar_free(lidar_);
    g4lidar_simulator_free(simulator_);
  }
  g4lidar_simulator* simulator_ = nullptr;
  g4lidar_lidar* lidar_ = nullptr;
};

TEST_F(SimulatedLidar, SettingsAndTimes) {
  for (const int number : values<int>()) {
    std::int32_t value = 0;
    use(g4lidar_get(lidar_, number, 0, &value, nullptr));
    use(g4lidar_set(lidar_, number, 1, 0, &value, nullptr));
    for (int setting = 1; setting < 8; ++setting) {
      use(g4lidar_get(lidar_, setting, number, &value, nullptr));
      use(g4lidar_set(lidar_, setting, number, 0, &value, nullptr));
    }
    use(g4lidar_step_frequency(lidar_, number, 0, &value, nullptr));
    use(g4lidar_restart(lidar_, number, nullptr));
    g4lidar_health health;
    use(g4lidar_get_health(lidar_, number, &health, nullptr));
    use(g4lidar_result_name(number));
    use(g4lidar_event_name(number));
  }
  ASSERT_EQ(g4lidar_start(lidar_, nullptr), G4LIDAR_OK);
  for (const int timeout_ms : values<int>()) {
    const g4lidar_scan* scan = nullptr;
    const g4lidar_point* points = nullptr;
    std::size_t count = 0;
    use(g4lidar_try_scan(lidar_, timeout_ms, &scan, nullptr));
    use(g4lidar_wait_scan(lidar_, timeout_ms, &scan, nullptr));
    use(g4lidar_next_points(lidar_, timeout_ms, &points, &count, nullptr));
  }
  for (const std::int64_t time_ns : values<std::int64_t>()) use(g4lidar_wall_ns(lidar_, time_ns));
  std::array<g4lidar_truth, 4> truth{};
  std::size_t count = 0;
  g4lidar_odometry odometry;
  use(g4lidar_simulator_next_odometry(simulator_, &odometry));
  use(g4lidar_simulator_take_truth(simulator_, truth.data(), truth.size(), &count));
}

TEST_F(SimulatedLidar, EndOfTime) {
  EXPECT_EQ(g4lidar_simulator_advance(simulator_, -1), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_simulator_advance(simulator_, most_ns), G4LIDAR_OK);
  EXPECT_EQ(g4lidar_simulator_advance(simulator_, most_ns), G4LIDAR_OK);
  use(g4lidar_simulator_get_state(simulator_)->time_ns);
  use(g4lidar_start(lidar_, nullptr));
  use(g4lidar_deadline_ns(lidar_));
  use(g4lidar_poll_timeout_ms(lidar_));
}

TEST(ExtremeC, Indices) {
  g4lidar_find_options find;
  g4lidar_find_options_init(&find, sizeof find);
  g4lidar_ports* ports = nullptr;
  EXPECT_EQ(g4lidar_list_ports(&find, &ports, nullptr), G4LIDAR_OK);
  for (const std::size_t index : values<std::size_t>()) {
    EXPECT_TRUE(index < g4lidar_ports_count(ports) || g4lidar_ports_at(ports, index) == nullptr);
  }
  g4lidar_ports_free(ports);
}

TEST(ExtremeC, Background) {
  const test::temporary_path file;
  g4lidar_recorder* recorder = nullptr;
  ASSERT_EQ(g4lidar_recorder_create(file.text().c_str(), nullptr, &recorder, nullptr), G4LIDAR_OK);
  const std::array<std::uint8_t, 4> data{0xAA, 0x55, 0, 1};
  for (const std::int64_t time_ns : {std::int64_t{1}, most_ns}) {
    use(g4lidar_recorder_bytes(recorder, false, data.data(), data.size(), time_ns));
  }
  g4lidar_recorder_free(recorder);
  g4lidar_lidar* lidar = nullptr;
  ASSERT_EQ(g4lidar_open_recording(file.text().c_str(), nullptr, nullptr, &lidar, nullptr),
            G4LIDAR_OK);
  g4lidar_background* reader = nullptr;
  ASSERT_EQ(g4lidar_background_start(lidar, true, &reader, nullptr), G4LIDAR_OK);
  for (const double speed : values<double>())
    use(g4lidar_background_set_speed(reader, speed, nullptr));
  for (const std::int64_t position_ns : values<std::int64_t>())
    use(g4lidar_background_seek(reader, position_ns));
  const g4lidar_scan* scan = nullptr;
  use(g4lidar_background_next_scan(reader, std::numeric_limits<int>::min(), &scan, nullptr));
  g4lidar_background_free(reader);
  g4lidar_free(lidar);
}

TEST(ExtremeC, Options) {
  many_times(
      [](test::dice& random) {
        g4lidar_options options;
        g4lidar_options_init(&options, sizeof options);
        options.device = "/dev/nosuch-port";
        std::int32_t* const numbers[]{&options.frequency_chz,
                                      &options.sample_rate_hz,
                                      &options.direction,
                                      &options.low_power,
                                      &options.constant_frequency,
                                      &options.protection,
                                      &options.pace,
                                      &options.longest_backoff_ms,
                                      &options.answer_time_ms,
                                      &options.stall_time_ms,
                                      &options.batch_ms};
        *numbers[random.below(std::size(numbers))] = any<std::int32_t>(random);
        if (random.below(2) == 0) options.transport_delay_ns = any<std::int64_t>(random);
        options.baud = any<std::uint32_t>(random);
        g4lidar_lidar* lidar = nullptr;
        EXPECT_NE(g4lidar_open_with(&options, &lidar, nullptr), G4LIDAR_OK);
      },
      500);
}

}  // namespace
