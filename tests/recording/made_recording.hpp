// SPDX-License-Identifier: MIT
// Recordings with known contents, as files and as bytes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <memory>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/writer.hpp"
#include "recording/mcap/file_reader.hpp"

namespace g4lidar::test {

inline constexpr std::int64_t ms = 1'000'000;
inline constexpr std::int64_t second = 1'000 * ms;
/// The first time in these recordings, by their own clock.
inline constexpr std::int64_t begin_ns = 5 * second;
inline constexpr std::int64_t wall_ahead_ns = 1'700'000'000 * second;

/// A read with its own length and content for each number.
inline std::vector<std::uint8_t> reading(std::uint32_t number) {
  std::vector<std::uint8_t> data(40 + number * 7 % 61);
  std::uint32_t state = number * 2'654'435'761U + 1;
  for (std::uint8_t& byte : data) {
    state = state * 1'664'525U + 1'013'904'223U;
    byte = static_cast<std::uint8_t>(state >> 24U);
  }
  return data;
}
inline std::int64_t time_of(std::uint32_t number) { return begin_ns + number * 10 * ms; }

/// Reads from `first` on, 10 ms apart; a command is sent with every hundredth.
inline void record_readings(recording_writer& into, std::uint32_t first, std::uint32_t count) {
  for (std::uint32_t i = first; i < first + count; ++i) {
    if (i % 100 == 0) into.to_device(encode(command::health), time_of(i));
    into.from_device(reading(i), time_of(i));
  }
}

inline recording_writer made_writer(const std::string& path, const recording_options& how = {}) {
  auto writer = recording_writer::create(path, how);
  if (!writer) ADD_FAILURE() << writer.error().message();
  writer->set_wall_clock(wall_ahead_ns);
  return std::move(*writer);
}

inline std::vector<std::uint8_t> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A file in memory.
class memory_source final : public mcap::byte_source {
 public:
  explicit memory_source(bytes data) : data_(data.begin(), data.end()) {}
  [[nodiscard]] std::uint64_t size() const noexcept override { return data_.size(); }
  [[nodiscard]] result<std::size_t> read_some(std::uint64_t at,
                                              std::span<std::uint8_t> out) noexcept override {
    const std::size_t from = std::min(data_.size(), static_cast<std::size_t>(at));
    const std::size_t count = std::min(out.size(), data_.size() - from);
    std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(from), count, out.begin());
    read_ += count;
    return count;
  }
  [[nodiscard]] std::uint64_t bytes_read() const noexcept { return read_; }

 private:
  std::vector<std::uint8_t> data_;
  std::uint64_t read_ = 0;
};

/// The contents of a recording: the numbers of the reads, by their times; each of them is checked.
struct contents {
  std::vector<std::uint32_t> readings;
  std::size_t commands = 0;
  std::size_t odometry = 0;
  std::size_t gaps = 0;
  recording_damage damage;
  bool is_open = false;
};

template <class Reader>
contents contents_of(Reader& reader) {
  contents found;
  found.is_open = true;
  while (true) {
    const auto item = reader.next();
    if (!item || !*item) {
      EXPECT_TRUE(item);
      break;
    }
    EXPECT_EQ((*item)->wall_ns - (*item)->time_ns, wall_ahead_ns);
    if ((*item)->what == recorded_item::kind::to_device) ++found.commands;
    if ((*item)->what == recorded_item::kind::odometry) ++found.odometry;
    if ((*item)->what == recorded_item::kind::other) {
      found.gaps += (*item)->other.what == recorded_event::kind::gap ? 1U : 0U;
    }
    if ((*item)->what != recorded_item::kind::from_device) continue;
    const auto number = static_cast<std::uint32_t>(((*item)->time_ns - begin_ns) / (10 * ms));
    EXPECT_EQ(time_of(number), (*item)->time_ns);
    EXPECT_TRUE(std::ranges::equal((*item)->data, reading(number))) << number;
    found.readings.push_back(number);
  }
  found.damage = reader.damage();
  return found;
}

inline contents contents_of_file(const std::string& path, const reading_options& how = {}) {
  auto reader = recording_reader::open(path, how);
  if (!reader) {
    ADD_FAILURE() << reader.error().message();
    return {};
  }
  return contents_of(*reader);
}

/// For a file in memory, which may be invalid.
inline contents contents_of_bytes(bytes file) {
  auto reader = recording_access::open(std::make_shared<memory_source>(file), "memory", {});
  return reader ? contents_of(*reader) : contents{};
}

/// Consecutive numbers.
inline std::vector<std::uint32_t> numbers(std::uint32_t first, std::uint32_t count) {
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), first);
  return all;
}

}  // namespace g4lidar::test
