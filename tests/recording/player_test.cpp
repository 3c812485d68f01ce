// SPDX-License-Identifier: MIT
// The player of a lidar that plays a file.
#include "g4lidar/recording/player.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <fstream>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/transport/transport.hpp"
#include "made_recording.hpp"
#include "recorded_run.hpp"
#include "support/packet_maker.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

class Player : public ::testing::Test {
 protected:
  /// Of 6 s, of which the head speeds up in the first.
  Player() {
    auto writer = made_writer(path_.text());
    record_device(writer, 6 * second);
  }
  static lidar started(std::unique_ptr<connector> from) {
    auto made = lidar::open(std::move(from));
    EXPECT_TRUE(made);
    EXPECT_TRUE(made->start());
    return std::move(*made);
  }
  [[nodiscard]] lidar play(const playback_options& how = {}) const {
    return started(std::move(*replay::open(path_.text(), how)));
  }
  /// The times of all points of all scans that follow.
  static std::vector<std::int64_t> rest_of(lidar& from) {
    std::vector<std::int64_t> all;
    for (const scan& each : from.scans(500ms)) {
      for (const point& at : each.points) all.push_back(at.time_ns);
    }
    return all;
  }
  static std::string packets(int count) {
    const made::packet made(0, 64, 90 * 64, std::vector<std::uint16_t>(40, 4000));
    std::string all;
    for (int i = 0; i < count; ++i) all.append(made.data().begin(), made.data().end());
    return all;
  }

  temporary_path path_;
};

TEST_F(Player, IsThereForFilesOnly) {
  virtual_bench bench({}, {});
  auto device = lidar::open(std::make_unique<virtual_connector>(bench));
  ASSERT_TRUE(device);
  EXPECT_EQ(device->player(), nullptr);
  lidar played = play();
  EXPECT_NE(played.player(), nullptr);
  EXPECT_TRUE(played.close());
  EXPECT_EQ(played.player(), nullptr);
}

TEST_F(Player, Seek_GivesThePointsOfAnOpeningThere) {
  lidar late = play({.from_ns = 3 * second});
  const auto wanted = rest_of(late);
  ASSERT_GT(wanted.size(), 15'000U);
  lidar device = play();
  for (int i = 0; i < 9; ++i) ASSERT_TRUE(device.wait_scan(500ms));
  ASSERT_TRUE(device.player()->seek(3 * second));
  EXPECT_EQ(rest_of(device), wanted) << "forward";
  ASSERT_TRUE(device.player()->seek(3 * second));
  EXPECT_EQ(rest_of(device), wanted) << "after the end";
  ASSERT_TRUE(device.player()->seek(0));
  ASSERT_TRUE(device.wait_scan(500ms));
  EXPECT_LT(device.player()->position_ns(), 2 * second);
}

TEST_F(Player, Seek_AcrossTheEndsCountsAsTheEnds) {
  lidar device = play();
  player& on = *device.player();
  ASSERT_TRUE(on.seek(std::numeric_limits<std::int64_t>::min()));
  EXPECT_EQ(on.position_ns(), 0);
  ASSERT_TRUE(on.seek(std::numeric_limits<std::int64_t>::max()));
  EXPECT_EQ(on.position_ns(), on.length_ns());
  EXPECT_EQ(device.try_scan(500ms).error(), problem::end_of_input);
}

TEST_F(Player, Pause_StandsStillUntilItEnds) {
  lidar device = play({.speed = 1000});
  player& on = *device.player();
  ASSERT_TRUE(device.wait_scan(500ms));
  on.pause(true);
  EXPECT_TRUE(on.is_paused());
  const std::int64_t position_ns = on.position_ns();
  const auto begun = clock::now();
  auto found = device.try_scan(100ms);
  while (found) found = device.try_scan(100ms);  // what was read before
  EXPECT_EQ(found.error(), problem::timeout);
  EXPECT_GE(clock::now() - begun, 100ms);
  EXPECT_EQ(on.position_ns(), position_ns);
  EXPECT_EQ(device.event_loop().scan_due_in(), lidar::milliseconds::max());
  device.wake();
  EXPECT_EQ(device.wait_scan(100ms).error(), problem::cancelled) << "a loop waits without limit";
  on.pause(false);
  EXPECT_TRUE(device.try_scan(patience));
}

TEST_F(Player, Speed_ChangesFromNowOn) {
  lidar device = play({.speed = 1e-6});
  player& on = *device.player();
  EXPECT_EQ(device.try_scan(50ms).error(), problem::timeout);
  ASSERT_TRUE(on.set_speed(1));
  EXPECT_EQ(on.speed(), 1.0);
  const auto begun = clock::now();
  ASSERT_TRUE(on.seek(2 * second));
  const auto next_end_ns = [&] {
    const auto found = device.try_scan(patience);
    return found ? found->end_ns() : 0;
  };
  const std::int64_t first_ns = next_end_ns();
  std::int64_t last_ns = 0;
  for (int i = 0; i < 3; ++i) last_ns = next_end_ns();
  EXPECT_GT(last_ns, first_ns);
  EXPECT_GE(clock::now() - begun, std::chrono::nanoseconds(last_ns - first_ns));
  ASSERT_TRUE(on.set_speed(0));
  EXPECT_GT(rest_of(device).size(), 10'000U);
  for (const double wrong : {-1.0, 1001.0, 1e-7, std::numeric_limits<double>::quiet_NaN()}) {
    const auto refused = on.set_speed(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error(), problem::bad_option);
  }
  EXPECT_EQ(on.speed(), 0.0);
}

/// Changes the speed in the first read of a call, which returns no bytes.
struct speed_change {
  player* of = nullptr;
  double to = 0;
};

class changing_transport final : public forwarding_transport {
 public:
  changing_transport(std::unique_ptr<transport> inner, speed_change& by)
      : forwarding_transport(std::move(inner)), by_(by) {}
  result<received> read(std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept override {
    player* const now = std::exchange(by_.of, nullptr);
    if (now == nullptr) return inner().read(out, deadline_ns);
    if (!now->set_speed(by_.to)) ADD_FAILURE() << "the speed is not set";
    return received{};
  }

 private:
  speed_change& by_;
};

class changing_connector final : public forwarding_connector {
 public:
  changing_connector(std::unique_ptr<connector> inner, speed_change& by)
      : forwarding_connector(std::move(inner)), by_(by) {}
  result<std::unique_ptr<transport>> connect() noexcept override {
    auto made = inner().connect();
    if (!made) return made;
    return std::make_unique<changing_transport>(std::move(*made), by_);
  }

 private:
  speed_change& by_;
};

/// The end of a call is by the clock of the caller, also if the speed changes during the call.
TEST_F(Player, Speed_ChangesDuringACall_ItsEndStaysThatOfTheCaller) {
  for (const bool in_loop : {false, true}) {
    speed_change change;
    lidar device = started(std::make_unique<changing_connector>(
        std::move(*replay::open(path_.text(), {.speed = 1e-6})), change));
    change = {device.player(), 1000};
    // At the speed of its begin the call would end 60 microseconds later in the recording.
    const auto found = in_loop ? device.wait_scan(patience) : device.try_scan(patience);
    EXPECT_TRUE(found) << found.error().message();
  }
  speed_change change;
  lidar device = started(std::make_unique<changing_connector>(
      std::move(*replay::open(path_.text(), {.speed = 1e-3})), change));
  change = {device.player(), 1e-6};
  // At the speed of its begin it would end 200 microseconds later in the recording, which are now 200 s.
  const auto begun = clock::now();
  EXPECT_EQ(device.try_scan(200ms).error(), problem::timeout);
  EXPECT_GE(clock::now() - begun, 200ms);
  EXPECT_LT(clock::now() - begun, patience);
}

/// So is the time that a loop gives the motor to spin up.
TEST_F(Player, Speed_ChangesWhileTheMotorSpinsUp_TheLoopWaitsByTheClockOfTheCaller) {
  lidar device = play({.speed = 1e-6});
  ASSERT_TRUE(device.player()->seek(3 * second));  // the motor turns there, but no scan has come
  const auto left = [&] { return device.event_loop().scan_due_in(); };
  EXPECT_LE(left(), 10'000ms);
  EXPECT_GT(left(), 5'000ms);
  ASSERT_TRUE(device.player()->set_speed(1000));
  EXPECT_LE(left(), 10'000ms);
  EXPECT_GT(left(), 5'000ms);
}

TEST_F(Player, Loop_BeginsAgainAtLaterTimes) {
  lidar device = play();
  player& on = *device.player();
  const std::size_t once = rest_of(device).size();
  ASSERT_TRUE(on.seek(0));
  on.set_loop(true);
  std::size_t points = 0;
  std::int64_t last_ns = 0;
  const std::int64_t begin_ns = on.begin_ns();
  while (2 * points < 3 * once) {
    const auto found = device.wait_scan(500ms);
    ASSERT_TRUE(found) << found.error().message();
    EXPECT_GE(found->time_ns(), last_ns);
    last_ns = found->end_ns();
    points += found->size();
  }
  EXPECT_LE(on.position_ns(), on.length_ns());
  EXPECT_NEAR(static_cast<double>(on.begin_ns() - begin_ns), static_cast<double>(on.length_ns()),
              20e6)
      << "in the second round";
  on.set_loop(false);
  EXPECT_GT(rest_of(device).size(), 0U);
}

TEST_F(Player, LengthAndWallTimeAreThoseOfTheRecording) {
  lidar device = play();
  player& on = *device.player();
  EXPECT_EQ(on.wall_ns(7 * second), 7 * second + wall_ahead_ns) << "before anything was read";
  const auto reader = recording_reader::open(path_.text());
  ASSERT_TRUE(reader);
  EXPECT_EQ(on.length_ns(), reader->last_ns() - reader->first_ns());
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(device.wait_scan(500ms));
  EXPECT_GT(on.position_ns(), 0);
  EXPECT_LT(on.position_ns(), on.length_ns());
}

TEST_F(Player, RecordedAgain_DoesNotGoBack) {
  const temporary_path other;
  auto writer = made_writer(other.text());
  auto from = recorded(std::move(*replay::open(path_.text())), writer);
  lidar device = started(std::move(*from));
  const auto refused = device.player()->seek(0);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), problem::bad_option);
  EXPECT_GT(rest_of(device).size(), 30'000U);
}

// 40 samples a packet: at 4000 per second 10 ms.
TEST_F(Player, RawBytes_ArePlayedByTheirSamples) {
  const temporary_path raw(".bin");
  std::ofstream(raw.text(), std::ios::binary) << packets(100);
  lidar device = started(std::move(*open_raw_bytes(raw.text(), 4000, {.from_ns = second / 2})));
  player& on = *device.player();
  EXPECT_EQ(on.length_ns(), second);
  EXPECT_EQ(on.position_ns(), second / 2);
  const auto rest = rest_of(device);
  ASSERT_GT(rest.size(), 100U);
  EXPECT_EQ(rest[100] - rest[0], 25 * ms) << "100 samples";
  EXPECT_EQ(device.counts().stream.packets, 51U) << "the first ends at 0.5 s";
  EXPECT_EQ(on.position_ns(), second);
  ASSERT_TRUE(on.seek(second - 100 * ms));
  const auto begun = clock::now();  // first: a busy machine may stop this test behind the next line
  ASSERT_TRUE(on.set_speed(1));
  EXPECT_FALSE(rest_of(device).empty());
  EXPECT_GE(clock::now() - begun, 99ms);
  EXPECT_EQ(device.counts().stream.packets, 62U);
}

TEST_F(Player, RawBytes_HaveTheSameTimesAfterASeek) {
  const temporary_path raw(".bin");
  std::ofstream(raw.text(), std::ios::binary) << packets(100);
  lidar device = started(std::move(*open_raw_bytes(raw.text(), 4000, {})));
  const auto whole = rest_of(device);
  ASSERT_TRUE(device.player()->seek(0));
  EXPECT_EQ(rest_of(device), whole);
}

}  // namespace
}  // namespace g4lidar::test
