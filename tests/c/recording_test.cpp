// SPDX-License-Identifier: MIT
// Recordings in C: what is recorded is what was read; seeking; damage.
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "c_handles.hpp"

namespace {

using namespace g4lidar_c_test;

constexpr std::int64_t second = 1'000'000'000;

recorder record_to(const std::string& path, const g4lidar_recorder_options* options = nullptr) {
  g4lidar_recorder* made = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_recorder_create(path.c_str(), options, &made, &why), G4LIDAR_OK) << why.message;
  return recorder(made);
}

lidar play(const std::string& path, const g4lidar_playback_options* options = nullptr) {
  g4lidar_lidar* made = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_open_recording(path.c_str(), options, nullptr, &made, &why), G4LIDAR_OK)
      << why.message;
  EXPECT_EQ(g4lidar_start(made, &why), G4LIDAR_OK) << why.message;
  return lidar(made);
}

/// All points from here to the end.
std::vector<g4lidar_point> all_points(const lidar& from) {
  std::vector<g4lidar_point> all;
  const g4lidar_point* some = nullptr;
  std::size_t count = 0;
  g4lidar_error why;
  while (g4lidar_next_points(from.get(), 1000, &some, &count, &why) == G4LIDAR_OK) {
    all.insert(all.end(), some, some + count);
  }
  EXPECT_EQ(why.code, G4LIDAR_END_OF_INPUT) << why.message;
  return all;
}

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class CRecording : public testing::Test {
 protected:
  /// Records three seconds of a simulated lidar, and returns its points.
  std::vector<g4lidar_point> record() {
    const simulator device = simulate("sim:?seed=5&serial=2021101000070111");
    const recorder into = record_to(path_);
    g4lidar_options options = defaults();
    options.recorder = into.get();
    std::vector<g4lidar_point> all;
    const lidar it = start_on(device, &options);
    const g4lidar_point* some = nullptr;
    std::size_t count = 0;
    while (g4lidar_simulator_get_state(device.get())->time_ns < 3 * second) {
      EXPECT_EQ(g4lidar_next_points(it.get(), 1000, &some, &count, nullptr), G4LIDAR_OK);
      all.insert(all.end(), some, some + count);
    }
    bytes_ = g4lidar_get_counts(it.get())->bytes;
    EXPECT_EQ(g4lidar_recorder_get_counts(into.get())->bytes_from_device, bytes_);
    g4lidar_release(it.get());  // nothing more is recorded
    EXPECT_EQ(g4lidar_recorder_close(into.get(), nullptr), G4LIDAR_OK);
    EXPECT_EQ(g4lidar_recorder_take_error(into.get(), nullptr), G4LIDAR_NOTHING);
    return all;
  }

  scratch scratch_;
  std::string path_ = scratch_.path("walk.mcap");
  std::uint64_t bytes_ = 0;
};

TEST_F(CRecording, PlaysTheSamePoints) {
  const auto live = record();
  ASSERT_GT(live.size(), 10'000U);
  EXPECT_TRUE(g4lidar_is_recording(path_.c_str()));
  const auto played = all_points(play(path_));
  ASSERT_GE(played.size(), live.size());
  EXPECT_EQ(std::memcmp(played.data(), live.data(), live.size() * sizeof(g4lidar_point)), 0);
}

TEST_F(CRecording, IsReadItemByItem) {
  record();
  g4lidar_reader* opened = nullptr;
  ASSERT_EQ(g4lidar_reader_open(path_.c_str(), &opened, nullptr), G4LIDAR_OK);
  const reader from(opened);
  std::uint64_t bytes = 0;
  std::size_t sent = 0;
  std::vector<std::string> events;
  const g4lidar_item* item = nullptr;
  g4lidar_error why;
  while (g4lidar_reader_next(from.get(), &item, &why) == G4LIDAR_OK) {
    if (item->kind == G4LIDAR_ITEM_FROM_DEVICE) bytes += item->size;
    if (item->kind == G4LIDAR_ITEM_TO_DEVICE) sent += item->size;
    if (item->kind == G4LIDAR_ITEM_EVENT) events.emplace_back(item->event_name);
    // The wall clock is that of the beginning, and runs as the virtual time.
    EXPECT_GT(item->wall_ns, std::int64_t{1'600'000'000} * second);
  }
  EXPECT_EQ(why.code, G4LIDAR_END_OF_INPUT);
  EXPECT_EQ(bytes, bytes_);
  EXPECT_GE(sent, 6U);
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.front(), "opened");
  const g4lidar_recording_info* info = g4lidar_reader_info(from.get());
  EXPECT_TRUE(info->has_identity);
  EXPECT_STREQ(info->identity.serial_number, "2021101000070111");
  EXPECT_EQ(info->size, std::filesystem::file_size(path_));
  EXPECT_FALSE(info->is_cut_off);
  EXPECT_NEAR(static_cast<double>(info->last_ns - info->first_ns), 3e9, 3e8);
  // Once more from 2 s on.
  ASSERT_EQ(g4lidar_reader_seek(from.get(), 2 * second, nullptr), G4LIDAR_OK);
  std::int64_t first_ns = 0;
  while (g4lidar_reader_next(from.get(), &item, nullptr) == G4LIDAR_OK) {
    if (item->kind == G4LIDAR_ITEM_FROM_DEVICE && first_ns == 0) first_ns = item->time_ns;
  }
  EXPECT_GE(first_ns, 2 * second);
  EXPECT_LT(first_ns, 2 * second + second / 5);
}

TEST_F(CRecording, ContinuesAtAnotherPlace) {
  const auto live = record();
  g4lidar_playback_options options;
  g4lidar_playback_options_init(&options, sizeof options);
  options.from_ns = 2 * second;
  const lidar part = play(path_, &options);
  const auto late = all_points(part);
  ASSERT_FALSE(late.empty());
  EXPECT_LT(late.size(), live.size() / 2);
  ASSERT_EQ(g4lidar_seek(part.get(), 0, nullptr), G4LIDAR_OK);
  const auto all = all_points(part);
  EXPECT_GE(all.size(), live.size());
  const g4lidar_recording_info* info = g4lidar_playback_info(part.get());
  ASSERT_NE(info, nullptr);
  EXPECT_GT(info->position, 0U);
  const simulator device = simulate();
  const lidar live_one = open_on(device);
  EXPECT_EQ(g4lidar_seek(live_one.get(), 0, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_playback_info(live_one.get()), nullptr);
}

TEST_F(CRecording, ContainsOdometryAndScans) {
  {
    const simulator device = simulate("sim:?seed=5", nullptr, "drive forward 1 0.5\n");
    g4lidar_recorder_options wanted;
    g4lidar_recorder_options_init(&wanted, sizeof wanted);
    const g4lidar_mounting mount{{0.1, 0.0, 0.0}, false, {}};
    wanted.mount = &mount;
    wanted.points_topic = "/points";
    wanted.compressed = g4lidar_has_feature("zstd");
    const recorder into = record_to(path_, &wanted);
    g4lidar_options options = defaults();
    options.recorder = into.get();
    const lidar it = start_on(device, &options);
    g4lidar_odometry odometry;
    for (int i = 0; i < 5; ++i) {
      ASSERT_NE(next_whole(it), nullptr);
      while (g4lidar_simulator_next_odometry(device.get(), &odometry) == G4LIDAR_OK) {
        ASSERT_EQ(g4lidar_recorder_odometry(into.get(), &odometry), G4LIDAR_OK);
      }
    }
    EXPECT_EQ(g4lidar_recorder_get_counts(into.get())->scans, 5U);
    EXPECT_GT(g4lidar_recorder_get_counts(into.get())->odometry, 40U);
    odometry.pose.x_m = 1e9;
    EXPECT_EQ(g4lidar_recorder_odometry(into.get(), &odometry), G4LIDAR_BAD_ARGUMENT);
  }
  g4lidar_reader* opened = nullptr;
  ASSERT_EQ(g4lidar_reader_open(path_.c_str(), &opened, nullptr), G4LIDAR_OK);
  const reader from(opened);
  const g4lidar_item* item = nullptr;
  double farthest_m = 0.0;
  while (g4lidar_reader_next(from.get(), &item, nullptr) == G4LIDAR_OK) {
    if (item->kind == G4LIDAR_ITEM_ODOMETRY) farthest_m = item->odometry.pose.x_m;
  }
  EXPECT_GT(farthest_m, 0.1);
  EXPECT_LE(farthest_m, 1.001);
}

TEST_F(CRecording, IsWrittenByItsOptions) {
  const auto run = [&](const char* name, std::int64_t seconds, auto change) {
    g4lidar_recorder_options wanted;
    g4lidar_recorder_options_init(&wanted, sizeof wanted);
    change(wanted);
    const simulator device = simulate();
    const recorder into = record_to(scratch_.path(name), &wanted);
    g4lidar_options options = defaults();
    options.recorder = into.get();
    const lidar it = start_on(device, &options);
    while (g4lidar_simulator_get_state(device.get())->time_ns < seconds * second) next_whole(it);
    EXPECT_EQ(g4lidar_recorder_close(into.get(), nullptr), G4LIDAR_OK);
    return *g4lidar_recorder_get_counts(into.get());
  };
  const auto has = [&](const char* name, const std::string& text) {
    std::ifstream file(scratch_.path(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {}).find(text) != std::string::npos;
  };
  EXPECT_GT(run("named.mcap", 5,
                [](auto& wanted) {
                  wanted.topic = "/front/scan";
                  wanted.frame_id = "front_laser";
                })
                .scans,
            10U);
  EXPECT_TRUE(has("named.mcap", "/front/scan"));
  EXPECT_TRUE(
      has("named.mcap", std::string("front_laser", 12)));  // in a message, with its zero byte
  EXPECT_EQ(run("bytes.mcap", 5, [](auto& wanted) { wanted.without_scans = true; }).scans, 0U);
  const g4lidar_recorder_counts one = run("one.mcap", 60, [](auto&) {});
  EXPECT_EQ(one.files, 1U);
  EXPECT_EQ(one.bytes_lost, 0U);
  EXPECT_EQ(one.file_bytes, std::filesystem::file_size(scratch_.path("one.mcap")));
  const auto by_size = run("sizes.mcap", 60, [](auto& wanted) { wanted.rotate_bytes = 1 << 20U; });
  EXPECT_GE(by_size.files, one.file_bytes >> 20U);
  EXPECT_GE(run("times.mcap", 60, [](auto& wanted) { wanted.rotate_s = 10; }).files, 5U);
  g4lidar_recorder_options wanted;
  g4lidar_recorder_options_init(&wanted, sizeof wanted);
  wanted.chunk_ms = 5;
  g4lidar_recorder* into = nullptr;
  EXPECT_EQ(g4lidar_recorder_create(path_.c_str(), &wanted, &into, nullptr), G4LIDAR_BAD_OPTION);
}

TEST_F(CRecording, IsPlayedByItsOptions) {
  const auto live = record();
  g4lidar_playback_options options;
  g4lidar_playback_options_init(&options, sizeof options);
  options.to_ns = second + second / 2;
  const auto half = all_points(play(path_, &options));
  EXPECT_GT(half.size(), live.size() / 3);
  EXPECT_LT(half.size(), live.size() * 2 / 3);
  options.loop = true;
  const lidar endless = play(path_, &options);
  const g4lidar_point* some = nullptr;
  std::size_t count = 0;
  std::size_t points = 0;
  std::int64_t last_ns = 0;
  while (points < 3 * half.size()) {
    ASSERT_EQ(g4lidar_next_points(endless.get(), 1000, &some, &count, nullptr), G4LIDAR_OK);
    EXPECT_GT(some->time_ns, last_ns);
    last_ns = some[count - 1].time_ns;
    points += count;
  }
  g4lidar_playback_options_init(&options, sizeof options);
  options.speed = 10.0;  // 3 s take at least 0.25 s
  const std::int64_t begin_ns = g4lidar_now_ns();
  all_points(play(path_, &options));
  EXPECT_GT(g4lidar_now_ns() - begin_ns, second / 4);
}

TEST_F(CRecording, DamageIsCounted) {
  record();
  {
    std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path_) / 2));
    file << "damage in the middle of a chunk";
  }
  const lidar damaged = play(path_);
  all_points(damaged);
  const g4lidar_recording_info info = *g4lidar_playback_info(damaged.get());
  EXPECT_GE(info.chunks_lost, 1U);
  EXPECT_GT(info.bytes_skipped, 1000U);
  EXPECT_LT(info.bytes_skipped, info.size / 2);
}

TEST_F(CRecording, TheRecorderMayBeReleasedFirst) {
  const simulator device = simulate();
  recorder into = record_to(path_);
  g4lidar_options options = defaults();
  options.recorder = into.get();
  const lidar it = start_on(device, &options);
  ASSERT_NE(next_whole(it), nullptr);
  into.reset();
  ASSERT_NE(next_whole(it), nullptr);
  EXPECT_TRUE(g4lidar_is_recording(path_.c_str()));
}

TEST_F(CRecording, RecordsBytesOfAProgram) {
  const recorder into = record_to(path_);
  const std::uint8_t bytes[3] = {1, 2, 3};
  ASSERT_EQ(g4lidar_recorder_bytes(into.get(), false, bytes, 3, 5 * second), G4LIDAR_OK);
  ASSERT_EQ(g4lidar_recorder_bytes(into.get(), true, bytes, 2, 6 * second), G4LIDAR_OK);
  ASSERT_EQ(g4lidar_recorder_flush(into.get(), nullptr), G4LIDAR_OK);
  EXPECT_EQ(g4lidar_recorder_get_counts(into.get())->bytes_from_device, 3U);
  EXPECT_EQ(g4lidar_recorder_get_counts(into.get())->bytes_to_device, 2U);
}

TEST_F(CRecording, ReplacesNeitherItsSourceNorItsWorld) {
  record();
  const std::string room = scratch_.path("room.txt");
  std::ofstream(room)
      << "wall 2 2 -2 2\nwall -2 2 -2 -2\nwall -2 -2 2 -2\nwall 2 -2 2 2\nlidar 0 0 0\n";
  g4lidar_recorder_options how;
  g4lidar_recorder_options_init(&how, sizeof how);
  how.overwrite = true;
  const std::string simulated = "sim:?world=" + room;
  for (const auto& [source, file] : {std::pair(path_, path_), std::pair(simulated, room)}) {
    const std::string before = contents(file);
    for (const bool by_name : {true, false}) {
      if (!by_name && file == room) continue;
      const recorder into = record_to(file, &how);
      g4lidar_options options = defaults();
      if (by_name) options.device = source.c_str();
      options.recorder = into.get();
      g4lidar_lidar* made = nullptr;
      g4lidar_error why;
      const int code = by_name
                           ? g4lidar_open_with(&options, &made, &why)
                           : g4lidar_open_recording(file.c_str(), nullptr, &options, &made, &why);
      EXPECT_EQ(code, G4LIDAR_BAD_OPTION) << why.message;
      EXPECT_EQ(made, nullptr);
    }
    EXPECT_EQ(contents(file), before);
  }
}

TEST_F(CRecording, FailsWithTheReason) {
  g4lidar_error why;
  g4lidar_reader* from = nullptr;
  EXPECT_EQ(g4lidar_reader_open(scratch_.path("none").c_str(), &from, &why), G4LIDAR_SYSTEM);
  EXPECT_NE(why.system_errno, 0);
  g4lidar_recorder* into = nullptr;
  EXPECT_EQ(g4lidar_recorder_create("/no/such/directory/x", nullptr, &into, &why), G4LIDAR_SYSTEM);
  record_to(path_).reset();
  EXPECT_EQ(g4lidar_recorder_create(path_.c_str(), nullptr, &into, &why), G4LIDAR_SYSTEM);
  EXPECT_EQ(why.system_errno, EEXIST);
  g4lidar_recorder_options wanted;
  g4lidar_recorder_options_init(&wanted, sizeof wanted);
  wanted.scan_bins = 65537;
  wanted.overwrite = true;
  EXPECT_EQ(g4lidar_recorder_create(path_.c_str(), &wanted, &into, &why), G4LIDAR_BAD_OPTION);
  EXPECT_EQ(into, nullptr);
  EXPECT_FALSE(g4lidar_is_recording("/dev/null"));
}

}  // namespace
