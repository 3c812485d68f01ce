// SPDX-License-Identifier: MIT
// Reading a recording in C can be cancelled, and continued; a wait for a device can be cancelled. The file has
// a chunk that unpacks to 64 MiB.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "c_handles.hpp"
#include "support/hostile_mcap.hpp"

namespace {

using namespace g4lidar_c_test;

/// What is asked, and what it answers.
struct question {
  bool is_cancelled = false;
  int asked = 0;

  static bool ask(void* context) {
    auto& self = *static_cast<question*>(context);
    ++self.asked;
    return self.is_cancelled;
  }
};

class CCancel : public testing::Test {
 protected:
  void SetUp() override {
    if (!g4lidar_has_feature("zstd")) GTEST_SKIP() << "without zstd";
    write_file();
    g4lidar_reader_options_init(&options_, sizeof options_);
    options_.is_cancelled = question::ask;
    options_.context = &question_;
  }
  reader open() {
    g4lidar_reader* opened = nullptr;
    g4lidar_error why;
    EXPECT_EQ(g4lidar_reader_open_with(path_.c_str(), &options_, &opened, &why), G4LIDAR_OK)
        << why.message;
    return reader(opened);
  }

  /// 400 items, and a chunk without items between the first and the last 200.
  void write_file() {
    std::size_t middle = 0;
    {
      g4lidar_recorder* created = nullptr;
      ASSERT_EQ(g4lidar_recorder_create(path_.c_str(), nullptr, &created, nullptr), G4LIDAR_OK);
      const recorder into(created);
      for (std::uint8_t i = 0; i < 200; ++i) record(into, i);
      ASSERT_EQ(g4lidar_recorder_flush(into.get(), nullptr), G4LIDAR_OK);
      middle = text().size();
      for (std::uint8_t i = 0; i < 200; ++i) record(into, i);
    }
    const std::string changed = text().insert(middle, g4lidar::test::chunk_of_a_foreign_message());
    std::ofstream(path_, std::ios::binary) << changed;
  }
  void record(const recorder& into, std::uint8_t value) {
    time_ns_ += 1'000'000;
    ASSERT_EQ(g4lidar_recorder_bytes(into.get(), false, &value, 1, time_ns_), G4LIDAR_OK);
  }
  std::string text() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  scratch scratch_;
  std::string path_ = scratch_.path("hostile.mcap");
  std::int64_t time_ns_ = 0;
  question question_;
  g4lidar_reader_options options_{};
};

TEST_F(CCancel, OpeningGivesNoReader) {
  question_.is_cancelled = true;
  g4lidar_reader* opened = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_reader_open_with(path_.c_str(), &options_, &opened, &why), G4LIDAR_CANCELLED);
  EXPECT_EQ(opened, nullptr);
  EXPECT_GT(question_.asked, 0);
}

TEST_F(CCancel, TheNextCallContinues) {
  const reader from = open();
  int items = 0;
  int cancelled = 0;
  const g4lidar_item* item = nullptr;
  g4lidar_error why;
  for (int code = G4LIDAR_OK; code != G4LIDAR_END_OF_INPUT;) {
    question_.is_cancelled = items == 200 && cancelled < 2;
    code = g4lidar_reader_next(from.get(), &item, &why);
    if (code == G4LIDAR_CANCELLED) {
      ++cancelled;
    } else if (code == G4LIDAR_OK) {
      items += item->kind == G4LIDAR_ITEM_FROM_DEVICE ? 1 : 0;
    } else {
      ASSERT_EQ(code, G4LIDAR_END_OF_INPUT) << why.message;
    }
  }
  EXPECT_EQ(items, 400);
  EXPECT_EQ(cancelled, 2);
}

TEST_F(CCancel, ASeekLeavesTheReaderWhereItWas) {
  const reader from = open();
  const g4lidar_item* item = nullptr;
  do {
    ASSERT_EQ(g4lidar_reader_next(from.get(), &item, nullptr), G4LIDAR_OK);
  } while (item->kind != G4LIDAR_ITEM_FROM_DEVICE || *item->data < 50);
  question_.is_cancelled = true;
  EXPECT_EQ(g4lidar_reader_seek(from.get(), 300'000'000, nullptr), G4LIDAR_CANCELLED);
  question_.is_cancelled = false;
  ASSERT_EQ(g4lidar_reader_next(from.get(), &item, nullptr), G4LIDAR_OK);
  EXPECT_EQ(*item->data, 51);
  ASSERT_EQ(g4lidar_reader_seek(from.get(), 300'000'000, nullptr), G4LIDAR_OK);
  ASSERT_EQ(g4lidar_reader_next(from.get(), &item, nullptr), G4LIDAR_OK);
  EXPECT_GT(item->time_ns, 299'000'000);
}

TEST_F(CCancel, OpeningALidarGivesNone) {
  g4lidar_playback_options playback;
  g4lidar_playback_options_init(&playback, sizeof playback);
  playback.is_cancelled = question::ask;
  playback.context = &question_;
  question_.is_cancelled = true;
  g4lidar_lidar* opened = nullptr;
  EXPECT_EQ(g4lidar_open_recording(path_.c_str(), &playback, nullptr, &opened, nullptr),
            G4LIDAR_CANCELLED);
  EXPECT_EQ(opened, nullptr);
  question_.is_cancelled = false;
  EXPECT_EQ(g4lidar_open_recording(path_.c_str(), &playback, nullptr, &opened, nullptr),
            G4LIDAR_OK);
  g4lidar_free(opened);
}

TEST_F(CCancel, TheQuestionOfTheOptionsIsAskedIfPlaybackHasNone) {
  g4lidar_options options = defaults();
  options.is_cancelled = question::ask;
  options.context = &question_;
  question_.is_cancelled = true;
  g4lidar_lidar* opened = nullptr;
  EXPECT_EQ(g4lidar_open_recording(path_.c_str(), nullptr, &options, &opened, nullptr),
            G4LIDAR_CANCELLED);
  EXPECT_EQ(opened, nullptr);
  const int asked = question_.asked;
  EXPECT_GT(asked, 0);
  g4lidar_playback_options playback;
  g4lidar_playback_options_init(&playback, sizeof playback);
  playback.is_cancelled = [](void*) { return false; };
  EXPECT_EQ(g4lidar_open_recording(path_.c_str(), &playback, &options, &opened, nullptr),
            G4LIDAR_OK);
  g4lidar_free(opened);
  EXPECT_EQ(question_.asked, asked);
}

/// Options that wait for a port that never comes.
g4lidar_options waiting(const std::string& port, std::int32_t wait_ms) {
  g4lidar_options options = defaults();
  options.device = port.c_str();
  options.device_wait_ms = wait_ms;
  return options;
}

TEST(CWaitForADevice, AnotherThreadEndsIt) {
  using namespace std::chrono_literals;
  const scratch directory;
  const std::string port = directory.path("ttyUSB0");
  g4lidar_options options = waiting(port, -1);
  std::atomic<bool> is_over = false;
  options.is_cancelled = [](void* context) {
    return static_cast<std::atomic<bool>*>(context)->load();
  };
  options.context = &is_over;
  const auto begin = std::chrono::steady_clock::now();
  std::thread other([&] {
    std::this_thread::sleep_for(200ms);
    is_over = true;
  });
  g4lidar_lidar* made = nullptr;
  g4lidar_error why;
  EXPECT_EQ(g4lidar_open_with(&options, &made, &why), G4LIDAR_CANCELLED);
  const auto took = std::chrono::steady_clock::now() - begin;
  other.join();
  EXPECT_EQ(made, nullptr);
  EXPECT_EQ(why.task, G4LIDAR_OPENING);
  EXPECT_STREQ(why.subject, port.c_str());
  EXPECT_GE(took, 200ms);
  EXPECT_LT(took, g4lidar::test::patience);
}

// It has options that end before the function, in whatever memory follows.
TEST(CWaitForADevice, AnOlderProgramIsNotAsked) {
  const scratch directory;
  const std::string port = directory.path("ttyUSB0");
  g4lidar_options options = waiting(port, 100);
  question asked{.is_cancelled = true};
  options.is_cancelled = question::ask;
  options.context = &asked;
  options.struct_size = offsetof(g4lidar_options, is_cancelled);
  g4lidar_lidar* made = nullptr;
  EXPECT_EQ(g4lidar_open_with(&options, &made, nullptr), G4LIDAR_NO_PORT);
  EXPECT_EQ(asked.asked, 0);
  options.struct_size = sizeof options;
  EXPECT_EQ(g4lidar_open_with(&options, &made, nullptr), G4LIDAR_CANCELLED);
  EXPECT_EQ(asked.asked, 1);
  EXPECT_EQ(made, nullptr);
}

}  // namespace
