// SPDX-License-Identifier: MIT
// Small MCAP files that unpack to much, made by the formats of MCAP and zstd without the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace g4lidar::test {

inline constexpr std::size_t hostile_chunk_size = std::size_t{64} << 20U;

/// `size` bytes of `value`, little-endian.
inline std::string little_endian(std::uint64_t value, std::size_t size) {
  std::string text;
  for (std::size_t i = 0; i < size; ++i) text += static_cast<char>(i < 8 ? value >> (8 * i) : 0);
  return text;
}

/// A record of MCAP, without the last `missing` bytes of its content.
inline std::string mcap_record(std::uint8_t kind, const std::string& content,
                               std::size_t missing = 0) {
  return static_cast<char>(kind) + little_endian(content.size() + missing, 8) + content;
}

/// A zstd frame of `begin`, followed by zeros to 64 MiB: a raw block, and blocks of 128 KiB that repeat one byte.
inline std::string zstd_zeros(const std::string& begin = {}) {
  constexpr std::size_t largest_block = std::size_t{128} << 10U;
  enum : std::uint32_t { raw = 0, repeated = 2 };
  const auto block = [](std::size_t size, std::uint32_t type, bool is_last) {
    return little_endian(size << 3U | type | (is_last ? 1U : 0U), 3);
  };
  // One segment, and its size in four bytes.
  std::string frame = "\x28\xB5\x2F\xFD\xA0" + little_endian(hostile_chunk_size, 4);
  if (!begin.empty()) frame += block(begin.size(), raw, false) + begin;
  for (std::size_t left = hostile_chunk_size - begin.size(); left > 0;) {
    const std::size_t size = left < largest_block ? left : largest_block;
    left -= size;
    frame += block(size, repeated, left == 0) + '\0';
  }
  return frame;
}

/// A chunk of 64 MiB, without a checksum, in about 2 kB.
inline std::string hostile_chunk(const std::string& begin = {}) {
  const std::string frame = zstd_zeros(begin);
  return mcap_record(6, little_endian(0, 8) + little_endian(0, 8) +
                            little_endian(hostile_chunk_size, 8) + little_endian(0, 4) +
                            little_endian(4, 4) + "zstd" + little_endian(frame.size(), 8) + frame);
}

/// The begin of a record that fills the rest of such a chunk.
inline std::string filling_record(std::uint8_t kind) {
  return mcap_record(kind, {}, hostile_chunk_size - 9);
}
/// Such a chunk with one message of a channel, whose first data are not packed.
inline std::string chunk_of_a_message(std::uint16_t channel, std::size_t not_packed = 0) {
  return hostile_chunk(filling_record(5) + little_endian(channel, 2) +
                       std::string(not_packed, '\x55'));
}
/// The same of a channel that is not described.
inline std::string chunk_of_a_foreign_message() { return chunk_of_a_message(60'000); }
/// The record of a channel.
inline std::string mcap_channel(std::uint16_t id, const std::string& name) {
  const auto text = [](const std::string& of) { return little_endian(of.size(), 4) + of; };
  return mcap_record(4, little_endian(id, 2) + little_endian(1, 2) + text(name) + text("cdr") +
                            little_endian(0, 4));
}

inline std::string repeated(const std::string& text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

inline std::string mcap_begin() {
  return "\x89MCAP0\r\n" + mcap_record(1, little_endian(0, 4) + little_endian(0, 4));
}
inline std::string hostile_mcap(const std::string& chunk, std::size_t count) {
  return mcap_begin() + repeated(chunk, count);
}

/// A file of 32 MB that takes long to read: a recorded channel, whose messages are just small enough to be unpacked.
inline std::string slow_mcap() {
  constexpr std::size_t enough = std::size_t{16} << 10U;
  return mcap_begin() + mcap_channel(1, "/g4lidar/from_device") +
         repeated(chunk_of_a_message(1, enough), 2000);
}

/// A file of 1 MiB whose summary leads to its metadata a million times.
inline std::string mcap_with_overlapping_groups() {
  std::string file = mcap_begin();
  const std::size_t metadata_at = file.size();
  constexpr std::size_t content_size = (std::size_t{1} << 20U) - 16;
  file += mcap_record(12, std::string(content_size, '\0'));
  file += mcap_record(15, little_endian(0, 4));
  const std::size_t group_at = file.size();
  file += repeated(mcap_record(13, little_endian(metadata_at, 8) + little_endian(content_size, 8) +
                                       little_endian(0, 4)),
                   1000);
  const std::size_t group_size = file.size() - group_at;
  const std::size_t offsets_at = file.size();
  file += repeated(mcap_record(14, std::string(1, '\x0D') + little_endian(group_at, 8) +
                                       little_endian(group_size, 8)),
                   1000);
  file += mcap_record(
      2, little_endian(group_at, 8) + little_endian(offsets_at, 8) + little_endian(0, 4));
  return file + "\x89MCAP0\r\n";
}

}  // namespace g4lidar::test
