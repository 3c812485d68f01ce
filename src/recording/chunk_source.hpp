// SPDX-License-Identifier: MIT
// The chunks of a file one after the other, whatever has become of the file.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "../device/owned_fd.hpp"
#include "format.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/recording.hpp"
#include "g4lidar/recording_reader.hpp"
#include "packer.hpp"

namespace g4lidar::mcap {

/// Bytes of a file, or of a test.
class byte_source {
 public:
  virtual ~byte_source() = default;
  byte_source(const byte_source&) = delete;
  byte_source& operator=(const byte_source&) = delete;

  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
  /// Reads up to out.size() bytes from `at` on; less only at the end.
  [[nodiscard]] virtual result<std::size_t> read(std::uint64_t at,
                                                 std::span<std::uint8_t> out) noexcept = 0;

 protected:
  byte_source() = default;
};

[[nodiscard]] result<std::shared_ptr<byte_source>> open_file_source(std::string_view path);

/// A piece of the file that holds records: the contents of a chunk, or one record that stands outside.
struct record_block {
  bytes records{};           ///< Empty: there is none.
  std::uint64_t offset = 0;  ///< In the file.
};

/// Walks over a file. Its memory: one chunk packed and one unpacked. What is not whole is skipped to the
/// next chunk that is, and counted.
class chunk_source {
 public:
  explicit chunk_source(std::shared_ptr<byte_source> file);

  /// The next records; empty at the end. Good until the next call.
  [[nodiscard]] result<record_block> next();
  /// Goes on with the first chunk at or behind `offset`, wherever that is in the file, which may be in
  /// the middle of anything. Nothing of what lies between counts as damage.
  void seek(std::uint64_t offset) noexcept;
  /// The record at `offset`, if it is one of this kind and not too large: its content, else nothing.
  [[nodiscard]] result<bytes> record_at(std::uint64_t offset, opcode kind);

  [[nodiscard]] const recording_damage& damage() const noexcept { return damage_; }
  [[nodiscard]] std::uint64_t position() const noexcept { return at_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// Where the summary begins, 0 where there is none.
  [[nodiscard]] result<std::uint64_t> summary_start();
  /// The first byte behind the header.
  static constexpr std::uint64_t begin_of_records = magic.size();

 private:
  struct record_header {
    opcode kind;
    std::uint64_t length;
  };
  struct chunk_header {
    std::uint64_t size;
    std::uint32_t crc;
    std::uint64_t stored;
    std::size_t header_size;
    enum class packed : std::uint8_t { no, zstd, other } how;
  };

  [[nodiscard]] result<void> look_at_end();
  [[nodiscard]] result<bytes> window(std::uint64_t at, std::size_t size);
  [[nodiscard]] result<bytes> content(std::uint64_t at, std::size_t size);
  [[nodiscard]] std::optional<record_header> believe(bytes begin, std::uint64_t at) const noexcept;
  [[nodiscard]] static std::optional<chunk_header> chunk_from(bytes content,
                                                              std::uint64_t length) noexcept;
  [[nodiscard]] result<record_block> step();
  [[nodiscard]] result<record_block> chunk_at(std::uint64_t at, std::uint64_t length);
  [[nodiscard]] result<std::optional<bytes>> records_of(std::uint64_t at,
                                                        const chunk_header& chunk);
  [[nodiscard]] result<void> lose_chunk(std::uint64_t at, std::uint64_t length);
  [[nodiscard]] result<void> resynchronise(std::uint64_t from);
  void end_here() noexcept;

  std::shared_ptr<byte_source> file_;
  std::uint64_t size_;
  std::uint64_t limit_;  // where the data end: before the summary
  std::uint64_t at_ = 0;
  std::uint64_t trusted_ = 0;  // what comes before is what it seems to be
  bool is_open_ = false;       // the ends have been looked at
  bool is_at_end_ = false;
  bool is_sought_ = false;  // at_ may be in the middle of a record
  bool is_guess_ = false;   // a chunk at at_ was found by its looks
  bool has_end_ = false;    // a proper one
  std::uint64_t summary_start_ = 0;
  std::uint64_t wasted_ = 0;  // bytes that were summed up for nothing
  recording_damage damage_;

  std::vector<std::uint8_t> window_;
  std::uint64_t window_at_ = 0;
  std::size_t window_size_ = 0;  // of it is filled
  std::vector<std::uint8_t> stored_;
  std::vector<std::uint8_t> unpacked_;
  unpacker unpacker_;
};

}  // namespace g4lidar::mcap
