// SPDX-License-Identifier: MIT
// The files of a recording: rotation, a full disk, a killed program, options.
#include "g4lidar/recording/writer.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <numeric>

#include "made_recording.hpp"
#include "recorded_run.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

TEST(Recording, FullFile_ContinuesInAnother) {
  const temporary_path path;
  auto writer = made_writer(path.text(), {.rotate_bytes = std::uint64_t{1} << 20U});
  constexpr std::uint32_t count = 20'000;
  record_readings(writer, 0, count);
  writer.device({});
  ASSERT_TRUE(writer.close());
  const std::uint64_t files = writer.counts().files;
  ASSERT_GE(files, 2U);
  std::vector<std::uint32_t> all;
  std::uint64_t size = 0;
  for (std::uint64_t i = 0; i < files; ++i) {
    const std::string name = i == 0 ? path.text() : path.next(static_cast<int>(i));
    SCOPED_TRACE(name);
    const contents found = contents_of_file(name);
    EXPECT_FALSE(found.damage.any());
    all.insert(all.end(), found.readings.begin(), found.readings.end());
    const auto file = bytes_of(name);
    EXPECT_LE(file.size(), std::size_t{1} << 20U);
    size += file.size();
  }
  EXPECT_EQ(all, numbers(0, count));
  EXPECT_EQ(writer.counts().file_bytes, size);
}

TEST(Recording, RotationTime_ContinuesInAnotherFile) {
  const temporary_path path;
  auto writer = made_writer(path.text(), {.rotate_time = 2s});
  writer.device({});
  record_readings(writer, 0, 1000);
  ASSERT_TRUE(writer.close());
  EXPECT_EQ(writer.counts().files, 5U);
  for (int i = 1; i < 5; ++i) {
    auto reader = recording_reader::open(path.next(i));
    ASSERT_TRUE(reader) << reader.error().message();
    EXPECT_TRUE(reader->device());
    payload_digest sum;
    while (const auto item = *reader->next()) {
      if (item->what == recorded_item::kind::from_device) {
        sum.add(direction::from_device, item->data);
      } else if (item->what == recorded_item::kind::to_device) {
        sum.add(direction::to_device, item->data);
      }
    }
    ASSERT_TRUE(reader->digest());
    EXPECT_EQ(reader->digest()->payload, sum.value());
  }
}

/// While this object exists, no file grows beyond this number of bytes.
class full_disk {
 public:
  explicit full_disk(rlim_t size) {
    before_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &limit_);
    const rlimit small{size, limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  full_disk(const full_disk&) = delete;
  full_disk& operator=(const full_disk&) = delete;
  ~full_disk() {
    ::setrlimit(RLIMIT_FSIZE, &limit_);
    std::signal(SIGXFSZ, before_);
  }

 private:
  rlimit limit_{};
  void (*before_)(int) = nullptr;
};

TEST(Recording, FullDisk_IsReportedOnceAndLosesOnlyThatTime) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_readings(writer, 0, 400);
  {
    const full_disk disk(writer.counts().file_bytes + 5000);
    record_readings(writer, 400, 400);
    const auto reported = writer.take_error();
    ASSERT_TRUE(reported);
    EXPECT_EQ(reported->code(), problem::system);
    EXPECT_EQ(reported->system_errno(), EFBIG);
    EXPECT_FALSE(writer.take_error());
  }
  record_readings(writer, 800, 200);
  EXPECT_FALSE(writer.take_error());
  ASSERT_TRUE(writer.close());
  const recording_counts counts = writer.counts();
  EXPECT_GE(counts.chunks_lost, 7U);
  EXPECT_GT(counts.bytes_lost, 0U);
  const contents found = contents_of_file(path.text());
  EXPECT_FALSE(found.damage.any());
  EXPECT_EQ(found.gaps, 1U);
  EXPECT_EQ(found.readings.front(), 0U);
  EXPECT_EQ(found.readings.back(), 999U);
  EXPECT_GE(found.readings.size(), 550U);
}

TEST(Recording, KilledProgram_LosesOnlyTheOpenChunk) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_readings(writer, 0, 224);
  // Nothing is closed: like after kill -9.
  const contents found = contents_of_bytes(bytes_of(path.text()));
  EXPECT_EQ(found.readings, numbers(0, 200));
  EXPECT_TRUE(found.damage.is_cut_off);
  EXPECT_EQ(found.damage.bytes_skipped, 0U);
  ASSERT_TRUE(writer.flush());
  EXPECT_EQ(contents_of_bytes(bytes_of(path.text())).readings, numbers(0, 224));
}

TEST(Recording, ExistingFile_IsReplacedOnRequestOnly) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
  }
  const auto refused = recording_writer::create(path.text());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().system_errno(), EEXIST);
  EXPECT_TRUE(recording_writer::create(path.text(), {.overwrite = true}));
}

TEST(Recording, InvalidOptions_AreRefused) {
  const temporary_path path;
  const auto refused = [&](const recording_options& how) {
    const auto made = recording_writer::create(path.text(), how);
    return !made && made.error() == problem::bad_option;
  };
  EXPECT_TRUE(refused({.rotate_bytes = 1}));
  EXPECT_TRUE(refused({.rotate_time = -1s}));
  EXPECT_TRUE(refused({.chunk_time = 1ms}));
  EXPECT_TRUE(refused({.chunk_time = 11s}));
  EXPECT_TRUE(refused({.scan_bins = 0}));
  EXPECT_TRUE(refused({.scan_bins = 65'537}));
  EXPECT_TRUE(refused({.frame_id = std::string(256, 'x')}));
  EXPECT_TRUE(refused({.robot_frame_id = std::string(256, 'x')}));
  EXPECT_TRUE(refused({.odometry_frame_id = std::string(256, 'x')}));
  EXPECT_TRUE(refused({.mount = mounting{{0.0, std::nan(""), 0.0}}}));
  for (const std::string topic : {"points", "/scan", "/odom", "/tf_static", "/g4lidar/events"}) {
    EXPECT_TRUE(refused({.points_topic = topic})) << topic;
  }
  for (const std::string topic : {"", "scan", "/", "/scan/", "/a//b", "/1st", "/a/1st", "/a__b",
                                  "/a b", "/a-b", "~/scan", "/{node}", "/sc\xC3\xA4n",
                                  "/g4lidar/events", "/g4lidar/to_device", "/odom", "/tf_static"}) {
    EXPECT_TRUE(refused({.topic = topic})) << topic;
  }
  EXPECT_TRUE(refused({.topic = "/" + std::string(255, 'x')}));
  EXPECT_EQ(refused({.packed = packing::zstd}), !has_zstd());
}

TEST(Recording, Scans_AreOnTheRequestedTopic) {
  for (const std::string& topic :
       {std::string("/scan"), std::string("/front_2/_hidden/a9"), "/" + std::string(254, 'x')}) {
    const temporary_path path;
    {
      recording_writer writer = made_writer(path.text(), {.topic = topic});
      record_readings(writer, 0, 100);
      ASSERT_TRUE(writer.close());
    }
    const auto file = bytes_of(path.text());
    const std::string text(file.begin(), file.end());
    std::string wanted{static_cast<char>(topic.size()), 0, 0, 0};  // the format of MCAP texts
    wanted += topic;
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(wanted, at)) != std::string::npos; ++at) ++found;
    EXPECT_EQ(found, 2U + 2U) << "at the front, in each of two chunks, and in the summary";
    EXPECT_EQ(contents_of_bytes(file).readings, numbers(0, 100));
  }
}

TEST(Recording, OtherFiles_AreRefused) {
  const auto what_is_wrong = [](std::string_view text) {
    const bytes data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    const auto reader = recording_access::open(std::make_shared<memory_source>(data), "it", {});
    return reader ? std::optional<problem>() : std::optional(reader.error().code());
  };
  using namespace std::string_view_literals;
  EXPECT_EQ(what_is_wrong(""), problem::bad_file);
  EXPECT_EQ(what_is_wrong("\x89MCAP"), problem::bad_file);
  EXPECT_EQ(what_is_wrong("\x89MCAP0\r\n"), problem::bad_file);
  EXPECT_EQ(what_is_wrong("\x89MCAP0\r\n and something else that is long enough to be read"sv),
            problem::bad_file);
  const auto missing = recording_reader::open("/dev/no-recording");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().system_errno(), ENOENT);
  const auto directory = recording_reader::open("/dev");
  ASSERT_FALSE(directory);
  EXPECT_EQ(directory.error().code(), problem::bad_option);
  EXPECT_FALSE(is_recording("/dev/no-recording"));
}

TEST(Recording, EmptyRecording_IsValid) {
  const temporary_path path;
  {
    auto writer = made_writer(path.text());
  }
  EXPECT_TRUE(is_recording(path.text()));
  EXPECT_TRUE(contents_of_file(path.text()).readings.empty());
}

TEST(Recording, ReadsOfAnySize_AreRecorded) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  std::vector<std::uint8_t> large(3'000'000);
  std::iota(large.begin(), large.end(), std::uint8_t{0});
  writer.from_device(large, begin_ns);
  ASSERT_TRUE(writer.close());
  auto reader = recording_reader::open(path.text());
  ASSERT_TRUE(reader);
  std::vector<std::uint8_t> got;
  while (const auto item = *reader->next()) {
    EXPECT_EQ(item->time_ns, begin_ns);
    got.insert(got.end(), item->data.begin(), item->data.end());
  }
  EXPECT_EQ(got, large);
}

}  // namespace
}  // namespace g4lidar::test
