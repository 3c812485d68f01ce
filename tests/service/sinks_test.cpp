// SPDX-License-Identifier: MIT
// The threads in which sinks are called, and the motors that rest while no sink wants anything.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

#include "service_bench.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;

/// Waits in its first scan until it may go on.
class slow_sink final : public sink_record {
 public:
  slow_sink() {
    during_scan = [this] { go_.wait(); };
  }
  ~slow_sink() override { release(); }
  void release() {
    if (!std::exchange(is_released_, true)) released_.set_value();
  }

 private:
  std::promise<void> released_;
  std::shared_future<void> go_{released_.get_future()};
  bool is_released_ = false;
};

class ServiceSinks : public Service {
 protected:
  slow_sink slow;
};

TEST_F(ServiceSinks, ASlowOneDelaysNobody_AndGetsTheNewestScansAndTheLastState) {
  outputs = {{&slow}, {&heard, delivery::in_reader}};
  begin("sim:?seed=4");
  ASSERT_TRUE(slow.wait([&] { return slow.scans.size() == 1; }));
  ASSERT_TRUE(heard.wait_for_scans(12)) << "the lidar and others go on";
  for (const bool runs : {false, true, false}) {
    service->allow(runs);
    ASSERT_TRUE(heard.wait_for_state(runs ? reader_state::running : reader_state::resting));
  }
  EXPECT_EQ(slow.number_of_scans(), 1U);
  slow.release();
  ASSERT_TRUE(slow.wait([&] { return slow.scans.size() >= 5; }));
  ASSERT_TRUE(slow.wait_for_state(reader_state::resting));
  service->stop();
  ASSERT_EQ(slow.scans.size(), 5U);
  for (std::size_t i = 1; i <= 4; ++i)
    expect_same_points(heard.scans[heard.scans.size() - i].kept, slow.scans[5 - i].kept);
  EXPECT_EQ(slow.states, (std::vector{std::pair(std::size_t{0}, reader_state::running),
                                      std::pair(std::size_t{0}, reader_state::resting)}));
}

TEST_F(ServiceSinks, ASlowOneGetsTheNewestTimeAndTheNewest64OfAllElse) {
  outputs = {{&slow}, {&heard, delivery::in_reader}};
  const std::string drive = std::string(room) + "pose 0 -1.5 0 0\npose 60 1.5 0 0\n";
  begin("sim:?seed=4&world=" + text_file("drive.txt", drive), {.gives_points = true});
  ASSERT_TRUE(slow.wait([&] { return slow.scans.size() == 1; }));
  ASSERT_TRUE(heard.wait([&] { return heard.poses.size() > 200; }));
  service->allow(false);
  ASSERT_TRUE(heard.wait_for_state(reader_state::resting));
  const std::size_t times = slow.times.size();
  const std::size_t poses = slow.poses.size();
  slow.release();
  ASSERT_TRUE(slow.wait_for_state(reader_state::resting));
  ASSERT_TRUE(slow.wait([&] { return slow.poses.back() == heard.poses.back(); }));
  ASSERT_TRUE(slow.wait([&] { return slow.times.back() == heard.times.back(); }));
  EXPECT_EQ(slow.times.size() - times, 1U);
  EXPECT_LE(slow.poses.size() - poses, 64U);
  EXPECT_GE(slow.poses.size() - poses, 60U);
  EXPECT_TRUE(std::equal(slow.poses.rbegin(), slow.poses.rbegin() + 60, heard.poses.rbegin()));
}

/// Counts the calls that are made at once, of all its functions but on_open(), which may take long.
class counting_sink final : public service_sink {
 public:
  [[nodiscard]] service_demand wanted() const override { return {.kept = true}; }
  void on_scan(const service_scan&) override { call(); }
  void on_time(std::size_t, std::int64_t) override { call(); }
  void on_event(std::size_t, const lidar_event&, std::int64_t) override { call(); }
  void on_state(std::size_t, reader_state, const std::optional<error>&) override { call(); }
  void on_values(std::size_t, const std::string&) override { call(); }
  void on_measured(std::size_t, const scan&) override { call(); }

  std::atomic<int> calls = 0;
  std::atomic<int> most_at_once = 0;

 private:
  void call() {
    const int now = ++at_once_;
    if (now > most_at_once) most_at_once = now;
    std::this_thread::sleep_for(1ms);
    --at_once_;
    ++calls;
  }
  std::atomic<int> at_once_ = 0;
};

TEST_F(ServiceSinks, AreCalledOneAtATime_AndNotAfterStop) {
  counting_sink in_reader;
  counting_sink in_own_thread;
  outputs = {{&in_reader, delivery::in_reader}, {&in_own_thread}};
  std::vector<service_lidar> lidars;
  for (int i = 0; i < 4; ++i)
    lidars.push_back(lidar_at("sim:?seed=" + std::to_string(i), std::to_string(i), mounting{}));
  begin(std::move(lidars), {.gives_points = true});
  ASSERT_TRUE(comes_true([&] { return in_reader.calls > 300 && in_own_thread.calls > 300; }));
  std::thread other([&] { service->stop(); });
  service->stop();
  const std::pair calls(in_reader.calls.load(), in_own_thread.calls.load());
  std::this_thread::sleep_for(300ms);
  EXPECT_EQ(std::pair(in_reader.calls.load(), in_own_thread.calls.load()), calls);
  other.join();
  EXPECT_EQ(in_reader.most_at_once, 1);
  EXPECT_EQ(in_own_thread.most_at_once, 1);
}

TEST_F(ServiceSinks, StartsOnce) {
  begin("sim:");
  EXPECT_TRUE(service->start());
  ASSERT_TRUE(heard.wait_for_scans(2));
  service->stop();
  const auto again = service->start();
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error(), problem::gone);
}

TEST_F(ServiceSinks, ReadsAllSettings_IfThatIsWanted) {
  begin("sim:?seed=2", {.reads_settings = true});
  ASSERT_TRUE(heard.wait([&] { return !heard.values.empty(); }));
  EXPECT_EQ(heard.values.front(), "");
  EXPECT_EQ(value("frequency"), parameter_value(7.0));
  EXPECT_EQ(value("model"), parameter_value(std::string("g4")));
  EXPECT_EQ(service->model(0), &g4_model);
}

TEST_F(ServiceSinks, MotorsRestWhileNothingIsWanted) {
  auto device = plug_in();
  heard.want({});
  begin(port(), {.is_standby = true});
  ASSERT_TRUE(heard.wait_for_state(reader_state::resting));
  for (const service_demand& demand :
       {service_demand{.for_grid = true}, service_demand{.runs = true}}) {
    heard.want(demand);
    ASSERT_TRUE(heard.wait_for_scans(1));
    EXPECT_TRUE(is_scanning(device));
    heard.want({});
    ASSERT_TRUE(heard.wait_for_state(reader_state::resting));
    EXPECT_FALSE(is_scanning(device));
  }
  const auto log_size = [&] {
    std::size_t size = 0;
    device.with([&](sim::device& simulated, std::int64_t) { size = simulated.log().size(); });
    return size;
  };
  const std::size_t before = log_size();
  std::this_thread::sleep_for(300ms);
  EXPECT_EQ(log_size(), before) << "it is left alone";
}

TEST_F(ServiceSinks, WithoutStandby_MotorsRunAlsoIfNothingIsWanted) {
  heard.want({});
  begin("sim:");
  EXPECT_TRUE(heard.wait_for_scans(2));
}

TEST_F(ServiceSinks, Allow_ForbidsMotorsWhateverIsWanted) {
  auto device = plug_in();
  make({lidar_at(port())}, {.is_standby = true});
  service->allow(false);
  ASSERT_TRUE(service->start());
  ASSERT_TRUE(heard.wait_for_state(reader_state::resting));
  EXPECT_TRUE(heard.scans.empty());
  for (int i = 0; i < 2; ++i) {
    service->allow(true);
    ASSERT_TRUE(heard.wait_for_scans(1));
    service->allow(false);
    ASSERT_TRUE(heard.wait_for_state(reader_state::resting));
    EXPECT_FALSE(is_scanning(device));
  }
  // The last word counts, however fast they follow each other.
  for (int i = 0; i < 100; ++i) service->allow(i % 2 == 0);
  service->allow(true);
  EXPECT_TRUE(heard.wait_for_scans(2));
}

TEST_F(ServiceSinks, AFileIsPausedAndGoesOn) {
  service_lidar one = lidar_at(recording());
  one.options.playback.speed = 1;
  begin({one});
  ASSERT_TRUE(heard.wait_for_scans(2));
  service->pause(true);
  ASSERT_TRUE(comes_true([&] { return service->status(0).playback->is_paused; }));
  const std::size_t before = heard.number_of_scans();
  service->seek(2 * second);
  ASSERT_TRUE(heard.wait([&] { return heard.scans.size() > before; }));
  EXPECT_FALSE(service->set_speed(-1));
  EXPECT_TRUE(service->set_speed(0));
  service->pause(false);
  EXPECT_TRUE(heard.wait_for_state(reader_state::ended));
}

}  // namespace
}  // namespace g4lidar::test
