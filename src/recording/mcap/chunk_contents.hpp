// SPDX-License-Identifier: MIT
// One chunk: the fields before its records, and the records, unpacked and checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "byte_source.hpp"
#include "channels.hpp"
#include "g4lidar/core/bytes.hpp"
#include "packer.hpp"

namespace g4lidar::mcap {

/// The longest name of a compression.
inline constexpr std::size_t longest_packing = 16;
/// The fields of a chunk before its records, without that name.
inline constexpr std::size_t chunk_fields = 8 + 8 + 8 + 4 + 4 + 8;
inline constexpr std::size_t longest_chunk_header = chunk_fields + longest_packing;

struct chunk_header {
  std::uint64_t size;  ///< Uncompressed.
  std::uint32_t crc;
  std::uint64_t stored;
  std::size_t header_size;
  enum class packed : std::uint8_t { no, zstd, other } how;

  /// From the begin of a chunk's content; nothing if its fields do not fit together. `length`: of the content.
  [[nodiscard]] static std::optional<chunk_header> from(bytes content,
                                                        std::uint64_t length) noexcept;
};

/// Unpacks chunks in pieces, and stops where a chunk cannot be intact, or costs too much: what is
/// not a message may be up to 64 times as large as it is stored, and 16 MiB larger in all chunks
/// together. Real chunks have some hundred bytes of it. Of messages that are not read it may be 16 times as
/// much, and of those that are read 64 times.
class chunk_contents {
 public:
  explicit chunk_contents(found_channels known) : channels_(std::move(known)) {}

  /// The content of the record of a channel outside of chunks.
  void take_channel(bytes record) { channels_.take(field_reader(record)); }
  /// The uncompressed records: nothing if they are damaged, the checksum does not match, they cost
  /// too much, or `file` was cancelled. `stored` must be valid as long as the result.
  [[nodiscard]] std::optional<bytes> records_of(bytes stored, const chunk_header& chunk,
                                                byte_source& file);
  /// In all chunks so far.
  [[nodiscard]] std::uint64_t bytes_unpacked() const noexcept { return bytes_unpacked_; }

 private:
  std::vector<std::uint8_t> unpacked_;
  unpacker unpacker_;
  found_channels channels_;
  std::uint64_t spare_ = std::uint64_t{16} << 20U;  // what may still be unpacked without use
  std::uint64_t bytes_unpacked_ = 0;
};

}  // namespace g4lidar::mcap
