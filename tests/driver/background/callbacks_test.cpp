// SPDX-License-Identifier: MIT
// Every function of a reader, called in every function that its thread calls.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "g4lidar/background_reader.hpp"
#include "g4lidar/diagnostics/running_diagnosis.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "g4lidar/transport/transport.hpp"
#include "reader_record.hpp"
#include "recording/recorded_run.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

/// Where the program's code runs in the thread of a reader.
enum class place { on_open, on_scan, on_points, on_event, on_state, ask, wrap, is_cancelled };

constexpr std::string_view name_of(place where) {
  constexpr std::array<std::string_view, 8> names{
      "on_open", "on_scan", "on_points", "on_event", "on_state", "ask", "wrap", "is_cancelled"};
  return names[static_cast<std::size_t>(where)];
}

/// Calls `act` at one place, the first time that the thread is there, and counts what comes to the listener then.
class acting : public reader_listener {
 public:
  void on_open(lidar& device) override { at(place::on_open, &device); }
  void on_scan(const scan& /*found*/) override { at(place::on_scan); }
  void on_points(std::span<const point> /*found*/) override { at(place::on_points); }
  void on_event(const lidar_event& /*what*/) override { at(place::on_event); }
  void on_state(reader_state /*state*/, const std::optional<error>& /*why*/) override {
    at(place::on_state);
  }
  void at(place here, lidar* device = nullptr) {
    if (is_done_) ++calls_after;
    if (here != where || std::exchange(is_done_, true)) return;
    act(device);
    done.set_value();
  }

  place where{};
  std::function<void(lidar*)> act;
  std::promise<void> done;
  std::atomic<int> calls_after = 0;

 private:
  bool is_done_ = false;  // of the thread
};

/// A reader of a lidar that is unplugged for a moment, or of a file where the code runs while a file is read.
class Callbacks : public ::testing::TestWithParam<place> {
 protected:
  /// Starts it; `act` runs at the place.
  void begin(std::function<void(lidar*)> act) {
    heard_.where = GetParam();
    heard_.act = std::move(act);
    acted_ = heard_.done.get_future();
    // Destroyed with the options, when the thread holds nothing any more.
    const auto gone = std::make_shared<std::promise<void>>();
    is_gone_ = gone->get_future();
    const std::shared_ptr<void> last(nullptr, [gone](void*) { gone->set_value(); });
    lidar_options options{.device = "sim:?fault=unplug@900ms+300ms&standstill_ns=10ms",
                          .reconnect = true};
    if (GetParam() == place::is_cancelled) {
      auto writer = recording_writer::create(file_.text());
      ASSERT_TRUE(writer);
      record_device(*writer, 4'000'000'000);
      options = {.device = file_.text(), .playback = {.speed = 1, .loop = true}};
    }
    options.wrap = [this, last](std::unique_ptr<connector> from) {
      auto observed = judge.observe(std::move(from));
      heard_.at(place::wrap);
      return result<std::unique_ptr<connector>>(std::move(observed));
    };
    if (GetParam() == place::is_cancelled) {
      options.is_cancelled = [this] {
        heard_.at(place::is_cancelled);
        return false;
      };
    }
    reader =
        std::make_unique<background_reader>(options, reader_options{.wants_points = true}, &heard_);
    auto* const made = reader.get();
    ASSERT_TRUE(made->start());
    if (GetParam() == place::ask) ask_once(*made);
  }
  void ask_once(background_reader& of) {
    of.ask([this](lidar* device) { heard_.at(place::ask, device); });
  }
  bool has_acted() { return acted_.wait_for(patience) == std::future_status::ready; }
  /// Whether the thread has ended and holds nothing.
  bool is_gone() { return is_gone_.wait_for(patience) == std::future_status::ready; }
  [[nodiscard]] int calls_after() const { return heard_.calls_after; }

  running_diagnosis judge;

 private:
  temporary_path file_;
  acting heard_;
  std::future<void> acted_;
  std::future<void> is_gone_;

 protected:
  std::unique_ptr<background_reader> reader;  // destroyed first
};

TEST_P(Callbacks, EveryFunctionThatMayBeCalledThere) {
  std::vector<std::string> wrong;
  std::atomic<bool> is_asked = false;
  const auto expect = [&](bool is_so, const char* what) {
    if (!is_so) wrong.emplace_back(what);
  };
  std::mutex is_made;  // `reader` is set when begin() has returned
  is_made.lock();
  begin([&](lidar* device) {
    const std::lock_guard lock(is_made);
    background_reader& of = *reader;
    expect(of.start().has_value(), "a second start() does nothing");
    const auto begun = std::chrono::steady_clock::now();
    expect(of.next_scan(lidar::milliseconds::max()).error() == problem::timeout, "next_scan()");
    expect(std::chrono::steady_clock::now() - begun < patience, "next_scan() does not wait");
    expect(of.points().written() == 0, "points()");
    expect(!of.failed(), "failed()");
    expect(of.counts().points_missed <= of.counts().stream.points, "counts()");
    expect(!of.next_event(), "next_event()");
    expect(of.status().state != reader_state::ended, "status()");
    expect(of.wall_ns(0) != 0, "wall_ns()");
    of.rest(true);
    of.rest(false);
    of.pause(true);
    of.pause(false);
    expect(of.set_speed(2).has_value(), "set_speed()");
    of.seek(0);
    of.ask([&](lidar*) { is_asked = true; });
    expect(!is_asked, "ask() calls it later");
    expect(!judge.stages().empty(), "stages() of the diagnosis");
    if (device == nullptr) return;
    device->wake();
    expect(device->points().written() < 1'000'000'000, "the ring of the lidar");
  });
  is_made.unlock();
  ASSERT_TRUE(has_acted());
  EXPECT_TRUE(wrong.empty()) << wrong.front();
  EXPECT_TRUE(comes_true([&] { return is_asked.load(); })) << "the thread goes on";
  const std::uint64_t before = reader->counts().scans;
  EXPECT_TRUE(comes_true([&] { return reader->counts().scans > before + 2; })) << "scans come";
  reader->stop();
  EXPECT_FALSE(reader->failed());
}

TEST_P(Callbacks, Stop_IsTheLastCall) {
  std::mutex is_made;
  is_made.lock();
  std::atomic<bool> is_asked = false;
  begin([&](lidar*) {
    const std::lock_guard lock(is_made);
    reader->ask([&](lidar*) { is_asked = true; });
    reader->stop();
    reader->stop();
    reader->ask([&](lidar*) { is_asked = true; });
    EXPECT_EQ(reader->start().error(), problem::gone);
  });
  is_made.unlock();
  ASSERT_TRUE(has_acted());
  reader->stop();  // waits for the thread
  EXPECT_FALSE(is_asked);
  EXPECT_EQ(reader->start().error(), problem::gone);
  EXPECT_EQ(reader->next_scan(patience).error(), problem::not_scanning);
  reader.reset();
  EXPECT_TRUE(is_gone());
  EXPECT_EQ(calls_after(), 0);
}

TEST_P(Callbacks, Destruction_EndsTheThread) {
  std::mutex is_made;
  is_made.lock();
  begin([&](lidar*) {
    const std::lock_guard lock(is_made);
    reader.reset();
  });
  is_made.unlock();
  ASSERT_TRUE(has_acted());
  EXPECT_TRUE(is_gone());
  EXPECT_EQ(calls_after(), 0);
}

TEST_P(Callbacks, Assignment_EndsTheThread) {
  std::mutex is_made;
  is_made.lock();
  begin([&](lidar*) {
    const std::lock_guard lock(is_made);
    *reader = background_reader({.device = "sim:"});
  });
  is_made.unlock();
  ASSERT_TRUE(has_acted());
  EXPECT_TRUE(is_gone());
  EXPECT_EQ(calls_after(), 0);
  ASSERT_TRUE(reader->start()) << "the other one";
  EXPECT_TRUE(reader->next_scan(patience));
}

INSTANTIATE_TEST_SUITE_P(In, Callbacks,
                         ::testing::Values(place::on_open, place::on_scan, place::on_points,
                                           place::on_event, place::on_state, place::ask,
                                           place::wrap, place::is_cancelled),
                         [](const auto& of) { return std::string(name_of(of.param)); });

/// Stops its reader after ten scans.
class ten_scans final : public reader_listener {
 public:
  void on_scan(const scan& /*found*/) override {
    if (++scans == 10) of->stop();
    if (scans == 10) tenth.set_value();
  }
  background_reader* of = nullptr;
  std::promise<void> tenth;
  int scans = 0;
};

TEST(BackgroundReader, StoppedAfterTheTenthScan_GivesTen) {
  const temporary_path port("port");
  auto device = *sim::background_pty::open(sim::device(sim::built_in_world()), port.text());
  ten_scans heard;
  background_reader reader({.device = port.text()}, {}, &heard);
  heard.of = &reader;
  ASSERT_TRUE(reader.start());
  ASSERT_EQ(heard.tenth.get_future().wait_for(patience), std::future_status::ready);
  reader.stop();
  EXPECT_EQ(heard.scans, 10);
  bool is_scanning = true;
  device.with([&](sim::device& simulated, std::int64_t now_ns) {
    static_cast<void>(simulated.available(now_ns));
    is_scanning = simulated.is_scanning();
  });
  EXPECT_FALSE(is_scanning) << "the motor stands";
}

TEST(BackgroundReader, StartAndStopByManyThreads) {
  for (int round = 0; round < 5; ++round) {
    reader_record heard;
    background_reader reader({.device = "sim:"}, {}, &heard);
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&] { EXPECT_TRUE(reader.start()); });
    }
    for (std::thread& each : threads) each.join();
    EXPECT_TRUE(heard.wait([&] { return heard.opened > 0; }));
    threads.clear();
    reader.ask([&](lidar*) { reader.stop(); });
    for (int i = 0; i < 4; ++i) threads.emplace_back([&] { reader.stop(); });
    for (std::thread& each : threads) each.join();
    EXPECT_EQ(heard.opened, 1);
  }
}

TEST(BackgroundReader, OfAGivenLidar_InAFunctionOfAsk) {
  auto lidar = lidar::open("sim:");
  ASSERT_TRUE(lidar);
  auto made = background_reader::start(std::move(*lidar));
  ASSERT_TRUE(made);
  auto reader = std::make_unique<background_reader>(std::move(*made));
  EXPECT_TRUE(reader->start()) << "it runs already";
  ASSERT_TRUE(reader->next_scan(patience));
  std::promise<void> done;
  reader->ask([&](g4lidar::lidar* device) {
    EXPECT_NE(device, nullptr);
    EXPECT_TRUE(reader->start());
    while (reader->next_scan(lidar::milliseconds::max())) {  // those that have come
    }
    reader->stop();
    done.set_value();
  });
  ASSERT_EQ(done.get_future().wait_for(patience), std::future_status::ready);
  while (reader->next_scan(patience)) {
  }
  EXPECT_EQ(reader->next_scan(patience).error(), problem::not_scanning);
  EXPECT_EQ(reader->start().error(), problem::gone);
}

}  // namespace
}  // namespace g4lidar::test
