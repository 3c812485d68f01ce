// SPDX-License-Identifier: MIT
// A station: a source in a thread of its own, as programs that publish it use it.
#include "io/station.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "cli/exit_code.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "program.hpp"
#include "station_listener.hpp"
#include "support/patience.hpp"

namespace {

using namespace std::chrono_literals;
using g4_tool::common_options;
using g4_tool::loss_rule;
using g4_tool::station;
using g4_tool::station_state;
using g4lidar::test::patience;
using listener = g4lidar::test::station_record;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace sim = g4lidar::sim;

class Station : public cli::scratch {
 protected:
  station& begin(const std::string& source, loss_rule on_loss = loss_rule::exit,
                 const g4_tool::station_options& wishes = {}) {
    common_options options;
    options.source = source;
    options.on_loss = on_loss;
    made_ = std::make_unique<station>(options, g4lidar::lidar_options{}, heard, wishes);
    heard.of = made_.get();
    made_->start();
    return *made_;
  }
  /// A simulated G4 at `lidar`.
  sim::background_pty plug_in() {
    return *sim::background_pty::open(sim::device(sim::built_in_world()), path("lidar"));
  }
  /// 7 revolutions a second, after the head has begun to turn.
  std::string recording(const std::string& seconds) {
    EXPECT_EQ(cli::run({"sim", "--seconds", seconds, "-o", path("raw.bin")}).code, 0);
    EXPECT_EQ(cli::run({"convert", path("raw.bin"), path("made.mcap")}).code, 0);
    return path("made.mcap");
  }
  static bool is_scanning(sim::background_pty& port) {
    bool is = false;
    port.with([&](sim::device& device, std::int64_t now_ns) {
      static_cast<void>(device.available(now_ns));
      is = device.is_scanning();
    });
    return is;
  }

  listener heard;

 private:
  std::unique_ptr<station> made_;
};

TEST_F(Station, SimulatedLidar_GivesScansUntilItIsStopped) {
  station& made = begin("sim:?serial=1111222233334444");
  ASSERT_TRUE(heard.wait_for_scans(10));
  EXPECT_EQ(made.state(), station_state::running);
  EXPECT_EQ(made.identity()->serial_number(), "1111222233334444");
  EXPECT_FALSE(made.player());
  EXPECT_GE(made.counts().scans, 2U);
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  EXPECT_LT(std::abs(heard.last_scan_wall_ns - std::chrono::nanoseconds(now).count()),
            std::chrono::nanoseconds(patience).count());
  made.stop();
  const std::size_t all = heard.number_of_scans();
  EXPECT_EQ(heard.scans.back() - heard.scans.front() + 1, all) << "each came once";
  EXPECT_NEAR(static_cast<double>(heard.last_size), 9000 / 7.0, 20.0) << "it has spun up";
  EXPECT_EQ(heard.live_points, 0U) << "not wanted";
  EXPECT_EQ(heard.states.front(), "running");
  EXPECT_EQ(heard.opened, 1);
}

TEST_F(Station, Points_ComeBeforeTheirScan) {
  begin("sim:", loss_rule::exit, {.wants_points = true}).ask([](g4lidar::lidar*) {});
  ASSERT_TRUE(heard.wait_for_scans(2));
  const std::lock_guard lock(heard.mutex);
  EXPECT_GE(heard.live_points, heard.points);
}

TEST_F(Station, Rest_StopsTheMotorAndStartsItAgain) {
  auto port = plug_in();
  station& made = begin(port.path());
  ASSERT_TRUE(heard.wait_for_scans(1));
  EXPECT_TRUE(is_scanning(port));
  made.rest(true);
  ASSERT_TRUE(heard.wait_for_state("resting"));
  EXPECT_FALSE(is_scanning(port));
  made.rest(false);
  ASSERT_TRUE(heard.wait_for_scans(1));
  EXPECT_TRUE(is_scanning(port));
  made.stop();
  EXPECT_FALSE(is_scanning(port));
  EXPECT_THAT(heard.states, ElementsAre("running", "resting", "running"));
}

TEST_F(Station, StartsRested_NeverTurns) {
  auto port = plug_in();
  station& made = begin(port.path(), loss_rule::exit, {.starts_rested = true});
  ASSERT_TRUE(heard.wait_for_state("resting"));
  made.stop();
  port.with([](sim::device& device, std::int64_t) {
    constexpr auto start = static_cast<std::uint8_t>(g4lidar::command::start);
    for (const auto& asked : device.log()) EXPECT_NE(asked.code, start);
  });
}

TEST_F(Station, Ask_RunsBetweenTwoScans) {
  station& made = begin("sim:");
  ASSERT_TRUE(heard.wait_for_scans(1));
  std::string was;
  made.ask([&](g4lidar::lidar* lidar) {
    const auto set =
        lidar->set(g4lidar::scan_frequency::hz(10), g4lidar::while_scanning::stop_and_resume);
    const std::lock_guard lock(heard.mutex);
    was = set ? "set" : set.error().message();
    heard.changed.notify_all();
  });
  ASSERT_TRUE(heard.wait([&] { return !was.empty(); }));
  EXPECT_EQ(was, "set");
  EXPECT_TRUE(heard.wait_for_scans(2)) << "it goes on";
}

TEST_F(Station, Wait_OpensALidarThatComesLater) {
  station& made = begin(path("lidar"), loss_rule::wait);
  ASSERT_TRUE(heard.wait([&] { return !heard.whys.empty(); }));
  EXPECT_EQ(made.state(), station_state::opening);
  EXPECT_THAT(made.why(), HasSubstr("no port"));
  bool is_null = false;
  made.ask([&](g4lidar::lidar* lidar) {
    const std::lock_guard lock(heard.mutex);
    is_null = lidar == nullptr;
    heard.changed.notify_all();
  });
  EXPECT_TRUE(heard.wait([&] { return is_null; }));
  const auto port = plug_in();
  EXPECT_TRUE(heard.wait_for_scans(1));
  EXPECT_EQ(made.why(), "");
}

TEST_F(Station, Reconnect_GoesOnAfterAnUnplug) {
  station& made = begin("sim:?fault=unplug@1500ms+500ms", loss_rule::reconnect);
  ASSERT_TRUE(heard.wait_for_state("lost"));
  EXPECT_NE(made.why(), "");
  ASSERT_TRUE(heard.wait_for_state("running"));
  EXPECT_TRUE(heard.wait_for_scans(2));
  made.stop();
  EXPECT_THAT(heard.events, ::testing::IsSupersetOf({"lost", "reconnected"}));
  EXPECT_EQ(made.counts().reconnects, 1U);
}

TEST_F(Station, Exit_EndsWithTheFailure) {
  const station& made = begin("sim:?fault=unplug@1500ms");
  ASSERT_TRUE(heard.wait_for_state("ended"));
  ASSERT_NE(made.failure(), nullptr);
  try {
    std::rethrow_exception(made.failure());
  } catch (const g4_tool::failure& reason) {
    EXPECT_EQ(reason.code(), g4_tool::exit_code::lost) << reason.what();
  }
}

TEST_F(Station, InvalidSource_EndsEvenWhereItWouldWait) {
  const station& made = begin("sim:?colour=red", loss_rule::wait);
  ASSERT_TRUE(heard.wait_for_state("ended"));
  EXPECT_THROW(std::rethrow_exception(made.failure()), g4_tool::failure);
}

TEST_F(Station, InvalidPortOfABridge_EndsEvenWhereItWouldWait) {
  const station& made = begin("tcp:127.0.0.1:99999", loss_rule::wait);
  ASSERT_TRUE(heard.wait_for_state("ended"));
  EXPECT_THAT(made.why(), HasSubstr("with a port of 1 to 65535"));
}

TEST_F(Station, Recording_IsPlayedByItsTimesAndEnds) {
  const std::string file = recording("2");
  const auto begun = std::chrono::steady_clock::now();
  station& made = begin(file);
  ASSERT_TRUE(heard.wait_for_state("ended"));
  const auto took = std::chrono::steady_clock::now() - begun;
  const std::size_t scans = heard.number_of_scans();
  EXPECT_GE(scans, 6U);
  EXPECT_GE(took, (scans - 1) * 1000ms / 7);
  EXPECT_EQ(made.failure(), nullptr);
  const auto player = made.player();
  ASSERT_TRUE(player);
  EXPECT_NEAR(player->length_s, 2.0, 0.5);
  EXPECT_NEAR(player->position_s, player->length_s, 0.4);
  // When it was made, not now: raw bytes have the time of their file.
  struct stat about{};
  ASSERT_EQ(::stat(path("raw.bin").c_str(), &about), 0);
  const double made_s = static_cast<double>(about.st_mtim.tv_sec);
  EXPECT_NEAR(static_cast<double>(heard.last_scan_wall_ns) / 1e9, made_s + 2.0, 1.5);
}

TEST_F(Station, Recording_AtFullSpeedAndAgainAfterASeek) {
  station& made = begin(recording("4"), loss_rule::exit, {.speed = 0});
  ASSERT_TRUE(heard.wait_for_state("ended"));
  const std::size_t scans = heard.number_of_scans();
  EXPECT_GE(scans, 20U);
  made.seek(0);
  ASSERT_TRUE(heard.wait_for_scans(scans));
  EXPECT_EQ(heard.opened, 2);
}

TEST_F(Station, PausedRecording_ShowsOneRevolutionOfEachSeek) {
  station& made = begin(recording("6"));
  ASSERT_TRUE(heard.wait_for_scans(1));
  made.pause(true);
  made.seek(3.0);
  ASSERT_TRUE(heard.wait([&] { return heard.opened == 2 && heard.scans_since_opening == 1; }));
  std::this_thread::sleep_for(300ms);
  EXPECT_TRUE(made.player()->is_paused);
  EXPECT_NEAR(made.player()->position_s, 3.2, 0.3);
  EXPECT_EQ(heard.scans_since_opening, 1U);
  made.set_speed(100);
  made.pause(false);
  ASSERT_TRUE(heard.wait_for_state("ended"));
  EXPECT_GT(heard.scans_since_opening, 10U);
}

TEST_F(Station, Recording_Loops) {
  begin(recording("2"), loss_rule::exit, {.loops = true, .speed = 0});
  EXPECT_TRUE(heard.wait([&] { return heard.opened > 2 && heard.scans.size() > 20; }));
}

TEST_F(Station, FileWithoutAPacket_IsAnErrorThatNamesIt) {
  std::ofstream(path("notes.txt")) << std::string(1000, 'x');
  const station& made = begin(path("notes.txt"), loss_rule::wait);
  ASSERT_TRUE(heard.wait_for_state("ended"));
  ASSERT_NE(made.failure(), nullptr);
  try {
    std::rethrow_exception(made.failure());
  } catch (const g4_tool::failure& reason) {
    EXPECT_EQ(reason.code(), g4_tool::exit_code::bad_file);
    EXPECT_THAT(reason.what(), testing::HasSubstr("no point packet"));
    EXPECT_THAT(reason.what(), testing::HasSubstr("notes.txt"));
  }
  // As a user meets it: it ends, and does not wait for a revolution.
  const auto viewed = cli::run({"view", "--once", path("notes.txt")});
  EXPECT_EQ(viewed.code, 10);
  EXPECT_THAT(viewed.err, testing::HasSubstr("no point packet"));
}

TEST_F(Station, RawBytes_ArePlayedByTheirSamples) {
  ASSERT_EQ(cli::run({"sim", "--seconds", "3", "-o", path("raw.bin")}).code, 0);
  const auto begun = std::chrono::steady_clock::now();
  begin(path("raw.bin"));
  ASSERT_TRUE(heard.wait_for_state("ended"));
  EXPECT_GE(heard.number_of_scans(), 5U);
  EXPECT_GE(std::chrono::steady_clock::now() - begun, heard.number_of_scans() * 1000ms / 7 - 200ms);
}

}  // namespace
