// SPDX-License-Identifier: MIT
// A reader that opens the lidar itself, and gives what comes to a listener.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "g4lidar/background_reader.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "g4lidar/transport/transport.hpp"
#include "listening_reader.hpp"
#include "reader_record.hpp"
#include "recording/recorded_run.hpp"
#include "support/packet_maker.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;

const lidar_options waiting{.device_wait = lidar::milliseconds::max()};

TEST_F(ReaderListener, GetsScansUntilTheReaderIsStopped) {
  background_reader& made = begin("sim:?serial=1111222233334444");
  ASSERT_TRUE(heard.wait_for_scans(10));
  const reader_status now = made.status();
  EXPECT_EQ(now.state, reader_state::running);
  EXPECT_FALSE(now.why);
  EXPECT_EQ(now.information->serial_number(), "1111222233334444");
  EXPECT_NE(now.name, "");
  EXPECT_FALSE(now.playback);
  EXPECT_GE(made.counts().scans, 2U);
  EXPECT_EQ(made.points().written(), 0U);
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  EXPECT_LT(std::abs(heard.last_scan_wall_ns - std::chrono::nanoseconds(wall).count()),
            std::chrono::nanoseconds(patience).count());
  EXPECT_TRUE(heard.wait([&] {  // it has spun up
    return std::abs(static_cast<double>(heard.last_size) - 9000 / 7.0) < 20.0;
  }));
  made.stop();
  EXPECT_EQ(std::ranges::adjacent_find(heard.scans, std::greater_equal{}), heard.scans.end())
      << "each came once";
  EXPECT_EQ(heard.live_points, 0U) << "not wanted";
  EXPECT_EQ(heard.states.front(), "running");
  EXPECT_EQ(heard.opened, 1);
}

/// An SCL has the number 22. This one states another one in its revolutions.
TEST_F(ReaderListener, StatusHasAsWhichModelItIsRead_AlsoWhatBecomesKnownLater) {
  const auto facts_of = [](const background_reader& of) {
    std::map<std::string, std::string> all;
    for (const auto& [name, text] : of.status().recognised) all.emplace(name, text);
    return all;
  };
  background_reader& made =
      begin("sim:?model=scl&model_id=4&ct_information=true&ct_crc=true&stray_before_zero=true", {},
            {.starts_rested = true});
  ASSERT_TRUE(heard.wait_for_state("resting"));
  std::map<std::string, std::string> facts = facts_of(made);
  EXPECT_EQ(facts["model"], "scl");
  EXPECT_EQ(facts["candidates"], "scl");
  EXPECT_EQ(facts["known_by"], "recording");
  EXPECT_EQ(facts.count("contradictions"), 0U);
  made.rest(false);
  ASSERT_TRUE(comes_true([&] { return facts_of(made).contains("contradictions"); }));
  facts = facts_of(made);
  EXPECT_EQ(facts["number"], "4");
  EXPECT_NE(facts["contradictions"].find("reports the number 4"), std::string::npos);
  EXPECT_TRUE(comes_true([&] {
    const auto now = made.status().information;
    return now && now->model == 4;
  }));
}

TEST_F(ReaderListener, GetsThePointsOfEachScan) {
  begin("sim:", {}, {.wants_points = true}).ask([](lidar*) {});
  ASSERT_TRUE(heard.wait_for_scans(2));
  EXPECT_TRUE(comes_true([&] {
    const std::lock_guard lock(heard.mutex);
    return heard.live_points >= heard.points;
  }));
}

TEST_F(ReaderListener, Rest_StopsTheMotorAndStartsItAgain) {
  auto device = plug_in();
  background_reader& made = begin(port());
  ASSERT_TRUE(heard.wait_for_scans(1));
  EXPECT_TRUE(is_scanning(device));
  made.rest(true);
  ASSERT_TRUE(heard.wait_for_state("resting"));
  EXPECT_FALSE(is_scanning(device));
  EXPECT_FALSE(is_null(made));
  made.rest(false);
  ASSERT_TRUE(heard.wait_for_scans(1));
  EXPECT_TRUE(is_scanning(device));
  made.stop();
  EXPECT_FALSE(is_scanning(device));
  EXPECT_THAT(heard.states, ElementsAre("running", "resting", "running"));
}

TEST_F(ReaderListener, StartsRested_NeverTurns) {
  auto device = plug_in();
  background_reader& made = begin(port(), {}, {.starts_rested = true});
  ASSERT_TRUE(heard.wait_for_state("resting"));
  made.stop();
  device.with([](sim::device& simulated, std::int64_t) {
    constexpr auto start = static_cast<std::uint8_t>(command::start);
    for (const auto& asked : simulated.log()) EXPECT_NE(asked.code, start);
  });
}

TEST_F(ReaderListener, Ask_RunsBetweenTwoScans) {
  background_reader& made = begin("sim:");
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(heard.wait_for_scans(1));
    std::string was;
    made.ask([&](lidar* device) {
      const auto set = device->set(scan_frequency::hz(10), while_scanning::stop_and_resume);
      const std::lock_guard lock(heard.mutex);
      was = set ? "set" : set.error().message();
      heard.changed.notify_all();
    });
    ASSERT_TRUE(heard.wait([&] { return !was.empty(); }));
    EXPECT_EQ(was, "set") << "the call that woke the reader does not cancel it";
  }
  EXPECT_TRUE(heard.wait_for_scans(2)) << "it goes on";
}

TEST_F(ReaderListener, DeviceWait_OpensALidarThatComesLater) {
  background_reader& made = begin(port(), waiting);
  ASSERT_TRUE(heard.wait([&] { return !heard.whys.empty(); }));
  EXPECT_EQ(made.status().state, reader_state::opening);
  ASSERT_TRUE(made.status().why);
  EXPECT_EQ(*made.status().why, problem::no_port);
  EXPECT_FALSE(made.failed());
  EXPECT_TRUE(is_null(made));
  std::this_thread::sleep_for(1200ms);  // more attempts
  EXPECT_EQ(heard.whys.size(), 1U) << "the same reason is reported once";
  const auto device = plug_in();
  EXPECT_TRUE(heard.wait_for_scans(1));
  EXPECT_FALSE(made.status().why);
}

TEST_F(ReaderListener, Reconnect_GoesOnAfterAnUnplug) {
  background_reader& made = begin("sim:?fault=unplug@1500ms+500ms", {.reconnect = true});
  ASSERT_TRUE(heard.wait_for_state("lost"));
  ASSERT_TRUE(heard.wait([&] { return !heard.whys.empty(); }));
  EXPECT_EQ(heard.whys.front(), problem::gone);
  ASSERT_TRUE(heard.wait_for_state("running"));
  EXPECT_TRUE(heard.wait_for_scans(2));
  made.stop();
  EXPECT_THAT(heard.events, ::testing::IsSupersetOf({"lost", "reconnected"}));
  EXPECT_EQ(made.counts().reconnects, 1U);
}

TEST_F(ReaderListener, UnplugWithoutReconnect_Ends) {
  background_reader& made = begin("sim:?fault=unplug@1500ms");
  ASSERT_TRUE(heard.wait_for_state("ended"));
  ASSERT_TRUE(made.failed());
  EXPECT_EQ(*made.failed(), problem::gone);
  EXPECT_TRUE(is_null(made));
}

TEST_F(ReaderListener, UnplugWithDeviceWait_IsOpenedAgain) {
  begin("sim:?fault=unplug@1500ms", waiting);
  ASSERT_TRUE(heard.wait_for_state("opening"));
  EXPECT_TRUE(heard.wait([&] { return heard.opened == 2; }));
}

TEST_F(ReaderListener, InvalidName_EndsEvenWhereItWouldWait) {
  for (const std::string name : {"sim:?colour=red", "tcp:127.0.0.1:99999"}) {
    const background_reader& made = begin(name, waiting);
    ASSERT_TRUE(heard.wait_for_state("ended"));
    ASSERT_TRUE(made.failed());
    EXPECT_EQ(*made.failed(), problem::bad_option) << name;
  }
}

TEST_F(ReaderListener, IsCancelled_Ends) {
  std::atomic<bool> is_cancelled = false;
  lidar_options options = waiting;
  options.is_cancelled = [&] { return is_cancelled.load(); };
  const std::string& file = recording(3);
  const background_reader& made = begin(file, options);
  ASSERT_TRUE(heard.wait_for_state("ended"));
  EXPECT_EQ(*made.failed(), problem::end_of_input);
  is_cancelled = true;
  const background_reader& other = begin(file, options);
  ASSERT_TRUE(heard.wait_for_state("ended"));
  EXPECT_EQ(*other.failed(), problem::cancelled);
}

TEST_F(ReaderListener, Recording_IsPlayedByItsTimesAndEnds) {
  const std::string& file = recording(3);
  const auto begun = std::chrono::steady_clock::now();
  background_reader& made = begin(file, {.playback = {.speed = 1}});
  ASSERT_TRUE(heard.wait_for_state("ended"));
  const auto took = std::chrono::steady_clock::now() - begun;
  const std::size_t scans = heard.number_of_scans();
  EXPECT_GE(scans, 6U);
  EXPECT_GE(took, (scans - 1) * 1000ms / 7);
  EXPECT_EQ(*made.failed(), problem::end_of_input);
  EXPECT_THAT(heard.events, ::testing::Not(::testing::Contains("lost")));
  const auto where = made.status().playback;
  ASSERT_TRUE(where);
  EXPECT_NEAR(static_cast<double>(where->length_ns), 3e9, 0.5e9);
  EXPECT_NEAR(static_cast<double>(where->position_ns), static_cast<double>(where->length_ns),
              0.4e9);
  EXPECT_EQ(heard.last_scan_wall_ns, heard.last_time_ns + recorded_ahead_ns)
      << "when it was made, not now";
}

TEST_F(ReaderListener, Recording_AtFullSpeedAndAgainAfterASeek) {
  background_reader& made = begin(recording(5));
  ASSERT_TRUE(heard.wait_for_state("ended"));
  const std::size_t scans = heard.number_of_scans();
  EXPECT_GE(scans, 20U);
  EXPECT_TRUE(is_null(made)) << "it has ended";
  made.seek(0);
  ASSERT_TRUE(heard.wait_for_scans(scans));
  EXPECT_EQ(heard.opened, 1);
}

TEST_F(ReaderListener, PausedRecording_GivesOneScanOfEachSeek) {
  background_reader& made = begin(recording(7), {.playback = {.speed = 1}});
  ASSERT_TRUE(heard.wait_for_scans(1));
  made.pause(true);
  ASSERT_TRUE(comes_true([&] { return made.status().playback->is_paused; }));
  EXPECT_TRUE(made.set_speed(0.001)) << "one scan is given without waiting for it";
  std::size_t before = heard.number_of_scans();
  for (const std::int64_t to : {4 * second, 2 * second}) {
    made.seek(to);
    ASSERT_TRUE(heard.wait([&] { return heard.scans.size() > before; }));
    std::this_thread::sleep_for(300ms);
    EXPECT_EQ(heard.number_of_scans(), ++before);
    const auto where = made.status().playback;
    EXPECT_TRUE(where->is_paused);
    EXPECT_EQ(where->speed, 0.001);
    EXPECT_NEAR(static_cast<double>(where->position_ns), static_cast<double>(to) + 0.2e9, 0.2e9);
  }
  EXPECT_TRUE(made.set_speed(100));
  made.pause(false);
  ASSERT_TRUE(heard.wait_for_state("ended"));
  EXPECT_GT(heard.number_of_scans(), before + 10);
}

TEST_F(ReaderListener, RestedRecording_StandsUntilItGoesOn) {
  background_reader& made =
      begin(recording(3), {.playback = {.speed = 2}}, {.starts_rested = true});
  ASSERT_TRUE(heard.wait_for_state("resting"));
  std::this_thread::sleep_for(1s);
  EXPECT_EQ(made.counts().scans, 0U);
  const auto begun = std::chrono::steady_clock::now();
  made.rest(false);
  EXPECT_TRUE(heard.wait_for_state("ended"));
  EXPECT_GE(heard.number_of_scans(), 6U);
  EXPECT_GE(std::chrono::steady_clock::now() - begun, 1400ms) << "all of it was left";
}

TEST_F(ReaderListener, Recording_Loops) {
  begin(recording(3), {.playback = {.loop = true}});
  EXPECT_TRUE(heard.wait_for_scans(40)) << "it holds less than 20";
  EXPECT_THAT(heard.states, ElementsAre("running"));
  EXPECT_THAT(heard.events, ::testing::Not(::testing::Contains("reconnected")));
  EXPECT_EQ(heard.opened, 1);
}

TEST_F(ReaderListener, InvalidSpeed_IsAnError) {
  background_reader& made = begin("sim:");
  EXPECT_EQ(made.set_speed(-1).error(), problem::bad_option);
}

TEST_F(ReaderListener, RawBytes_ArePlayedByTheirSamples) {
  const temporary_path path(".bin");
  {
    std::ofstream file(path.text(), std::ios::binary);
    // 40 samples each: 900 are 4 s at 9 kHz, and 90 revolutions.
    for (int i = 0; i < 900; ++i) {
      const made::packet bytes(i % 10 == 0 ? 1 : 0, i % 10 * 36 * 64, (i % 10 * 36 + 35) * 64,
                               std::vector<std::uint16_t>(40, 4000));
      file.write(reinterpret_cast<const char*>(bytes.data().data()),
                 static_cast<std::streamsize>(bytes.data().size()));
    }
  }
  const auto begun = std::chrono::steady_clock::now();
  begin(path.text(), {.playback = {.speed = 2}});
  ASSERT_TRUE(heard.wait_for_state("ended"));
  EXPECT_GE(heard.number_of_scans(), 80U);
  EXPECT_GE(std::chrono::steady_clock::now() - begun, 1900ms);
}

TEST(BackgroundReader, NewestOnly_DropsOlderScans) {
  background_reader reader({.device = "sim:"}, {.newest_only = true});
  ASSERT_TRUE(reader.start());
  ASSERT_TRUE(comes_true([&] { return reader.counts().scans > 5; }));
  EXPECT_GE(reader.counts().scans_missed, 4U);
  const auto newest = reader.next_scan(patience);
  ASSERT_TRUE(newest);
  EXPECT_GE(newest->revolution + 1, reader.counts().scans);
}

}  // namespace
}  // namespace g4lidar::test
