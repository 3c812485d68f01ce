// SPDX-License-Identifier: MIT
// MCAP, as far as recordings need it: the kinds of records, and the limits of a reader.
// (mcap.dev/spec)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace g4lidar::mcap {

/// The first eight bytes of a file, and the last.
inline constexpr std::array<std::uint8_t, 8> magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum class opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

/// The fields before the content of each record: its kind and its length.
inline constexpr std::size_t record_header_size = 1 + 8;
/// The fields before the data of a message: channel, sequence, two times.
inline constexpr std::size_t message_header_size = 2 + 4 + 8 + 8;
inline constexpr std::size_t footer_size = record_header_size + 8 + 8 + 4;

/// The maximum size of a chunk, compressed and uncompressed; larger ones are treated as damage.
inline constexpr std::uint64_t largest_chunk = std::uint64_t{64} << 20U;
/// The maximum size of any other record that is read, and not skipped.
inline constexpr std::uint64_t largest_record = std::uint64_t{1} << 20U;

}  // namespace g4lidar::mcap
