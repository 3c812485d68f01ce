// SPDX-License-Identifier: MIT
// Changes of settings and filters: all of them or none, answered once and in time.
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <thread>

#include "service_bench.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

const lidar_options waiting{.device_wait = lidar::milliseconds::max()};

class ServiceChanges : public Service {
 protected:
  lidar_service& begin_at_port(std::vector<named_value> settings = {}) {
    service_lidar one = lidar_at(port());
    one.options.device_wait = waiting.device_wait;
    one.settings = std::move(settings);
    return begin({one});
  }
  /// Keeps the thread of the lidar, until the end of the test at the latest.
  void block() {
    std::promise<void> blocked;
    service->ask(0, [&, go = std::shared_future<void>(released_.get_future())](lidar*) {
      blocked.set_value();
      go.wait();
    });
    blocked.get_future().wait();
  }
  void release() {
    if (!std::exchange(is_released_, true)) released_.set_value();
  }
  ~ServiceChanges() override { release(); }
  /// Remembers its answers.
  std::function<void(const std::string&)> answer() {
    return [this](const std::string& why_not) {
      const std::lock_guard lock(heard.mutex);
      answers.push_back(why_not);
      heard.changed.notify_all();
    };
  }

  std::vector<std::string> answers;

 private:
  std::promise<void> released_;
  bool is_released_ = false;
};

TEST_F(ServiceChanges, OfASettingAndAFilter) {
  auto device = plug_in();
  begin_at_port();
  ASSERT_TRUE(heard.wait_for_scans(1));
  ASSERT_TRUE(heard.wait([&] { return heard.values.size() == 1; })) << "when it was opened";
  EXPECT_EQ(service->change_now(0, {{"frequency", 10.0}, {"range_min", 0.5}}, patience), "");
  EXPECT_DOUBLE_EQ(frequency_of(device), 10.0);
  EXPECT_EQ(value("frequency"), parameter_value(10.0));
  EXPECT_EQ(value("range_min"), parameter_value(0.5));
  EXPECT_TRUE(heard.wait([&] { return heard.values.size() == 2; }));
  EXPECT_TRUE(heard.wait_for_scans(2)) << "it goes on";
  service->stop();
  EXPECT_GE(std::ranges::min(heard.scans.back().kept, {}, &point::range_mm).range_mm, 500.0F);
}

TEST_F(ServiceChanges, OfASettingAndAWrongFilter_ChangesNothing) {
  auto device = plug_in();
  begin_at_port();
  ASSERT_TRUE(heard.wait_for_scans(1));
  EXPECT_THAT(service->change_now(0, {{"frequency", 10.0}, {"fov", std::string("left")}}, patience),
              HasSubstr("fov"));
  EXPECT_DOUBLE_EQ(frequency_of(device), 7.0);
}

TEST_F(ServiceChanges, OfARefusedSetting_LeaveFilters) {
  auto device = plug_in();
  begin_at_port();
  ASSERT_TRUE(heard.wait_for_scans(1));
  const std::vector<named_value> wanted{
      {"range_min", 0.5}, {"direction", std::string("ccw")}, {"frequency", 99.0}};
  EXPECT_THAT(service->change_now(0, wanted, patience), HasSubstr("99"));
  EXPECT_EQ(service->change_now(0, {{"loudness", 10.0}, {"range_min", 0.5}}, patience),
            "there is no such parameter");
  EXPECT_EQ(value("range_min"), parameter_value(0.0));
  EXPECT_DOUBLE_EQ(frequency_of(device), 7.0);
}

/// Another change of filters, in between, makes this one wrong: the setting is not made.
TEST_F(ServiceChanges, OfAFilterThatHasBecomeWrong_ChangesNothing) {
  auto device = plug_in();
  begin_at_port();
  ASSERT_TRUE(heard.wait_for_scans(1));
  block();
  service->change(0, {{"frequency", 10.0}, {"range_min", 8.0}}, answer(), patience);
  EXPECT_EQ(service->change_now(0, {{"range_max", 5.0}}), "");
  release();
  ASSERT_TRUE(heard.wait([&] { return !answers.empty(); }));
  EXPECT_THAT(answers.front(), HasSubstr("range"));
  EXPECT_EQ(value("range_min"), parameter_value(0.0));
  EXPECT_DOUBLE_EQ(frequency_of(device), 7.0);
}

TEST_F(ServiceChanges, WhileTheLidarIsSearched) {
  begin_at_port();
  const auto begun = std::chrono::steady_clock::now();
  EXPECT_EQ(service->change_now(0, {{"frequency", 10.0}, {"range_min", 0.5}}, 10 * patience),
            "the lidar is not connected");
  EXPECT_THAT(service->change_now(0, {{"frequency", 10.0}, {"fov", std::string("left")}}),
              HasSubstr("fov"));
  EXPECT_LT(std::chrono::steady_clock::now() - begun, patience);
  EXPECT_EQ(value("range_min"), parameter_value(0.0));
  EXPECT_EQ(service->change_now(0, {{"range_min", 0.5}}), "") << "a filter needs no lidar";
  EXPECT_EQ(value("range_min"), parameter_value(0.5));
  auto device = plug_in();
  ASSERT_TRUE(heard.wait_for_scans(3));
  service->stop();
  EXPECT_GE(std::ranges::min(heard.scans.back().kept, {}, &point::range_mm).range_mm, 500.0F);
}

TEST_F(ServiceChanges, ThatTakeTooLong_AreAnsweredOnceInTime_AndNotMade) {
  auto device = plug_in();
  begin_at_port();
  ASSERT_TRUE(heard.wait_for_scans(1));
  block();
  service->change(0, {{"frequency", 10.0}, {"range_min", 0.5}}, answer(), 200ms);
  ASSERT_TRUE(heard.wait([&] { return !answers.empty(); })) << "while the thread is busy";
  EXPECT_EQ(answers.front(), "the lidar did not answer in time");
  release();
  ASSERT_TRUE(heard.wait_for_scans(2));
  service->stop();
  EXPECT_EQ(answers.size(), 1U);
  EXPECT_DOUBLE_EQ(frequency_of(device), 7.0);
  EXPECT_EQ(value("range_min"), parameter_value(0.0));
}

/// The lidar gets the command, and does not answer it for a while.
TEST_F(ServiceChanges, ThatTheLidarDoesNotAnswer_AreAnsweredOnceInTime) {
  auto device = plug_in({"mute@5s+4s"});
  begin_at_port();
  ASSERT_TRUE(heard.wait_for_scans(1));
  ASSERT_TRUE(comes_true([&] {
    bool is_mute = false;
    device.with([&](sim::device&, std::int64_t now_ns) { is_mute = now_ns > 5 * second; });
    return is_mute;
  }));
  service->change(0, {{"frequency", 10.0}, {"range_min", 0.5}}, answer(), 200ms);
  ASSERT_TRUE(heard.wait([&] { return !answers.empty(); }));
  EXPECT_EQ(answers.front(), "the lidar did not answer in time; it may be set later");
  ASSERT_TRUE(heard.wait_for_scans(3)) << "it goes on";
  service->stop();
  EXPECT_EQ(answers.size(), 1U);
}

TEST_F(ServiceChanges, AreAnsweredByStop) {
  auto device = plug_in();
  begin_at_port();
  ASSERT_TRUE(heard.wait_for_scans(1));
  block();
  for (int i = 0; i < 3; ++i) service->change(0, {{"frequency", 10.0}}, answer(), 100h);
  std::thread stopping([&] { service->stop(); });
  EXPECT_TRUE(heard.wait([&] { return answers.size() == 3; })) << "before the thread has ended";
  release();
  stopping.join();
  EXPECT_EQ(answers.size(), 3U);
  for (const std::string& each : answers) EXPECT_NE(each, "");
  EXPECT_DOUBLE_EQ(frequency_of(device), 7.0);
}

TEST_F(ServiceChanges, BeforeStartAndAfterStop_AreAnsweredAtOnce) {
  make({lidar_at("sim:")});
  constexpr auto ever = std::chrono::milliseconds::max();
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(service->change_now(0, {{"frequency", 10.0}}, ever), "the lidar is not connected");
    EXPECT_EQ(service->change_now(0, {{"range_min", 0.5 + i}}, ever), "");
    EXPECT_EQ(value("range_min"), parameter_value(0.5 + i));
    service->stop();
  }
}

TEST_F(ServiceChanges, SettingsAreMadeAgain_WhenItIsOpenedAgain) {
  auto device = std::make_unique<sim::background_pty>(plug_in());
  begin_at_port({{"frequency", 9.0}});
  ASSERT_TRUE(heard.wait_for_state(reader_state::running));
  EXPECT_DOUBLE_EQ(frequency_of(*device), 9.0);
  for (const double hz : {9.0, 10.0}) {
    device.reset();
    ASSERT_TRUE(heard.wait_for_state(reader_state::opening));
    device = std::make_unique<sim::background_pty>(plug_in());  // at 7 Hz
    ASSERT_TRUE(heard.wait_for_state(reader_state::running));
    EXPECT_DOUBLE_EQ(frequency_of(*device), hz);
    EXPECT_EQ(value("frequency"), parameter_value(hz));
    EXPECT_EQ(service->change_now(0, {{"frequency", 10.0}}, patience), "");
  }
  service->stop();
  for (const std::string& each : heard.values) EXPECT_EQ(each, "");
}

TEST_F(ServiceChanges, SettingsThatCannotBeMade_AreReported_AndItRuns) {
  auto device = plug_in();
  begin_at_port({{"frequency", 99.0}});
  ASSERT_TRUE(heard.wait_for_scans(1));
  service->stop();
  ASSERT_EQ(heard.values.size(), 1U);
  EXPECT_THAT(heard.values.front(), HasSubstr("99"));
}

}  // namespace
}  // namespace g4lidar::test
