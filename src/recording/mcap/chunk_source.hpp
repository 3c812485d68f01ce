// SPDX-License-Identifier: MIT
// The chunks of a file one after the other, also of a damaged file.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "byte_source.hpp"
#include "chunk_contents.hpp"
#include "format.hpp"
#include "g4lidar/recording/reader.hpp"
#include "record_header.hpp"

namespace g4lidar::mcap {

/// A part of the file that contains records: the contents of a chunk, or one record outside of
/// chunks.
struct record_block {
  bytes records{};           ///< Empty if there is none.
  std::uint64_t offset = 0;  ///< In the file.
};

/// Reads a file in sequence. Its memory: one compressed and one uncompressed chunk. Damaged parts
/// are skipped to the next intact chunk, and counted. The work is bounded by the size of the file, see chunk_contents.
class chunk_source {
 public:
  /// `known`: the channels that were found before.
  explicit chunk_source(std::shared_ptr<byte_source> file, found_channels known = {});

  /// The next records; empty at the end, if the file cannot be read, and if it was cancelled. Valid
  /// until the next call.
  [[nodiscard]] record_block next();
  /// Continues with the first chunk at or behind `offset`, which may be anywhere in the file. The
  /// bytes before that chunk do not count as damage.
  void seek(std::uint64_t offset) noexcept;
  /// The content of the record at `offset`; empty if it has another kind, or is too large.
  [[nodiscard]] bytes record_at(std::uint64_t offset, opcode kind);

  [[nodiscard]] const recording_damage& damage() const noexcept { return damage_; }
  [[nodiscard]] std::uint64_t position() const noexcept { return at_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// The bytes that were unpacked so far, with those that were of no use.
  [[nodiscard]] std::uint64_t bytes_unpacked() const noexcept { return contents_.bytes_unpacked(); }
  /// Where the summary begins, 0 if there is none.
  [[nodiscard]] std::uint64_t summary_start();
  /// The first byte behind the header.
  static constexpr std::uint64_t begin_of_records = magic.size();

 private:
  void look_at_end();
  [[nodiscard]] bytes ahead(std::uint64_t offset, std::size_t least);
  [[nodiscard]] bytes window(std::uint64_t offset, std::size_t size);
  [[nodiscard]] bytes content(std::uint64_t offset, std::size_t size);
  [[nodiscard]] std::optional<record_header> believe_at(bytes begin,
                                                        std::uint64_t offset) const noexcept {
    return believe(begin, limit_ - std::min(limit_, offset));
  }
  [[nodiscard]] record_block step();
  [[nodiscard]] record_block chunk_at(std::uint64_t offset, std::uint64_t length);
  [[nodiscard]] std::optional<bytes> records_of(std::uint64_t offset, const chunk_header& chunk);
  void lose_chunk(std::uint64_t offset, std::uint64_t length);
  void resynchronise(std::uint64_t from);
  void end_here() noexcept;

  std::shared_ptr<byte_source> file_;
  std::uint64_t size_;
  std::uint64_t limit_;  // the end of the data: before the summary
  std::uint64_t at_ = 0;
  std::uint64_t trusted_ = 0;  // everything before was checked
  bool is_open_ = false;       // both ends of the file were read
  bool is_at_end_ = false;
  bool is_sought_ = false;  // at_ may be in the middle of a record
  bool is_guess_ = false;   // the chunk at at_ was found by a search
  bool has_end_ = false;    // a proper one
  std::uint64_t summary_start_ = 0;
  std::uint64_t wasted_ = 0;  // bytes whose checksum was computed without use
  recording_damage damage_;

  std::vector<std::uint8_t> window_;
  std::uint64_t window_at_ = 0;
  std::size_t window_size_ = 0;  // bytes in use
  std::vector<std::uint8_t> stored_;
  chunk_contents contents_;
};

}  // namespace g4lidar::mcap
