// SPDX-License-Identifier: MIT
// Files that are played in C, and lidars that are read in a thread.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "c_handles.hpp"

namespace {

using namespace g4lidar_c_test;
using background = owned<g4lidar_background, g4lidar_background_free>;
using g4lidar::test::patience_ms;

constexpr std::int64_t second = 1'000'000'000;

/// A recording of four seconds of a simulated lidar.
class CPlayer : public testing::Test {
 protected:
  void SetUp() override {
    const simulator device = simulate("sim:?seed=5");
    g4lidar_recorder* into = nullptr;
    ASSERT_EQ(g4lidar_recorder_create(path_.c_str(), nullptr, &into, nullptr), G4LIDAR_OK);
    const recorder owner(into);
    g4lidar_options options = defaults();
    options.recorder = into;
    const lidar it = start_on(device, &options);
    while (g4lidar_simulator_get_state(device.get())->time_ns < 4 * second) next_whole(it);
  }

  lidar play() {
    g4lidar_lidar* made = nullptr;
    g4lidar_error why;
    EXPECT_EQ(g4lidar_open(path_.c_str(), &made, &why), G4LIDAR_OK) << why.message;
    EXPECT_EQ(g4lidar_start(made, &why), G4LIDAR_OK) << why.message;
    return lidar(made);
  }

  scratch scratch_;
  std::string path_ = scratch_.path("walk.mcap");
};

/// The thread that reads this lidar.
background read(const lidar& from, bool newest_only) {
  g4lidar_background* made = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_background_start(from.get(), newest_only, &made, &why), G4LIDAR_OK)
      << why.message;
  return background(made);
}

/// Waits until it is true. The pause lets the reader's thread run under valgrind, which runs one thread at a time.
template <class Condition>
void wait_until(Condition is_true) {
  const std::int64_t until_ns = g4lidar_now_ns() + patience_ms * 1'000'000LL;
  while (!is_true() && g4lidar_now_ns() < until_ns) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// Waits for the state.
void expect_state(const background& of, int state) {
  wait_until([&] { return g4lidar_background_get_state(of.get()) == state; });
  EXPECT_EQ(g4lidar_background_get_state(of.get()), state);
}

TEST_F(CPlayer, PausesAndGoesOn) {
  const lidar it = play();
  const g4lidar_scan* scan = nullptr;
  ASSERT_EQ(g4lidar_try_scan(it.get(), patience_ms, &scan, nullptr), G4LIDAR_OK);
  const std::uint32_t first = scan->revolution;
  ASSERT_EQ(g4lidar_pause(it.get(), true, nullptr), G4LIDAR_OK);
  EXPECT_TRUE(g4lidar_get_playback(it.get())->is_paused);
  EXPECT_EQ(g4lidar_try_scan(it.get(), 20, &scan, nullptr), G4LIDAR_TIMEOUT);
  ASSERT_EQ(g4lidar_pause(it.get(), false, nullptr), G4LIDAR_OK);
  ASSERT_EQ(g4lidar_try_scan(it.get(), patience_ms, &scan, nullptr), G4LIDAR_OK);
  EXPECT_EQ(scan->revolution, first + 1);
}

TEST_F(CPlayer, ChangesItsSpeedAndLoops) {
  const lidar it = play();
  g4lidar_error why;
  EXPECT_EQ(g4lidar_get_playback(it.get())->speed, 0.0);
  EXPECT_EQ(g4lidar_set_speed(it.get(), -1.0, &why), G4LIDAR_BAD_OPTION);
  ASSERT_EQ(g4lidar_set_speed(it.get(), 10.0, &why), G4LIDAR_OK) << why.message;
  EXPECT_EQ(g4lidar_get_playback(it.get())->speed, 10.0);
  const std::int64_t begin_ns = g4lidar_now_ns();
  const g4lidar_scan* scan = nullptr;
  while (g4lidar_try_scan(it.get(), patience_ms, &scan, &why) == G4LIDAR_OK) {
  }
  EXPECT_EQ(why.code, G4LIDAR_END_OF_INPUT) << why.message;
  EXPECT_GT(g4lidar_now_ns() - begin_ns, second / 5);  // four seconds at ten times the speed
  ASSERT_EQ(g4lidar_set_loop(it.get(), true, nullptr), G4LIDAR_OK);
  ASSERT_EQ(g4lidar_set_speed(it.get(), 0.0, nullptr), G4LIDAR_OK);
  ASSERT_EQ(g4lidar_seek(it.get(), 0, nullptr), G4LIDAR_OK);
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;
  while (last_ns - first_ns < 9 * second) {  // more than twice its length
    ASSERT_EQ(g4lidar_try_scan(it.get(), patience_ms, &scan, nullptr), G4LIDAR_OK);
    if (first_ns == 0) first_ns = scan->time_ns;
    EXPECT_GT(scan->time_ns, last_ns);
    last_ns = scan->time_ns;
  }
}

TEST_F(CPlayer, KnowsWhereItIs) {
  const lidar it = play();
  ASSERT_EQ(g4lidar_seek(it.get(), 2 * second, nullptr), G4LIDAR_OK);
  EXPECT_EQ(g4lidar_get_playback(it.get())->position_ns, 2 * second);
  const g4lidar_scan* scan = nullptr;
  ASSERT_EQ(g4lidar_try_scan(it.get(), patience_ms, &scan, nullptr), G4LIDAR_OK);
  const g4lidar_playback now = *g4lidar_get_playback(it.get());
  EXPECT_NEAR(static_cast<double>(now.length_ns), 4e9, 2e8);
  EXPECT_GE(now.position_ns, scan->end_ns - now.begin_ns);
  EXPECT_LT(now.position_ns, scan->end_ns - now.begin_ns + second / 5);
  // The wall clock is that of the recording, which began with the virtual time.
  const std::int64_t wall_ns = g4lidar_wall_ns(it.get(), now.begin_ns);
  g4lidar_reader* made = nullptr;
  ASSERT_EQ(g4lidar_reader_open(path_.c_str(), &made, nullptr), G4LIDAR_OK);
  const reader items(made);
  const g4lidar_item* item = nullptr;
  ASSERT_EQ(g4lidar_reader_next(made, &item, nullptr), G4LIDAR_OK);
  EXPECT_EQ(wall_ns, item->wall_ns);
}

TEST_F(CPlayer, IsOnlyThatOfAFile) {
  const simulator device = simulate();
  const lidar it = open_on(device);
  EXPECT_EQ(g4lidar_get_playback(it.get()), nullptr);
  EXPECT_EQ(g4lidar_pause(it.get(), true, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_set_speed(it.get(), 1.0, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_set_loop(it.get(), true, nullptr), G4LIDAR_BAD_ARGUMENT);
}

TEST_F(CPlayer, IsControlledInAThread) {
  const lidar file = play();
  ASSERT_EQ(g4lidar_pause(file.get(), true, nullptr), G4LIDAR_OK);
  const background it = read(file, false);
  ASSERT_NE(it, nullptr);
  const g4lidar_scan* scan = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_background_next_scan(it.get(), 20, &scan, &why), G4LIDAR_TIMEOUT);
  EXPECT_EQ(g4lidar_background_seek(it.get(), 2 * second), G4LIDAR_OK);  // gives one scan
  ASSERT_EQ(g4lidar_background_next_scan(it.get(), patience_ms, &scan, &why), G4LIDAR_OK)
      << why.message;
  EXPECT_GT(scan->point_count, 100U);
  EXPECT_GE(g4lidar_background_get_playback(it.get())->position_ns, 2 * second);
  EXPECT_TRUE(g4lidar_background_get_playback(it.get())->is_paused);
  EXPECT_EQ(g4lidar_background_set_speed(it.get(), -1.0, &why), G4LIDAR_BAD_OPTION);
  EXPECT_EQ(g4lidar_background_set_speed(it.get(), 20.0, &why), G4LIDAR_OK);
  EXPECT_EQ(g4lidar_background_pause(it.get(), false), G4LIDAR_OK);
  int code = G4LIDAR_OK;
  while (code == G4LIDAR_OK) {
    code = g4lidar_background_next_scan(it.get(), patience_ms, &scan, &why);
  }
  EXPECT_EQ(code, G4LIDAR_END_OF_INPUT) << why.message;
  expect_state(it, G4LIDAR_ENDED);
}

/// Calls of a reader by its own thread, while it reads its file.
struct own_calls {
  std::atomic<g4lidar_background*> reader = nullptr;
  std::atomic<int> count = 0;
  std::mutex taking;  // scans, which one thread does at a time

  static bool make(void* context) {
    auto& self = *static_cast<own_calls*>(context);
    g4lidar_background* const of = self.reader;
    if (of == nullptr) return false;
    g4lidar_event event{};
    EXPECT_NE(g4lidar_background_get_state(of), 0);
    EXPECT_NE(g4lidar_background_next_event(of, &event), G4LIDAR_BAD_ARGUMENT);
    {
      const std::lock_guard lock(self.taking);
      EXPECT_NE(g4lidar_background_get_counts(of), nullptr);
      EXPECT_NE(g4lidar_background_get_playback(of), nullptr);
      // No scan comes while it waits: it does not wait.
      const std::int64_t begin_ns = g4lidar_now_ns();
      const g4lidar_scan* kept = nullptr;
      int code = G4LIDAR_OK;
      while (code == G4LIDAR_OK)
        code = g4lidar_background_next_scan(of, patience_ms, &kept, nullptr);
      EXPECT_TRUE(code == G4LIDAR_TIMEOUT || code == G4LIDAR_END_OF_INPUT) << code;
      EXPECT_LT(g4lidar_now_ns() - begin_ns, patience_ms * 500'000LL);
    }
    EXPECT_EQ(g4lidar_background_rest(of, true), G4LIDAR_OK);
    EXPECT_EQ(g4lidar_background_rest(of, false), G4LIDAR_OK);
    EXPECT_EQ(g4lidar_background_pause(of, true), G4LIDAR_OK);
    EXPECT_EQ(g4lidar_background_pause(of, false), G4LIDAR_OK);
    EXPECT_EQ(g4lidar_background_set_speed(of, 2.0, nullptr), G4LIDAR_OK);
    self.reader = nullptr;  // once
    EXPECT_EQ(g4lidar_background_seek(of, second), G4LIDAR_OK);
    ++self.count;
    return false;
  }
};

TEST_F(CPlayer, MayBeCalledByItsOwnThread) {
  own_calls calls;
  g4lidar_options options = defaults();
  options.device = path_.c_str();
  options.is_cancelled = own_calls::make;
  options.context = &calls;
  g4lidar_lidar* made = nullptr;
  g4lidar_error why;
  ASSERT_EQ(g4lidar_open_with(&options, &made, &why), G4LIDAR_OK) << why.message;
  const lidar file(made);
  const background it = read(file, false);
  ASSERT_NE(it, nullptr);
  calls.reader = it.get();
  const g4lidar_scan* scan = nullptr;
  EXPECT_EQ(g4lidar_background_seek(it.get(), 0), G4LIDAR_OK);  // the file is read again
  wait_until([&] {                                              // and on, as scans are taken
    const std::lock_guard lock(calls.taking);
    static_cast<void>(g4lidar_background_next_scan(it.get(), 0, &scan, &why));
    return calls.count > 0;
  });
  EXPECT_EQ(calls.count, 1);
  EXPECT_EQ(g4lidar_background_next_scan(it.get(), patience_ms, &scan, &why), G4LIDAR_OK)
      << why.message;
}

// After the end of the file, and before the first scan of the new place.
TEST_F(CPlayer, WaitsForAScanAfterASeek) {
  const background it = read(play(), true);
  ASSERT_NE(it, nullptr);
  expect_state(it, G4LIDAR_ENDED);
  const g4lidar_scan* scan = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_background_next_scan(it.get(), 0, &scan, &why), G4LIDAR_OK) << why.message;
  EXPECT_EQ(g4lidar_background_set_speed(it.get(), 0.5, &why), G4LIDAR_OK);
  EXPECT_EQ(g4lidar_background_seek(it.get(), 0), G4LIDAR_OK);
  expect_state(it, G4LIDAR_RUNNING);
  EXPECT_EQ(g4lidar_background_next_scan(it.get(), patience_ms, &scan, &why), G4LIDAR_OK)
      << why.message;
}

TEST(CBackground, ReadsALidarThatTheProgramNeedNotCall) {
  g4lidar_lidar* opened = nullptr;
  g4lidar_error why;
  ASSERT_EQ(g4lidar_open("sim:?seed=7", &opened, &why), G4LIDAR_OK) << why.message;
  const lidar given(opened);
  const background it = read(given, true);
  ASSERT_NE(it, nullptr);
  EXPECT_EQ(g4lidar_start(given.get(), nullptr), G4LIDAR_GONE);
  EXPECT_EQ(g4lidar_playback_info(given.get()), nullptr);
  // Nothing is taken, so that only the newest one is kept.
  wait_until([&] { return g4lidar_background_get_counts(it.get())->scans_missed >= 3; });
  const g4lidar_scan* scan = nullptr;
  ASSERT_EQ(g4lidar_background_next_scan(it.get(), patience_ms, &scan, &why), G4LIDAR_OK);
  EXPECT_GE(scan->revolution, 3U);
  EXPECT_STREQ(scan->model, "g4");
  expect_state(it, G4LIDAR_RUNNING);
  EXPECT_EQ(g4lidar_background_get_playback(it.get()), nullptr);
  EXPECT_EQ(g4lidar_background_rest(it.get(), true), G4LIDAR_OK);
  expect_state(it, G4LIDAR_RESTING);
}

TEST(CBackground, ReportsALossAndTheReturn) {
  g4lidar_simulator_options how;
  g4lidar_simulator_options_init(&how, sizeof how);
  g4lidar_simulator* made = nullptr;
  ASSERT_EQ(g4lidar_simulator_create(&how, &made, nullptr), G4LIDAR_OK);
  const simulator device(made);
  g4lidar_options options = defaults();
  options.reconnect = true;
  const background it = read(open_on(device, &options), false);  // outlives the handle
  ASSERT_NE(it, nullptr);
  g4lidar_event event{};
  const auto wait_for = [&](int kind) {
    wait_until([&] {
      static_cast<void>(g4lidar_background_next_event(it.get(), &event));
      return event.kind == kind;
    });
    EXPECT_EQ(event.kind, kind);
  };
  ASSERT_EQ(g4lidar_simulator_unplug(device.get()), G4LIDAR_OK);
  expect_state(it, G4LIDAR_LOST);
  wait_for(G4LIDAR_EVENT_LOST);
  ASSERT_EQ(g4lidar_simulator_replug(device.get()), G4LIDAR_OK);
  wait_for(G4LIDAR_EVENT_RECONNECTED);
  expect_state(it, G4LIDAR_RUNNING);
}

TEST(CBackground, RefusesWhatBelongsToAnotherThread) {
  const simulator device = simulate();
  const lidar it = open_on(device);
  g4lidar_background* made = nullptr;
  EXPECT_EQ(g4lidar_background_start(it.get(), false, &made, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(made, nullptr);
  EXPECT_EQ(g4lidar_start(it.get(), nullptr), G4LIDAR_OK);  // nothing was taken
}

}  // namespace
