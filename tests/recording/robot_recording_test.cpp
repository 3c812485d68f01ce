// SPDX-License-Identifier: MIT
// What a recording contains of the robot and for SLAM: odometry, the transform of the lidar, points, scans in both
// orders.
#include <gtest/gtest.h>

#include <cmath>

#include "made_recording.hpp"
#include "recorded_run.hpp"
#include "recording/mcap/channels.hpp"
#include "recording/mcap/mcap_file.hpp"
#include "support/cdr_reader.hpp"
#include "support/mcap_messages.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

stamped_odometry odometry_at(std::int64_t time_ns) {
  const double seconds = static_cast<double>(time_ns) / 1e9;
  return {time_ns, {seconds, -2.0 * seconds, std::remainder(seconds, 6.0)}, {1.0, -2.0, 1.0}};
}

/// Readings with odometry between, `early_ns` before the times of the readings.
void record_robot(recording_writer& into, std::uint32_t count, std::int64_t early_ns = 3 * ms) {
  for (std::uint32_t i = 0; i < count; ++i) {
    into.from_device(reading(i), time_of(i));
    into.odometry(odometry_at(time_of(i) - early_ns));
  }
}

std::vector<stamped_odometry> odometry_of(const std::string& path,
                                          const reading_options& how = {}) {
  std::vector<stamped_odometry> all;
  auto reader = recording_reader::open(path, how);
  EXPECT_TRUE(reader);
  EXPECT_TRUE(!reader || reader->for_each([&](const recorded_item& item) {
    if (item.what == recorded_item::kind::odometry) {
      EXPECT_EQ(item.time_ns, item.odometry.time_ns);
      EXPECT_EQ(item.wall_ns, item.time_ns + wall_ahead_ns);
      all.push_back(item.odometry);
    }
    return true;
  }));
  return all;
}

void expect_odometry(const std::vector<stamped_odometry>& got, std::uint32_t first,
                     std::uint32_t count) {
  ASSERT_EQ(got.size(), count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const stamped_odometry wanted = odometry_at(time_of(first + i) - 3 * ms);
    ASSERT_EQ(got[i].time_ns, wanted.time_ns);
    EXPECT_EQ(got[i].pose.x_m, wanted.pose.x_m);
    EXPECT_EQ(got[i].pose.y_m, wanted.pose.y_m);
    EXPECT_NEAR(got[i].pose.yaw_rad, wanted.pose.yaw_rad, 1e-15);
    EXPECT_EQ(got[i].twist, wanted.twist);
  }
}

std::string text_of(const std::string& path) {
  const auto file = bytes_of(path);
  return {file.begin(), file.end()};
}

TEST(RobotRecording, ReturnsTheOdometry) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  writer.odometry(odometry_at(begin_ns));  // too early
  record_robot(writer, 300);
  ASSERT_TRUE(writer.close());
  EXPECT_EQ(writer.counts().odometry, 300U);
  expect_odometry(odometry_of(path.text()), 0, 300);
  EXPECT_EQ(contents_of_file(path.text()).readings, numbers(0, 300));
  auto reader = recording_reader::open(path.text());
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->first_ns(), time_of(0)) << "not that of the odometry before";
  EXPECT_EQ(reader->last_ns(), time_of(299));
}

TEST(RobotRecording, RangeOfARecordingHasItsOdometry) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_robot(writer, 1000);
  writer.odometry(odometry_at(time_of(5000)));
  ASSERT_TRUE(writer.close());
  expect_odometry(odometry_of(path.text(), {.from_ns = 2 * second, .to_ns = 4 * second}), 201, 200);
}

/// Odometry far ahead neither ends a chunk nor a reader's range.
TEST(RobotRecording, OdometryOfAnyTime_ChangesNothingElse) {
  const temporary_path path;
  auto writer = made_writer(path.text(), {.rotate_time = 100s});
  for (std::uint32_t i = 0; i < 200; ++i) {
    writer.from_device(reading(i), time_of(i));
    writer.odometry(odometry_at(i % 2 == 0 ? time_of(5'000'000) : time_of(0) - 3600 * second));
  }
  writer.odometry({.pose = {0.0, std::nan(""), 0.0}});
  ASSERT_TRUE(writer.close());
  EXPECT_EQ(writer.counts().odometry, 200U) << "without the one that is not a number";
  EXPECT_EQ(writer.counts().files, 1U);
  EXPECT_LE(writer.counts().chunks, 6U);
  EXPECT_EQ(contents_of_file(path.text(), {.to_ns = second}).readings, numbers(0, 100));
  auto reader = recording_reader::open(path.text());
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->last_ns(), time_of(199));
}

/// A file with messages that `put` writes on the topic of odometry, each before a reading.
template <class Put>
std::vector<std::uint8_t> file_with_odometry(Put put) {
  using namespace mcap;
  channel_set channels;
  channels.add(channel_id::odometry);
  record_text file;
  file.put(bytes(magic));
  open_chunk chunk;
  channels.put_channels(chunk.text());
  for (std::uint32_t i = 0; i < 100; ++i) {
    chunk.begin_message(channel_id::odometry, i, time_of(i) + wall_ahead_ns);
    put(chunk.text().memory(), i);
    chunk.end_message();
    chunk.begin_message(channel_id::from_device, i, time_of(i) + wall_ahead_ns);
    put_recorded_bytes(chunk.text(), reading(i), time_of(i));
    chunk.end_message();
  }
  const std::size_t record = file.begin(opcode::chunk);
  file.put(chunk.first_ns());
  file.put(chunk.last_ns());
  file.put(static_cast<std::uint64_t>(chunk.records().size()));
  file.put(std::uint32_t{0});
  file.put("");
  file.put(static_cast<std::uint64_t>(chunk.records().size()));
  file.put(chunk.records());
  file.end(record);
  return {file.all().begin(), file.all().end()};
}

/// Messages that are no odometry, on the topic of odometry: of another program, or damaged.
TEST(RobotRecording, ForeignOdometry_IsNotReturned) {
  const auto file = file_with_odometry([](std::vector<std::uint8_t>& out, std::uint32_t i) {
    const auto other = reading(i);
    if (i % 4 == 3) return void(out.insert(out.end(), other.begin(), other.end()));
    const double impossible = i % 2 == 0 ? -1e7 : std::nan("");
    put_odometry({.stamp_ns = time_of(i) + wall_ahead_ns, .pose = {impossible, 0, 0}}, out);
  });
  const contents found = contents_of_bytes(file);
  EXPECT_EQ(found.readings, numbers(0, 100));
  EXPECT_EQ(found.gaps, 0U);
  EXPECT_EQ(found.odometry, 0U);
}

/// In a chunk of a damaged file, or in a file that another program has sorted, odometry may be first: the clocks are known
/// from what follows.
TEST(RobotRecording, OdometryBeforeAllElse_HasItsTime) {
  const auto file = file_with_odometry([](std::vector<std::uint8_t>& out, std::uint32_t i) {
    put_odometry({.stamp_ns = time_of(i) - 3 * ms + wall_ahead_ns}, out);
  });
  auto reader = recording_access::open(std::make_shared<memory_source>(file), "memory", {});
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->first_ns(), time_of(0)) << "not that of the odometry before";
  const auto first = reader->next();
  ASSERT_TRUE(first && *first);
  EXPECT_EQ((*first)->what, recorded_item::kind::odometry);
  EXPECT_EQ((*first)->odometry.time_ns, time_of(0) - 3 * ms);
  const contents rest = contents_of(*reader);
  EXPECT_EQ(rest.readings, numbers(0, 100));
  EXPECT_EQ(rest.gaps, 0U);
}

TEST(RobotRecording, RecordedAgain_KeepsTheOdometry) {
  const temporary_path first;
  const temporary_path second_path;
  auto writer = made_writer(first.text());
  record_robot(writer, 300);
  ASSERT_TRUE(writer.close());
  auto again = recording_writer::create(second_path.text());
  ASSERT_TRUE(again);
  auto played = replay::open(first.text());
  ASSERT_TRUE(played);
  auto both = recorded(std::move(*played), *again);
  ASSERT_TRUE(both);
  static_cast<void>(replayed(std::move(*both)));
  ASSERT_TRUE(again->close());
  expect_odometry(odometry_of(second_path.text()), 0, 300);
  EXPECT_EQ(again->digest().payload, writer.digest().payload);
}

/// A channel that is added later: readers need its schema before it.
TEST(RobotRecording, SchemaOfOdometry_IsBeforeItsChannel) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_robot(writer, 100);
  ASSERT_TRUE(writer.close());
  const std::string text = text_of(path.text());
  EXPECT_LT(text.find("nav_msgs/msg/Odometry"), text.find("/odom"));
  EXPECT_NE(text.find("/odom"), std::string::npos);
}

/// Only what is used is in a file.
TEST(RobotRecording, ChannelsThatAreNotUsed_AreNotThere) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_readings(writer, 0, 100);
  ASSERT_TRUE(writer.close());
  const std::string text = text_of(path.text());
  for (const std::string name : {"/odom", "/points", "/tf_static", "PointCloud2", "nav_msgs"}) {
    EXPECT_EQ(text.find(name), std::string::npos) << name;
  }
}

/// The rotation's columns, of a quaternion x, y, z, w that is read next.
std::pair<std::array<double, 2>, double> x_axis_and_up(cdr_reader& read) {
  const auto x = read.number<double>();
  const auto y = read.number<double>();
  const auto z = read.number<double>();
  const auto w = read.number<double>();
  return {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w)}, 1 - 2 * (x * x + y * y)};
}

TEST(RobotRecording, EachFileBeginsWithTheTransform) {
  for (const bool down : {false, true}) {
    for (const scan_order order : {scan_order::angle, scan_order::time}) {
      const temporary_path path;
      auto writer = made_writer(path.text(), {.rotate_time = 2s,
                                              .frame_id = "front",
                                              .order = order,
                                              .mount = mounting{{0.1, -0.2, 0.5}, down},
                                              .robot_frame_id = "robot"});
      record_robot(writer, 500);
      ASSERT_TRUE(writer.close());
      ASSERT_GE(writer.counts().files, 2U);
      for (int i = 0; i < static_cast<int>(writer.counts().files); ++i) {
        const std::string name = i == 0 ? path.text() : path.next(i);
        const auto found = mcap_messages(text_of(name), "/tf_static");
        ASSERT_EQ(found.size(), 1U) << name;
        cdr_reader read(found[0]);
        EXPECT_EQ(read.number<std::uint32_t>(), 1U);
        EXPECT_GE(read.number<std::int32_t>(), 1'700'000'000);
        static_cast<void>(read.number<std::uint32_t>());
        EXPECT_EQ(read.text(), "robot");
        EXPECT_EQ(read.text(), "front");
        EXPECT_EQ(read.number<double>(), 0.1);
        EXPECT_EQ(read.number<double>(), -0.2);
        EXPECT_EQ(read.number<double>(), 0.0);
        const auto [x_axis, up] = x_axis_and_up(read);
        EXPECT_NEAR(x_axis[0], std::cos(0.5), 1e-12);
        EXPECT_NEAR(x_axis[1], std::sin(0.5), 1e-12);
        EXPECT_NEAR(up, down != (order == scan_order::time) ? -1.0 : 1.0, 1e-12);
        EXPECT_FALSE(mcap_messages(text_of(name), "/odom").empty());
        EXPECT_FALSE(contents_of_file(name).damage.any());
      }
    }
  }
}

struct header {
  std::int64_t stamp_ns;
  std::string frame;
};
header header_of(cdr_reader& read) {
  const std::int64_t seconds = read.number<std::int32_t>();
  const std::int64_t rest_ns = read.number<std::uint32_t>();
  return {seconds * second + rest_ns, read.text()};
}

/// The stamps are those of the first ray; ranges and points are those of the revolution.
TEST(RobotRecording, ScansAndPoints_InBothOrders) {
  for (const scan_order order : {scan_order::angle, scan_order::time}) {
    const temporary_path path;
    auto writer = made_writer(
        path.text(), {.frame_id = "front", .order = order, .points_topic = "/front/points"});
    virtual_bench bench;
    auto device = lidar::open(std::make_unique<virtual_connector>(bench));
    ASSERT_TRUE(device);
    ASSERT_TRUE(device->start());
    std::vector<std::vector<point>> scans;
    std::vector<std::int64_t> durations;
    while (scans.size() < 5) {
      const auto found = device->try_scan(1000ms);
      if (!found || bench.now_ns < 3 * second)
        continue;  // until the motor turns at a constant speed
      writer.scan(*found);
      scans.emplace_back(found->points.begin(), found->points.end());
      durations.push_back(found->duration_ns);
    }
    ASSERT_TRUE(writer.close());
    const auto messages = mcap_messages(text_of(path.text()), "/scan");
    const auto clouds = mcap_messages(text_of(path.text()), "/front/points");
    ASSERT_EQ(messages.size(), scans.size());
    ASSERT_EQ(clouds.size(), scans.size());
    for (std::size_t i = 0; i < scans.size(); ++i) {
      cdr_reader scan(messages[i]);
      const header of = header_of(scan);
      EXPECT_EQ(of.stamp_ns, scans[i].front().time_ns + wall_ahead_ns);
      EXPECT_EQ(of.frame, "front");
      const auto least = scan.number<float>();
      static_cast<void>(scan.number<float>());
      const auto step = scan.number<float>();
      const auto time_step = static_cast<double>(scan.number<float>());
      for (int skipped = 0; skipped < 3; ++skipped) static_cast<void>(scan.number<float>());
      ASSERT_EQ(scan.number<std::uint32_t>(), 720U);
      const bool is_by_time = order == scan_order::time;
      EXPECT_NEAR(time_step * 720, is_by_time ? static_cast<double>(durations[i]) / 1e9 : 0.0,
                  1e-6);
      std::size_t returns = 0;
      for (std::size_t bin = 0; bin < 720; ++bin) {
        const auto range = scan.number<float>();
        if (!std::isfinite(range)) continue;
        ++returns;
        // A point of the revolution is there: at this angle, with z down to the other side, and at this time.
        const double angle =
            static_cast<double>(least) + static_cast<double>(step * static_cast<float>(bin));
        const double native = is_by_time ? angle - 3.14159265 : 3.14159265 - angle;
        const bool is_there = std::ranges::any_of(scans[i], [&](const point& p) {
          const double off =
              std::remainder(static_cast<double>(p.angle_deg) - native / 3.14159265 * 180.0, 360.0);
          const double late_s = static_cast<double>(p.time_ns - scans[i].front().time_ns) / 1e9 -
                                time_step * static_cast<double>(bin);
          const bool is_in_time = !is_by_time || std::abs(late_s) < 4.0 / 360.0 / 7.0;
          return p.range_mm * 0.001F == range && std::abs(off) < 0.2501 && is_in_time;
        });
        EXPECT_TRUE(is_there) << bin << ' ' << range;
      }
      EXPECT_GT(returns, 500U);
      cdr_reader cloud(clouds[i]);
      EXPECT_EQ(header_of(cloud).stamp_ns, of.stamp_ns);
      EXPECT_EQ(cloud.number<std::uint32_t>(), 1U);
      EXPECT_EQ(cloud.number<std::uint32_t>(),
                std::ranges::count_if(scans[i], [](const point& p) { return !p.is_no_return(); }));
    }
  }
}

TEST(RobotRecording, PointsWithoutScans) {
  const temporary_path path;
  auto writer = made_writer(path.text(), {.scans = false, .points_topic = "/points"});
  std::vector<point> points(3);
  for (point& p : points) p = {.angle_deg = 10.0F, .range_mm = 1000.0F, .time_ns = begin_ns};
  writer.scan({.points = points, .duration_ns = 100});
  ASSERT_TRUE(writer.close());
  EXPECT_EQ(writer.counts().scans, 0U);
  EXPECT_TRUE(mcap_messages(text_of(path.text()), "/scan").empty());
  EXPECT_EQ(mcap_messages(text_of(path.text()), "/points").size(), 1U);
}

}  // namespace
}  // namespace g4lidar::test
