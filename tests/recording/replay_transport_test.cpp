// SPDX-License-Identifier: MIT
// A recording as a transport: its speed, its rounds, its end, and the driver's handling of missing
// data.
#include <gtest/gtest.h>
#include <poll.h>

#include <array>
#include <thread>

#include "g4lidar/recording/reader.hpp"
#include "made_recording.hpp"
#include "recorded_run.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

std::unique_ptr<transport> port_of(const std::string& path, const playback_options& how = {}) {
  auto found = replay::open(path, how);
  if (!found) {
    ADD_FAILURE() << found.error().message();
    return nullptr;
  }
  // Its transport continues without it.
  auto port = (*found)->connect();
  EXPECT_TRUE(port);
  return std::move(*port);
}

bool is_readable(int handle) {
  pollfd waits{handle, POLLIN, 0};
  return ::poll(&waits, 1, 0) == 1;
}

TEST(ReplayTransport, OpensByItsPathLikeADevice) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
    record_device(writer, 4 * second);
  }
  for (const std::string& name : {path.text(), "file:" + path.text()}) {
    auto device = lidar::open(name);
    ASSERT_TRUE(device) << device.error().message();
    EXPECT_EQ(device->information().serial_number(), "2021101000070073");
    EXPECT_EQ(device->name(), path.text());
    EXPECT_GE(device->event_loop().native_handle(), 0);
    const auto asked = device->ask(requests::health());
    ASSERT_FALSE(asked);
    EXPECT_EQ(asked.error().code(), problem::read_only);
    ASSERT_TRUE(device->start());
    const auto scan = device->try_scan(3000ms);
    ASSERT_TRUE(scan) << scan.error().message();
    EXPECT_GT(scan->points.size(), 1000U);
  }
}

TEST(ReplayTransport, FindsTheDeviceInTheBytes) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
    record_device(writer, 2 * second, false);
  }
  auto device = lidar::open(path.text());
  ASSERT_TRUE(device) << device.error().message();
  EXPECT_EQ(device->information().serial_number(), "2021101000070073");
}

TEST(ReplayTransport, End_IsFinal) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
    record_device(writer, 3 * second);
  }
  auto device = lidar::open(path.text());
  ASSERT_TRUE(device) << device.error().message();
  ASSERT_TRUE(device->start());
  result<scan> found = device->try_scan(500ms);
  int scans = 0;
  while (found || !found.error().is_fatal()) {
    if (found) ++scans;
    found = device->try_scan(500ms);
  }
  EXPECT_EQ(found.error().code(), problem::end_of_input);
  EXPECT_GE(scans, 8);
}

TEST(ReplayTransport, FileOfBytes_IsParsedCompletely) {
  const temporary_path full;
  const temporary_path bare;
  {
    auto writer = made_writer(full.text());
    record_device(writer, 4 * second);
    ASSERT_TRUE(writer.close());
    auto reader = recording_reader::open(full.text());
    auto other = made_writer(bare.text());
    while (const auto item = *reader->next()) {
      if (item->what == recorded_item::kind::from_device) {
        other.from_device(item->data, item->time_ns);
      }
    }
  }
  const run_result one = replayed(std::move(*replay::open(full.text())));
  const run_result other = replayed(std::move(*replay::open(bare.text())));
  // Bytes that were received during a stop are also included.
  EXPECT_GE(other.points.size(), one.points.size());
  EXPECT_LE(other.points.size(), one.points.size() + 2000);
  EXPECT_GE(other.counts.scans, one.counts.scans);
}

TEST(ReplayTransport, ReportsLossesAndReconnects) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  const auto faults = faults_of({"unplug@3s+1s"});
  virtual_bench bench({}, faults);
  lidar_options options;
  options.reconnect = true;
  auto from = recorded(std::make_unique<virtual_connector>(bench), writer);
  {
    auto device = lidar::open(std::move(*from), options);
    ASSERT_TRUE(device) << device.error().message();
    ASSERT_TRUE(device->start());
    while (bench.now_ns < 8 * second) static_cast<void>(device->try_scan(100ms));
  }
  ASSERT_TRUE(writer.close());
  const run_result run = replayed(std::move(*replay::open(path.text())));
  const std::vector wanted{lidar_event::kind::lost, lidar_event::kind::reconnected,
                           lidar_event::kind::lost};  // the last one is its end
  EXPECT_EQ(run.events, wanted);
  EXPECT_EQ(run.counts.reconnects, 1U);
}

TEST(ReplayTransport, Gap_IsPassedOver) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
    record_device(writer, 6 * second);
  }
  const run_result whole = replayed(std::move(*replay::open(path.text())));
  auto file = bytes_of(path.text());
  file[file.size() / 2] ^= 0x10;
  {
    std::ofstream out(path.text(), std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(file.data()),
              static_cast<std::streamsize>(file.size()));
  }
  const run_result damaged = replayed(std::move(*replay::open(path.text())));
  EXPECT_LT(damaged.points.size(), whole.points.size());
  // A chunk: half a second, and one read, of up to 90 ms where only scans are taken.
  EXPECT_GE(damaged.points.size() + 5400, whole.points.size());
  EXPECT_NEAR(static_cast<double>(damaged.points.back().time_ns),
              static_cast<double>(whole.points.back().time_ns), 1e6);
}

TEST(ReplayTransport, Repeated_BeginsLaterThanItEnded) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
    record_readings(writer, 0, 100);
  }
  const auto port = port_of(path.text(), {.loop = true});
  std::array<std::uint8_t, 200> out{};
  std::int64_t last_ns = 0;
  for (std::uint32_t i = 0; i < 350; ++i) {
    const auto got = port->read(out, never_ns);
    ASSERT_TRUE(got) << got.error().message();
    EXPECT_TRUE(std::ranges::equal(bytes(out).first(got->count), reading(i % 100)));
    EXPECT_GT(got->arrival_ns, last_ns);
    EXPECT_EQ(port->now_ns(), got->arrival_ns);
    last_ns = got->arrival_ns;
  }
}

TEST(ReplayTransport, AsFastAsAsked_IsAlwaysReadable) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
    record_readings(writer, 0, 2);
  }
  const auto port = port_of(path.text());
  std::array<std::uint8_t, 200> out{};
  EXPECT_TRUE(is_readable(port->native_handle()));
  EXPECT_TRUE(port->read(out, 0));
  EXPECT_TRUE(is_readable(port->native_handle()));
  EXPECT_TRUE(port->read(out, 0));
  const auto end = port->read(out, 0);
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().code(), problem::end_of_input);
}

TEST(ReplayTransport, RecordedSpeed_BytesArriveWhenTheyAreDue) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
    record_readings(writer, 1, 2);
  }
  const auto port =
      port_of(path.text(), {.speed = 1e-5});  // the second one is due in a quarter of an hour
  std::array<std::uint8_t, 200> out{};
  const auto first = port->read(out, never_ns);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->arrival_ns, time_of(1));
  EXPECT_FALSE(is_readable(port->native_handle()));
  const auto none = port->read(out, port->now_ns() + 10);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->count, 0U);
  std::thread waker([&] { port->wake(); });
  const auto woken = port->read(out, never_ns);
  waker.join();
  ASSERT_FALSE(woken);
  EXPECT_EQ(woken.error().code(), problem::cancelled);
}

TEST(ReplayTransport, AtItsOwnRate_TakesItsTime) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
    record_readings(writer, 0, 101);
  }
  const auto begin = std::chrono::steady_clock::now();
  const auto port = port_of(path.text(), {.speed = 10});
  std::array<std::uint8_t, 200> out{};
  int count = 0;
  while (const auto got = port->read(out, never_ns)) count += got->count > 0 ? 1 : 0;
  EXPECT_EQ(count, 101);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 95ms);
}

TEST(ReplayTransport, InvalidOptions_AreRefused) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
    record_readings(writer, 0, 2);
  }
  const auto refused = [&](const playback_options& how) {
    const auto made = replay::open(path.text(), how);
    return !made && made.error() == problem::bad_option;
  };
  EXPECT_TRUE(refused({.speed = -1}));
  EXPECT_TRUE(refused({.speed = 1001}));
  EXPECT_TRUE(refused({.speed = 1e-7}));
  EXPECT_TRUE(refused({.speed = std::numeric_limits<double>::denorm_min()}));
  EXPECT_TRUE(refused({.speed = std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_TRUE(refused({.from_ns = 5, .to_ns = 5}));
  EXPECT_FALSE(refused({}));
}

}  // namespace
}  // namespace g4lidar::test
