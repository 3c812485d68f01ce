// SPDX-License-Identifier: MIT
// The chunks of a file one after the other, also of a damaged file.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/writer.hpp"
#include "packer.hpp"
#include "transport/owned_fd.hpp"

namespace g4lidar::mcap {

/// Bytes of a file, or of a test.
class byte_source {
 public:
  virtual ~byte_source() = default;
  byte_source(const byte_source&) = delete;
  byte_source& operator=(const byte_source&) = delete;

  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
  /// Reads up to out.size() bytes from `at` on; fewer only at the end and after a failure.
  [[nodiscard]] std::size_t read(std::uint64_t at, std::span<std::uint8_t> out) noexcept {
    if (trouble_) return 0;
    const auto count = read_some(at, out);
    if (!count) fail(count.error());
    return count.value_or(0);
  }
  /// Why nothing can be read any more.
  [[nodiscard]] const std::optional<error>& trouble() const noexcept { return trouble_; }
  void fail(const error& why) noexcept { trouble_ = why; }

 protected:
  byte_source() = default;

 private:
  [[nodiscard]] virtual result<std::size_t> read_some(std::uint64_t at,
                                                      std::span<std::uint8_t> out) noexcept = 0;

  std::optional<error> trouble_;
};

[[nodiscard]] result<std::shared_ptr<byte_source>> open_file_source(std::string_view path);
/// Whether it begins like an MCAP file.
[[nodiscard]] bool has_magic(byte_source& file) noexcept;

/// A part of the file that contains records: the contents of a chunk, or one record outside of
/// chunks.
struct record_block {
  bytes records{};           ///< Empty if there is none.
  std::uint64_t offset = 0;  ///< In the file.
};

/// Reads a file in sequence. Its memory: one compressed and one uncompressed chunk. Damaged parts
/// are skipped to the next intact chunk, and counted.
class chunk_source {
 public:
  explicit chunk_source(std::shared_ptr<byte_source> file);

  /// The next records; empty at the end, and if the file cannot be read. Valid until the next call.
  [[nodiscard]] record_block next();
  /// Continues with the first chunk at or behind `offset`, which may be anywhere in the file. The
  /// bytes before that chunk do not count as damage.
  void seek(std::uint64_t offset) noexcept;
  /// The content of the record at `offset`; empty if it has another kind, or is too large.
  [[nodiscard]] bytes record_at(std::uint64_t offset, opcode kind);

  [[nodiscard]] const recording_damage& damage() const noexcept { return damage_; }
  [[nodiscard]] std::uint64_t position() const noexcept { return at_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  /// Where the summary begins, 0 if there is none.
  [[nodiscard]] std::uint64_t summary_start();
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

  void look_at_end();
  [[nodiscard]] bytes window(std::uint64_t at, std::size_t size);
  [[nodiscard]] bytes content(std::uint64_t at, std::size_t size);
  [[nodiscard]] std::optional<record_header> believe(bytes begin, std::uint64_t at) const noexcept;
  [[nodiscard]] static std::optional<chunk_header> chunk_from(bytes content,
                                                              std::uint64_t length) noexcept;
  [[nodiscard]] record_block step();
  [[nodiscard]] record_block chunk_at(std::uint64_t at, std::uint64_t length);
  [[nodiscard]] std::optional<bytes> records_of(std::uint64_t at, const chunk_header& chunk);
  void lose_chunk(std::uint64_t at, std::uint64_t length);
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
  std::vector<std::uint8_t> unpacked_;
  unpacker unpacker_;
};

}  // namespace g4lidar::mcap
