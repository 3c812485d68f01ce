// SPDX-License-Identifier: MIT
// The texts of timeouts: none states a cause that the bytes contradict.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "g4lidar/background_reader.hpp"
#include "g4lidar/lidar.hpp"
#include "recording/recorded_run.hpp"
#include "support/patience.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t second_ns = 1'000'000'000;

/// A lidar whose head turns by a / 2 * t^2: at 140 mHz a second by two revolutions in 5.3 s, and by a third one in 1.2 s;
/// at 5 mHz a second it has turned by a quarter after 10 s.
class slow_lidar {
 public:
  explicit slow_lidar(std::uint32_t acceleration_mhz_per_s, read_pace pace = read_pace::automatic) {
    sim::device_options device;
    device.acceleration_mhz_per_s = acceleration_mhz_per_s;
    bench_ = std::make_unique<virtual_bench>(device);
    lidar_options options;
    options.tuning.pace = pace;
    opened_ = open_virtual(*bench_, options);
    EXPECT_TRUE(opened_);
    EXPECT_TRUE(opened_->start());
  }
  lidar* operator->() { return &*opened_; }
  [[nodiscard]] lidar& operator*() { return *opened_; }
  [[nodiscard]] std::int64_t now_ns() const { return bench_->now_ns; }

 private:
  std::unique_ptr<virtual_bench> bench_;
  result<lidar> opened_ = failure(task::opening, problem::no_port);
};

void expect_slow(const error& why) {
  EXPECT_EQ(why, problem::timeout);
  EXPECT_EQ(why.detail(), error_detail::no_revolution);
  const std::string text = why.message();
  EXPECT_NE(text.find("packets arrive, but no revolution"), std::string::npos) << text;
  EXPECT_EQ(text.find("no data"), std::string::npos) << text;
  EXPECT_EQ(text.find("nplug"), std::string::npos) << text;
}

TEST(Timeout, OfALoop_WithASlowMotor_StatesThatPacketsArrive) {
  struct motor {
    std::uint32_t acceleration_mhz_per_s;
    int scans;  // of a loop that waits for 500 ms
  };
  for (const motor slow : {motor{140, 1}, motor{5, 0}}) {
    for (const read_pace pace : {read_pace::packets, read_pace::revolutions}) {
      slow_lidar whole(slow.acceleration_mhz_per_s, pace);
      auto scans = whole->scans(500ms);
      int count = 0;
      for ([[maybe_unused]] const scan& each : scans) ++count;
      EXPECT_EQ(count, slow.scans);
      expect_slow(*scans.why_ended());

      slow_lidar sliced(slow.acceleration_mhz_per_s, pace);
      scan_loop loop(500ms);
      count = 0;
      auto found = loop.wait(*sliced, 30ms);
      for (; found; found = loop.wait(*sliced, 30ms)) {
        if (*found) ++count;
      }
      EXPECT_EQ(count, slow.scans);
      expect_slow(found.error());
    }
  }
}

TEST(Timeout, OfACall_WithASlowMotor_StatesThatPacketsArrive) {
  slow_lidar slow(140);
  while (slow->counts().scans == 0) static_cast<void>(slow->try_scan(100ms));
  expect_slow(slow->try_scan(0ms).error());
  expect_slow(slow->try_scan(300ms).error());
  while (slow->next_points(0ms)) {  // those that have come
  }
  EXPECT_EQ(slow->next_points(0ms).error().detail(), error_detail::usual)
      << "points need no revolution";
}

TEST(Timeout, OfAFile_IsNotThatOfALidar) {
  const temporary_path path;
  {
    auto writer = recording_writer::create(path.text());
    ASSERT_TRUE(writer);
    record_device(*writer, 3 * second_ns);
  }
  auto lidar = lidar::open(path.text(), {.playback = {.speed = 1}});
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  lidar->player()->pause(true);
  for (const error& why : {lidar->try_scan(1ms).error(), lidar->next_points(1ms).error()}) {
    EXPECT_EQ(why.detail(), error_detail::of_file);
    EXPECT_NE(why.message().find("paused"), std::string::npos) << why.message();
    EXPECT_EQ(why.message().find("nplug"), std::string::npos) << why.message();
  }
}

TEST(Timeout, OfAReader_StatesWhatItDoes) {
  background_reader missing(
      {.device = "/dev/ttyNothing", .device_wait = lidar::milliseconds::max()});
  ASSERT_TRUE(missing.start());
  EXPECT_EQ(missing.next_scan(0ms).error().detail(), error_detail::searching);
  background_reader rested({.device = "sim:"}, {.starts_rested = true});
  ASSERT_TRUE(rested.start());
  ASSERT_TRUE(comes_true([&] { return rested.status().state == reader_state::resting; }));
  const error why = rested.next_scan(0ms).error();
  EXPECT_EQ(why.detail(), error_detail::resting);
  EXPECT_EQ(why.message().find("nplug"), std::string::npos) << why.message();
}

struct end_of_packets {
  const char* model;
  std::int64_t silence_ns;  ///< From the start to the first packet.
  std::int64_t from_ns;     ///< From then on the bytes are those of another baud rate.
};

// A lidar whose line is damaged while it scans, or before its first packet, is neither silent nor without power.
TEST(Timeout, OfAScanWhoseBytesAreNoPackets_StatesTheirNumber) {
  for (const auto& [word, silence_ns, from_ns] : {end_of_packets{"g4", 0, 5 * second_ns},
                                                  {"g4", 2 * second_ns, 2 * second_ns},
                                                  {"t-mini", 2 * second_ns, 2 * second_ns},
                                                  {"x2", 0, 5 * second_ns}}) {
    sim::device_options device;
    ASSERT_TRUE(sim::use_model(device, word));
    device.silence_ns = silence_ns;
    const sim::fault fault = sim::make_fault(sim::fault_kind::baud, from_ns);
    virtual_bench bench(device, {&fault, 1});
    bench.baud = device.baud;
    auto lidar = open_virtual(bench, {.model = model_named(word)});
    ASSERT_TRUE(lidar) << word << lidar.error().message();
    ASSERT_TRUE(lidar->start());
    auto found = lidar->try_scan(500ms);
    while (bench.now_ns < 60 * second_ns && (found || !found.error().is_fatal()))
      found = lidar->try_scan(500ms);
    ASSERT_FALSE(found) << word;
    const std::string text = found.error().message();
    EXPECT_EQ(found.error(), problem::garbage) << text;
    EXPECT_NE(text.find(" bytes "), std::string::npos) << text;
    EXPECT_EQ(text.find("no byte"), std::string::npos) << text;
  }
}

TEST(Timeout, OfACommandThatThePortDoesNotAccept_IsAboutThePort) {
  const error why(task::writing, problem::timeout, "/dev/ttyUSB0", 0, error_detail::not_sent);
  EXPECT_NE(why.message().find("did not accept"), std::string::npos);
}

}  // namespace
}  // namespace g4lidar::test
