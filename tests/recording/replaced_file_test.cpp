// SPDX-License-Identifier: MIT
// A recording with the name of an existing file: when that is replaced, and when it stays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/transport/source.hpp"
#include "made_recording.hpp"
#include "support/packet_maker.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class ReplacedFile : public ::testing::Test {
 protected:
  ReplacedFile() {
    std::string made = testing::TempDir() + "g4lidar-XXXXXX";
    EXPECT_NE(::mkdtemp(made.data()), nullptr);
    directory_ = made;
    write(path_of("walk.mcap"), "dear");
    const made::packet packet(0, 64, 640, std::vector<std::uint16_t>(3, 4000));
    std::string bytes;
    for (int i = 0; i < 400; ++i) bytes.append(packet.data().begin(), packet.data().end());
    write(path_of("raw.bin"), bytes);
  }
  ~ReplacedFile() override { fs::remove_all(directory_); }

  [[nodiscard]] std::string path_of(const std::string& name) const { return directory_ / name; }
  static void write(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    const auto all = bytes_of(path_of(name));
    return {all.begin(), all.end()};
  }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(directory_), fs::directory_iterator()));
  }
  /// Reads all bytes of the source, as attempts to open a lidar do.
  void attempt(recording_writer& into) const {
    auto from = recorded(*open_raw_bytes(path_of("raw.bin"), 9000), into);
    ASSERT_TRUE(from) << from.error().message();
    const auto port = *(*from)->connect();
    std::array<std::uint8_t, 4096> memory{};
    while (port->read(memory, port->now_ns() + second)) {
    }
    EXPECT_GT(into.counts().bytes_from_device, 5000U);
  }

  fs::path directory_;
};

TEST_F(ReplacedFile, Stays_WhileALidarIsNotOpened) {
  for (const bool discards : {false, true}) {
    recording_writer writer =
        made_writer(path_of("walk.mcap"), {.overwrite = true, .chunk_time = 10ms});
    attempt(writer);
    EXPECT_GT(writer.counts().chunks, 1U);
    EXPECT_EQ(read("walk.mcap"), "dear");
    discards ? writer.discard() : static_cast<void>(writer.close());
    EXPECT_EQ(read("walk.mcap"), "dear");
    EXPECT_EQ(files(), 2U) << "nothing remains beside it";
  }
  {
    const recording_writer destroyed = made_writer(path_of("walk.mcap"), {.overwrite = true});
  }
  EXPECT_EQ(read("walk.mcap"), "dear");
  EXPECT_EQ(files(), 2U);
}

TEST_F(ReplacedFile, IsReplacedWhenAScanBegins) {
  recording_writer writer =
      made_writer(path_of("walk.mcap"), {.overwrite = true, .chunk_time = 10ms});
  attempt(writer);
  recorded_event begun{.what = recorded_event::kind::begun, .time_ns = 100 * second};
  begun.sample_rate_hz = 9000;
  const auto from = recorded(*open_raw_bytes(path_of("raw.bin"), 9000), writer);
  recording_hook_of(**from)->event(begun);
  begun.time_ns += second;
  recording_hook_of(**from)->event(begun);  // ends the chunk
  EXPECT_NE(read("walk.mcap"), "dear") << "before it is closed";
  ASSERT_TRUE(writer.close());
  const auto reader = recording_reader::open(path_of("walk.mcap"));
  ASSERT_TRUE(reader) << reader.error().message();
  EXPECT_EQ(files(), 2U);
}

TEST_F(ReplacedFile, IsReplacedByWhatACallerRecords_BehindALink) {
  ASSERT_EQ(::chmod(path_of("walk.mcap").c_str(), 0600), 0);
  fs::create_symlink("walk.mcap", path_of("link.mcap"));
  fs::create_hard_link(path_of("walk.mcap"), path_of("hard.mcap"));
  recording_writer writer = made_writer(path_of("link.mcap"), {.overwrite = true});
  EXPECT_EQ(writer.path(), path_of("link.mcap"));
  record_readings(writer, 0, 300);
  ASSERT_TRUE(writer.close());
  EXPECT_TRUE(fs::is_symlink(path_of("link.mcap")));
  EXPECT_EQ(contents_of_file(path_of("walk.mcap")).readings, numbers(0, 300));
  EXPECT_EQ(read("hard.mcap"), "dear") << "a file of another name stays";
  struct stat found{};
  ASSERT_EQ(::stat(path_of("walk.mcap").c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777U, 0600U);
  writer.discard();
  EXPECT_FALSE(fs::exists(path_of("walk.mcap"))) << "also after close()";
}

TEST_F(ReplacedFile, Discard_RemovesOnlyWhatWasRecorded) {
  recording_writer writer = made_writer(path_of("new.mcap"));
  record_readings(writer, 0, 100);
  fs::rename(path_of("new.mcap"), path_of("moved.mcap"));
  write(path_of("new.mcap"), "of somebody else");
  writer.discard();
  EXPECT_EQ(read("new.mcap"), "of somebody else");
  record_readings(writer, 100, 100);
  EXPECT_TRUE(writer.close());
  recording_writer other = made_writer(path_of("other.mcap"));
  other.discard();
  EXPECT_FALSE(fs::exists(path_of("other.mcap")));
}

TEST_F(ReplacedFile, NumbersOfExistingFilesAreLeftOut) {
  for (const char* const name : {"walk-0001.mcap", "walk-0003.mcap"}) write(path_of(name), "dear");
  fs::create_symlink("nowhere", path_of("walk-0002.mcap"));
  for (const bool overwrites : {true, false}) {
    const std::string first = overwrites ? "walk.mcap" : "day.mcap";
    write(path_of("day-0001.mcap"), "dear");
    recording_writer writer =
        made_writer(path_of(first), {.overwrite = overwrites, .rotate_time = 2s});
    record_readings(writer, 0, 500);
    ASSERT_TRUE(writer.close());
    EXPECT_FALSE(writer.take_error());
    EXPECT_EQ(writer.counts().files, 3U);
  }
  for (const char* const name : {"walk-0001.mcap", "walk-0003.mcap", "day-0001.mcap"})
    EXPECT_EQ(read(name), "dear") << name;
  EXPECT_FALSE(fs::exists(path_of("nowhere")));
  for (const char* const name : {"walk.mcap", "walk-0004.mcap", "walk-0005.mcap", "day.mcap",
                                 "day-0002.mcap", "day-0003.mcap"})
    EXPECT_GT(contents_of_file(path_of(name)).readings.size(), 80U) << name;
}

TEST_F(ReplacedFile, TheSourceIsNotRecordedToItself) {
  {
    recording_writer writer = made_writer(path_of("source.mcap"));
    record_readings(writer, 0, 300);
    ASSERT_TRUE(writer.close());
  }
  for (const std::string source : {"source.mcap", "raw.bin"}) {
    const std::string before = read(source);
    fs::create_symlink(source, path_of("symbolic"));
    fs::create_hard_link(path_of(source), path_of("hard"));
    for (const std::string& name : {source, std::string("symbolic"), std::string("hard")}) {
      EXPECT_TRUE(reads_file(path_of(source), path_of(name)));
      recording_writer writer = made_writer(path_of(name), {.overwrite = true});
      auto from = source == "raw.bin" ? open_raw_bytes(path_of(source), 9000)
                                      : replay::open(path_of(source));
      const auto refused = recorded(*std::move(from), writer);
      ASSERT_FALSE(refused) << name;
      EXPECT_EQ(refused.error(), problem::bad_option);
      EXPECT_THAT(refused.error().message(), HasSubstr("also its source"));
      EXPECT_TRUE(writer.close());
      EXPECT_EQ(read(source), before);
    }
    fs::remove(path_of("symbolic"));
    fs::remove(path_of("hard"));
  }
}

TEST_F(ReplacedFile, ReadsFile_KnowsWhatASimulationReads) {
  write(path_of("room.txt"), "wall 0 0 1 0\n");
  write(path_of("way.txt"), "drive turn 90 90\n");
  const std::string source =
      "sim:?world=" + path_of("room.txt") + "&seed=7&path=" + path_of("way.txt");
  EXPECT_TRUE(reads_file(source, path_of("room.txt")));
  EXPECT_TRUE(reads_file(source, path_of("way.txt")));
  EXPECT_FALSE(reads_file(source, path_of("raw.bin")));
  EXPECT_FALSE(reads_file("sim:", path_of("raw.bin")));
  EXPECT_TRUE(reads_file("file:" + path_of("raw.bin") + "?model=x4", path_of("raw.bin")));
  EXPECT_FALSE(reads_file("", path_of("raw.bin")));
  EXPECT_FALSE(reads_file("/dev/null", "/dev/null")) << "a device is no file";
}

}  // namespace
}  // namespace g4lidar::test
