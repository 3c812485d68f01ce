// SPDX-License-Identifier: MIT
// Small files that unpack to much: the work is bounded by the size of the file, and reading can be cancelled.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/writer.hpp"
#include "made_recording.hpp"
#include "recorded_run.hpp"
#include "recording/mcap/chunk_source.hpp"
#include "recording/mcap/summary.hpp"
#include "support/hostile_mcap.hpp"

namespace g4lidar::test {
namespace {

bytes bytes_of_text(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// What is unpacked to read everything.
std::uint64_t unpacked_from(const std::string& file) {
  mcap::chunk_source chunks(std::make_shared<memory_source>(bytes_of_text(file)));
  while (!chunks.next().records.empty()) continue;
  EXPECT_GT(chunks.damage().chunks_lost, 0U);
  return chunks.bytes_unpacked();
}

class HostileChunks : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_zstd()) GTEST_SKIP() << "without zstd";
  }
};

TEST_F(HostileChunks, WithoutMessages_CostWorkByTheSizeOfTheFile) {
  const std::string channel = mcap_record(4, std::string(40, '\0'));
  for (const std::string& begin :
       {std::string(), std::string("\x10"), filling_record(0x10), filling_record(0x80),
        channel + filling_record(3), repeated(channel, 2000),
        mcap_record(5, std::string(30, '\0'))}) {
    const std::string file = hostile_mcap(hostile_chunk(begin), 300);
    ASSERT_GT(file.size(), 600'000U);
    // They unpack to 19 GiB.
    EXPECT_LT(unpacked_from(file), 300 * (std::uint64_t{1} << 20U) + 128 * file.size())
        << begin.size();
  }
}

// 300 of them unpack to 19 GiB.
TEST_F(HostileChunks, WithMessagesOfNoChannel_CostWorkByTheSizeOfTheFile) {
  const std::string file = hostile_mcap(chunk_of_a_foreign_message(), 300);
  EXPECT_LT(unpacked_from(file), 512 * (std::uint64_t{1} << 20U) + 1100 * file.size());
}

TEST_F(HostileChunks, WithMessagesOfARecordedChannel_CostWorkByTheSizeOfTheFile) {
  const std::string channel = mcap_channel(1, "/g4lidar/from_device");
  const std::string chunk = chunk_of_a_message(1);
  const std::string file = mcap_begin() + channel + repeated(chunk, 300);
  EXPECT_LT(unpacked_from(file), 1536 * (std::uint64_t{1} << 20U) + 4200 * file.size());
  // Where the chunk itself describes the channel, it is known, too.
  const std::string own = channel + mcap_record(5, {}, hostile_chunk_size - 9 - channel.size());
  const std::string in_chunk = mcap_begin() + hostile_chunk(own + little_endian(1, 2));
  mcap::chunk_source chunks(std::make_shared<memory_source>(bytes_of_text(in_chunk)));
  EXPECT_FALSE(chunks.next().records.empty());
}

// Each of them is a guess that fails, and would be looked for in 256 KiB behind it.
TEST_F(HostileChunks, SmallOnesWithAWrongChecksum_AreReadFewTimes) {
  const std::string small =
      mcap_record(6, little_endian(0, 16) + little_endian(9, 8) + little_endian(1, 4) +
                         little_endian(0, 4) + little_endian(9, 8) + mcap_record(5, {}));
  for (const std::size_t between : {1U, 100U}) {
    const std::string file = hostile_mcap(small + std::string(between, '\0'), 4000);
    const auto source = std::make_shared<memory_source>(bytes_of_text(file));
    mcap::chunk_source chunks(source);
    EXPECT_TRUE(chunks.next().records.empty());
    EXPECT_EQ(chunks.damage().bytes_skipped, 4000 * (small.size() + between)) << between;
    EXPECT_LT(source->bytes_read(), 3 * file.size() + (std::uint64_t{2} << 20U)) << between;
  }
}

// A summary that would read 1 TiB.
TEST(HostileSummary, WithOverlappingGroups_IsReadOnce) {
  const std::string file = mcap_with_overlapping_groups();
  const auto source = std::make_shared<memory_source>(bytes_of_text(file));
  mcap::chunk_source chunks(source);
  std::size_t metadata = 0;
  mcap::read_summary(chunks, [&](mcap::opcode kind, mcap::field_reader /*content*/) {
    if (kind == mcap::opcode::metadata) ++metadata;
  });
  EXPECT_GE(metadata, 1U);
  EXPECT_LE(metadata, 2U);
  EXPECT_LT(source->bytes_read(), std::uint64_t{16} << 20U);
}

/// A file with such chunks between its own.
std::string file_around(const std::string& between) {
  const temporary_path path;
  auto writer = made_writer(path.text());
  record_readings(writer, 0, 200);
  EXPECT_TRUE(writer.flush());
  const std::size_t middle = bytes_of(path.text()).size();
  record_readings(writer, 200, 200);
  EXPECT_TRUE(writer.flush());
  const auto all = bytes_of(path.text());
  std::string text(all.begin(), all.end());
  return text.insert(middle, between);
}

TEST_F(HostileChunks, IntactChunksAroundThem_AreRead) {
  const std::string file = file_around(repeated(hostile_chunk(), 300));
  const contents found = contents_of_bytes(bytes_of_text(file));
  EXPECT_EQ(found.readings, numbers(0, 400));
  EXPECT_EQ(found.damage.chunks_lost, 300U);
  EXPECT_EQ(found.damage.bytes_skipped, 300 * hostile_chunk().size());
}

TEST_F(HostileChunks, IntactChunksAroundThoseOfNoChannel_AreRead) {
  const contents found =
      contents_of_bytes(bytes_of_text(file_around(repeated(chunk_of_a_foreign_message(), 300))));
  EXPECT_EQ(found.readings, numbers(0, 400));
  EXPECT_GT(found.damage.chunks_lost, 200U);
}

TEST_F(HostileChunks, MessagesOfOtherPrograms_AreNoDamage) {
  const contents found =
      contents_of_bytes(bytes_of_text(file_around(repeated(chunk_of_a_foreign_message(), 3))));
  EXPECT_EQ(found.readings, numbers(0, 400));
  EXPECT_EQ(found.damage.chunks_lost, 0U);
  EXPECT_EQ(found.damage.bytes_skipped, 0U);
}

TEST_F(HostileChunks, Cancelled_EndsSoonAndTheNextCallContinues) {
  const std::string file = file_around(repeated(chunk_of_a_foreign_message(), 3));
  std::uint64_t asked = 0;
  bool is_cancelled = false;
  reading_options how;
  how.is_cancelled = [&] { return ++asked, is_cancelled; };
  auto reader =
      recording_access::open(std::make_shared<memory_source>(bytes_of_text(file)), "it", how);
  ASSERT_TRUE(reader);
  std::size_t readings = 0;
  std::size_t cancelled = 0;
  while (true) {
    is_cancelled = cancelled < 3 && readings >= 100 * (cancelled + 1);
    const auto item = reader->next();
    if (!item) {
      ASSERT_EQ(item.error(), problem::cancelled);
      ++cancelled;
      continue;
    }
    if (!*item) break;
    if ((*item)->what == recorded_item::kind::from_device) ++readings;
  }
  EXPECT_EQ(readings, 400U);
  EXPECT_EQ(cancelled, 3U);
  EXPECT_FALSE(reader->damage().chunks_lost);
  EXPECT_GE(asked, 3 * 64U) << "at least once for each megabyte";
  is_cancelled = true;
  const auto refused =
      recording_access::open(std::make_shared<memory_source>(bytes_of_text(file)), "it", how);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), problem::cancelled);
}

TEST_F(HostileChunks, WokenReplay_ReturnsOnceWithCancelled) {
  const temporary_path path;
  std::ofstream(path.text(), std::ios::binary)
      << file_around(repeated(chunk_of_a_foreign_message(), 3));
  for (const double speed : {0.0, 1000.0}) {
    std::optional<lidar> device;
    int asked = 0;
    const auto asks = [&] {
      if (device && ++asked == 100) device->wake();
      return false;
    };
    auto from = replay::open(path.text(), {.speed = speed}, asks);
    ASSERT_TRUE(from) << from.error().message();
    device.emplace(*lidar::open(std::move(*from)));
    ASSERT_TRUE(device->start());
    std::size_t cancelled = 0;
    while (true) {
      const auto scan = device->try_scan(std::chrono::seconds(100));
      ASSERT_FALSE(scan);
      if (scan.error() == problem::end_of_input) break;
      ASSERT_EQ(scan.error(), problem::cancelled);
      ASSERT_GE(asked, 100);
      ++cancelled;
    }
    EXPECT_EQ(cancelled, 1U) << speed;
    std::size_t expected = 0;
    for (const std::uint32_t i : numbers(0, 400)) expected += reading(i).size();
    EXPECT_EQ(device->counts().bytes, expected) << speed;
  }
}

}  // namespace
}  // namespace g4lidar::test
