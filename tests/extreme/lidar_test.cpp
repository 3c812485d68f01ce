// SPDX-License-Identifier: MIT
// Recordings of scans at any time, played; and the durations that callers give.
#include <array>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/time_limit.hpp"
#include "g4lidar/background_reader.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/motion/odometry_feed.hpp"
#include "g4lidar/recording/contents.hpp"
#include "g4lidar/recording/player.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "numbers.hpp"
#include "recording/recorded_run.hpp"
#include "transport/tcp_port.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::extreme;
using namespace std::chrono_literals;

static_assert(limited_ns(std::chrono::milliseconds::max()) == 365LL * 24 * 3600 * 1'000'000'000);
static_assert(limited_ns(std::chrono::nanoseconds::max()) == 365LL * 24 * 3600 * 1'000'000'000);
static_assert(limited_ns(std::chrono::milliseconds::min()) == 0);
static_assert(limited_ns(7ms) == 7'000'000);

void record(const std::string& path, test::dice& random) {
  recording_options how;
  how.rotate_time = std::chrono::seconds(0);
  how.overwrite = true;
  how.points_topic = "/points";
  how.mount = mounting{.pose = {1e6, -1e6, 1e6}};
  auto writer = recording_writer::create(path, how);
  ASSERT_TRUE(writer) << writer.error().message();
  writer->set_wall_clock(any<std::int64_t>(random));
  sim::scanner scanner(sim::built_in_world(), {.start_deg = 0.0});
  writer->event({.what = recorded_event::kind::begun,
                 .sample_rate_hz = random.below(2) == 0 ? 9000U : any<std::uint32_t>(random),
                 .time_ns = 1});
  for (int i = 0; i < 80; ++i) {
    const auto packet = scanner.next();
    const bool is_usual = random.below(4) != 0;
    const std::int64_t time_ns = is_usual ? packet.complete_ns : any<std::int64_t>(random);
    writer->from_device(packet.data, time_ns);
    if (random.below(16) == 0)
      writer->to_device(std::array<std::uint8_t, 2>{0xA5, 0x60}, any<std::int64_t>(random));
    if (random.below(16) == 0) writer->odometry(any<stamped_odometry>(random));
    if (random.below(16) == 0) {
      writer->event({.what = any<recorded_event::kind>(random),
                     .baud = any<std::uint32_t>(random),
                     .sample_rate_hz = any<std::uint32_t>(random),
                     .unparsed = any<std::uint32_t>(random),
                     .events = any<std::uint32_t>(random),
                     .time_ns = any<std::int64_t>(random)});
    }
    if (random.below(16) == 0) {
      const std::vector<point> points = several<point>(random, 20);
      scan revolution;
      revolution.points = points;
      revolution.duration_ns = any<std::int64_t>(random);
      writer->scan(revolution);
      writer->points(points);
    }
  }
  use(writer->close().has_value());
}

TEST(ExtremeLidar, RecordingsOfAnyTime) {
  many_times(
      [](test::dice& random) {
        const test::temporary_path file;
        record(file.text(), random);
        const reading_options part{any<std::int64_t>(random), any<std::int64_t>(random)};
        if (auto reader = recording_reader::open(file.text(), part)) {
          use(reader
                  ->for_each([](const recorded_item& item) {
                    use(item.time_ns);
                    return true;
                  })
                  .has_value());
          use(reader->last_ns());
        }
        auto opened = lidar::open(
            file.text(),
            {.playback = {.from_ns = random.below(2) == 0 ? 0 : any<std::int64_t>(random)}});
        if (!opened) return;
        use(opened->start().has_value());
        odometry_feed feed;
        use(feed.load_recording(file.text()).has_value());
        for (int i = 0; i < 60; ++i) {
          if (player* const played = opened->player(); played != nullptr && i % 10 == 5) {
            if (feed.is_known()) feed.follow(*played);
            use(played->seek(any<std::int64_t>(random)).has_value());
            EXPECT_FALSE(played->set_speed(std::numeric_limits<double>::quiet_NaN()));
            EXPECT_FALSE(played->set_speed(-1.0));
            use(played->position_ns() + 0);
            use(played->length_ns());
            use(played->wall_ns(any<std::int64_t>(random)));
          }
          const auto got = opened->try_scan(0ms);
          if (got) {
            use(got->end_ns());
            feed.follow(got->points, [](const stamped_odometry& what) { use(what); });
          } else if (got.error().is_fatal()) {
            break;
          }
        }
        use(opened->counts());
      },
      60);
}

TEST(ExtremeLidar, Playback) {
  const test::temporary_path file;
  test::dice random(3);
  record(file.text(), random);
  for (const double speed : values<double>()) {
    const auto opened = replay::open(file.text(), {.speed = speed});
    const bool is_possible = speed == 0.0 || (speed >= 1e-6 && speed <= 1000.0);
    EXPECT_EQ(opened.has_value(), is_possible) << speed;
  }
}

// A time that is longer than all times is one, and a time below 0 is none.
TEST(ExtremeLidar, Durations) {
  using std::chrono::milliseconds;
  for (const milliseconds wait : values<milliseconds>()) {
    const auto refused = tcp_port::open("127.0.0.1:1", {.connect_timeout = wait});
    EXPECT_FALSE(refused);
    auto closed = lidar::open("/dev/nosuch-port", {.tuning = {.answer_time = wait}});
    EXPECT_FALSE(closed);
    scan_loop loop(wait);
    use(loop);
  }
  EXPECT_FALSE(lidar::open("/dev/nosuch-port", {.device_wait = milliseconds::min()}));
}

// Deadlines at a port: what is over is over, and what never comes ends with the device.
TEST(ExtremeLidar, Deadlines) {
  for (const std::int64_t deadline_ns : values<std::int64_t>()) {
    sim::device device{sim::world{}};
    sim::virtual_clock clock;
    sim::virtual_port port(device, clock);
    std::array<std::uint8_t, 64> out{};
    if (deadline_ns < 1'000'000'000) use(port.read(out, deadline_ns).has_value());
    use(port.write(std::array<std::uint8_t, 2>{0xA5, 0x90}, deadline_ns).has_value());
    use(search(port, deadline_ns).has_value());
    use(port.pause(deadline_ns).has_value());
  }
}

TEST(ExtremeLidar, RawBytes) {
  const test::temporary_path file(".bin");
  std::ofstream(file.text()) << "\xAA\x55 no packet";
  for (const std::uint32_t rate_hz : values<std::uint32_t>()) {
    const auto opened = open_raw_bytes(file.text(), rate_hz);
    EXPECT_EQ(opened.has_value(), rate_hz >= 1 && rate_hz <= 1'000'000) << rate_hz;
  }
  for (const std::int64_t time_ns : values<std::int64_t>()) {
    const auto opened = open_raw_bytes(file.text(), 9000, {.from_ns = time_ns, .to_ns = time_ns});
    if (!opened) continue;
    auto transport = (*opened)->connect();
    std::array<std::uint8_t, 64> out{};
    if (transport) use((*transport)->read(out, time_ns).has_value());
    if (auto* const hook = recording_hook_of(**opened);
        hook != nullptr && hook->events() != nullptr) {
      use(hook->events()->deadline_after_ns(time_ns));
      use(hook->events()->recorded_ns(time_ns));
    }
  }
}

TEST(ExtremeLidar, TimeoutsOfAReader) {
  auto opened = lidar::open("sim:");
  ASSERT_TRUE(opened) << opened.error().message();
  auto reader = background_reader::start(std::move(*opened));
  ASSERT_TRUE(reader) << reader.error().message();
  use(reader->next_scan(lidar::milliseconds::min()).has_value());
  EXPECT_TRUE(reader->next_scan(lidar::milliseconds::max()));
}

TEST(ExtremeLidar, Timeouts) {
  auto opened = lidar::open("sim:");
  ASSERT_TRUE(opened) << opened.error().message();
  ASSERT_TRUE(opened->start());
  EXPECT_FALSE(opened->try_scan(lidar::milliseconds::min()));
  use(opened->next_points(lidar::milliseconds::min()).has_value());
  EXPECT_TRUE(opened->try_scan(lidar::milliseconds::max()));
  auto none = opened->scans(lidar::milliseconds::min());
  EXPECT_EQ(none.begin(), none.end());
  auto all = opened->scans(lidar::milliseconds::max());
  EXPECT_NE(all.begin(), all.end());
  EXPECT_TRUE(opened->wait_scan(lidar::milliseconds::max()));
  scan_loop loop(lidar::milliseconds::max());
  use(loop.wait(*opened, lidar::milliseconds::max()).has_value());
  use(loop.left(*opened));
  for (const request_kind what : values<request_kind>()) {
    if (what == request_kind::restart || what == request_kind::stop) continue;
    use(opened->ask(request{what, 65'535}).has_value());
  }
}

}  // namespace
