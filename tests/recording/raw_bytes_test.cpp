// SPDX-License-Identifier: MIT
// Raw bytes of a file as a connector: times are counted from samples, nothing waits, nothing answers.
#include "g4lidar/recording/raw_bytes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/writer.hpp"
#include "recorded_run.hpp"
#include "support/packet_maker.hpp"

namespace g4lidar::test {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t second_ns = 1'000'000'000;

std::string packet_of(std::size_t samples) {
  const made::packet made(0, 64, 10 * 64, std::vector<std::uint16_t>(samples, 4000));
  return {made.data().begin(), made.data().end()};
}

class RawBytes : public ::testing::Test {
 protected:
  ~RawBytes() override { std::filesystem::remove(path_); }
  std::unique_ptr<connector> opened(const std::string& bytes, std::uint32_t rate_hz) {
    std::ofstream(path_, std::ios::binary) << bytes;
    auto made = open_raw_bytes(path_, rate_hz);
    EXPECT_TRUE(made);
    return made ? std::move(*made) : nullptr;
  }

  std::string path_ =
      std::filesystem::temp_directory_path() / ("g4lidar-raw-bytes-" + std::to_string(::getpid()));
};

struct reading {
  std::size_t count;
  std::int64_t since_ns;
  bool operator==(const reading&) const = default;
};

// Packets of 9 and 18 samples at 9000 per second, 3 stray bytes, and a truncated packet.
TEST_F(RawBytes, OfAFile_ArriveAtTheTimeOfTheirSamples) {
  const std::string all =
      packet_of(9) + packet_of(18) + std::string("\0\x13\0", 3) + packet_of(9).substr(0, 20);
  const auto from = opened(all, 9000);
  const std::int64_t begin_ns = from->now_ns();
  auto port = from->connect();
  ASSERT_TRUE(port);
  std::vector<reading> readings;
  std::string bytes;
  std::array<std::uint8_t, 1000> memory{};
  while (true) {
    const auto got = (*port)->read(memory, 0);  // in the past: it does not wait
    if (!got) {
      EXPECT_EQ(got.error(), problem::end_of_input);
      break;
    }
    readings.push_back({got->count, got->arrival_ns - begin_ns});
    bytes.append(memory.begin(), memory.begin() + static_cast<std::ptrdiff_t>(got->count));
  }
  EXPECT_EQ(bytes, all);
  const std::vector<reading> expected{{28, 1'000'000}, {46, 3'000'000}, {23, 3'000'000}};
  EXPECT_EQ(readings, expected);
  EXPECT_EQ(from->now_ns() - begin_ns, 3'000'000);
}

TEST_F(RawBytes, TimesDoNotDrift) {
  std::string all;
  for (int i = 0; i < 700; ++i) all += packet_of(10);
  const auto from = opened(all, 7);  // 1000 s
  auto port = from->connect();
  ASSERT_TRUE(port);
  const std::int64_t begin_ns = from->now_ns();
  std::array<std::uint8_t, 7> small{};  // less than a packet at a time
  std::int64_t samples = 0;
  std::size_t bytes = 0;
  while (const auto got = (*port)->read(small, 0)) {
    bytes += got->count;
    if (bytes % 30 != 0) continue;
    samples += 10;
    ASSERT_EQ(got->arrival_ns - begin_ns, samples * second_ns / 7);
  }
  EXPECT_EQ(samples, 7000);
}

TEST_F(RawBytes, ReturnTheirTransportOnceAndDiscardWrites) {
  const auto from = opened(packet_of(9), 9000);
  auto port = from->connect();
  ASSERT_TRUE(port);
  EXPECT_TRUE((*port)->write(std::array<std::uint8_t, 2>{0xA5, 0x60}, 0));
  EXPECT_EQ(std::string((*port)->name()), path_);
  (*port)->wake();
  std::array<std::uint8_t, 10> memory{};
  EXPECT_EQ((*port)->read(memory, 0).error(), problem::cancelled);
  EXPECT_TRUE((*port)->read(memory, 0));
  const auto second = from->connect();
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error(), problem::end_of_input);
}

/// What lidar::open() makes of bytes.
std::vector<point> points_of(const lidar_options& options) {
  std::vector<point> all;
  auto device = lidar::open(options);
  EXPECT_TRUE(device && device->start());
  if (!device) return all;
  while (const auto some = device->next_points(std::chrono::seconds(10)))
    all.insert(all.end(), some->begin(), some->end());
  return all;
}

std::string suspect_packet() {
  const made::packet made(0, 20 * 64, 19 * 64, std::vector<std::uint16_t>(2, 4000));
  return {made.data().begin(), made.data().end()};
}

// A suspect packet before the first point takes no time, and one behind it that of its 2 samples.
TEST_F(RawBytes, TimesOfPointsAreCountedExactly_AlsoInARecordingOfThem) {
  std::string all = suspect_packet() + packet_of(9) + suspect_packet();
  for (int i = 0; i < 300; ++i) all += packet_of(30);
  std::ofstream(path_, std::ios::binary) << all;
  for (const std::uint32_t rate_hz : {9000U, 7U, 123'457U}) {
    const temporary_path copy;
    {
      auto writer = recording_writer::create(copy.text());
      ASSERT_TRUE(writer);
      auto device = lidar::open(path_, {.raw_sample_rate_hz = rate_hz, .wrap = [&](auto from) {
                                          return recorded(std::move(from), *writer);
                                        }});
      ASSERT_TRUE(device && device->start());
      while (device->next_points(std::chrono::seconds(10))) continue;
    }
    const std::vector<point> played = points_of({.device = path_, .raw_sample_rate_hz = rate_hz});
    ASSERT_EQ(played.size(), 9U + 9000U);
    for (std::size_t i = 0; i < played.size(); ++i) {
      const auto sample = static_cast<std::int64_t>(i < 9 ? i : i + 2);
      ASSERT_EQ(played[i].time_ns, second_ns + sample * second_ns / rate_hz) << i;
    }
    EXPECT_EQ(points_of({.device = copy.text()}), played) << rate_hz;
  }
}

TEST_F(RawBytes, OfAPipe_HaveCountedTimesIfTheyAreWanted) {
  std::string all;
  for (int i = 0; i < 100; ++i) all += packet_of(30);
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(path_, std::ios::binary) << all; });
  const std::vector<point> read =
      points_of({.device = path_, .model = &g4_model, .raw_sample_rate_hz = 7});
  writer.join();
  ASSERT_EQ(read.size(), 3000U);
  for (std::size_t i = 0; i < read.size(); ++i) {
    const auto since_ns = static_cast<std::int64_t>(i) * second_ns / 7;
    ASSERT_EQ(read[i].time_ns - read[0].time_ns, since_ns) << i;
  }
}

TEST_F(RawBytes, OfAPipeThatIsStoppedAndStarted_TimesDoNotGoBack) {
  std::string all;
  for (int i = 0; i < 2000; ++i) all += packet_of(30);
  ASSERT_EQ(::mkfifo(path_.c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(path_, std::ios::binary) << all; });
  auto device = lidar::open({.device = path_, .model = &g4_model, .raw_sample_rate_hz = 7});
  [&] {
    ASSERT_TRUE(device && device->start());
    const auto first = device->next_points(std::chrono::seconds(10));
    ASSERT_TRUE(first);
    const std::int64_t until_ns = first->back().time_ns;
    ASSERT_TRUE(device->stop());
    ASSERT_TRUE(device->start());
    const auto second = device->next_points(std::chrono::seconds(10));
    ASSERT_TRUE(second);
    EXPECT_GT(second->front().time_ns, until_ns);
  }();
  while (device && device->next_points(std::chrono::seconds(10))) continue;
  writer.join();
}

// A file without a packet: no scan ends the call.
TEST_F(RawBytes, Cancelled_EndsACallSoonAndTheNextOneContinues) {
  std::ofstream(path_, std::ios::binary) << std::string(1U << 20U, '\x17');
  for (const bool is_recorded : {false, true}) {
    const temporary_path copy;
    std::optional<recording_writer> writer;
    int asked = 0;
    lidar_options how;
    how.device = path_;
    how.is_cancelled = [&] { return ++asked == 4; };
    how.wrap = [&](std::unique_ptr<connector> from) -> result<std::unique_ptr<connector>> {
      if (!is_recorded) return from;
      writer.emplace(std::move(*recording_writer::create(copy.text())));
      return recorded(std::move(from), *writer);
    };
    auto device = lidar::open(how);
    ASSERT_TRUE(device && device->start());
    const auto cut = device->try_scan(std::chrono::milliseconds(500));
    EXPECT_EQ(cut.error(), problem::cancelled);
    EXPECT_LE(device->counts().bytes, 4U * 65'536U);
    const auto rest = device->next_points(std::chrono::milliseconds(500));
    EXPECT_EQ(rest.error(), problem::end_of_input);
    EXPECT_EQ(device->counts().bytes, 1U << 20U);
    EXPECT_GE(asked, 16);
  }
}

// Sentences with their checksum, as a receiver of satellite positions sends them.
std::string satellite_sentences() {
  std::string all;
  for (const std::string words :
       {"GPGGA,1", "GPGSA,2", "GPGSV,3", "GPRMC,4", "GPVTG,5", "GPGLL,6"}) {
    unsigned sum = 0;
    for (const char each : words) sum ^= static_cast<unsigned char>(each);
    std::array<char, 8> digits{};
    std::snprintf(digits.data(), digits.size(), "*%02X\r\n", sum);
    all.append("$").append(words).append(digits.data());
  }
  return all;
}

TEST_F(RawBytes, OfNoLidar_AreNamedWhereTheyAreOpened) {
  const auto open_with = [this](const std::string& content, const model* which) {
    std::ofstream(path_, std::ios::binary) << content;
    return open_raw_bytes(path_, 9000, {}, {}, which);
  };
  const auto hex = open_with("AA 55 00 28 01 02 03 04\nAA 55 00 28 05 06 07 08\n", nullptr);
  ASSERT_FALSE(hex);
  EXPECT_EQ(hex.error(), problem::bad_file);
  EXPECT_THAT(hex.error().message(), HasSubstr("xxd -r -p"));
  const auto positions = open_with(satellite_sentences(), nullptr);
  ASSERT_FALSE(positions);
  EXPECT_EQ(positions.error(), problem::other_device);
  EXPECT_EQ(positions.error().detail(), error_detail::other_maker);
  EXPECT_THAT(positions.error().message(), HasSubstr("satellite positions"));
  EXPECT_TRUE(open_with(satellite_sentences(), &g4_model)) << "its owner has named the model";
  EXPECT_TRUE(open_with("some text, and then a packet: " + packet_of(9), nullptr));
  EXPECT_TRUE(open_with(std::string(4096, '\x17'), nullptr)) << "unknown bytes";
}

TEST(WhatIs, StatesWhatBytesAre_BesidePacketsToo) {
  const auto what = [](const std::string& data) {
    return what_is({reinterpret_cast<const std::uint8_t*>(data.data()), data.size()});
  };
  EXPECT_THAT(what("This is no lidar but a shell.\n"), HasSubstr("This is text"));
  EXPECT_THAT(what(satellite_sentences()), HasSubstr("satellite positions"));
  EXPECT_EQ(what("This is no lidar but a shell.\n" + packet_of(9)), "");
  EXPECT_THAT(what("\xFA\xFA\xA5\x5A\x14" + std::string(1, '\0') + "\xE3\x02\x01" + "COIN-D4" +
                   packet_of(9)),
              HasSubstr("COIN-D4"));
  EXPECT_EQ(what({}), "");
}

TEST_F(RawBytes, MissingFileOrDirectory_IsRefused) {
  EXPECT_EQ(open_raw_bytes("/nowhere/at/all", 9000).error(), problem::system);
  EXPECT_EQ(open_raw_bytes("/", 9000).error(), problem::bad_file);
}

}  // namespace
}  // namespace g4lidar::test
