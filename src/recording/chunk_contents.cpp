// SPDX-License-Identifier: MIT
#include "chunk_contents.hpp"

#include <algorithm>
#include <string_view>

#include "crc32.hpp"
#include "format.hpp"
#include "record_text.hpp"

namespace g4lidar::mcap {
namespace {

/// What is not a message may be this many times as large as the stored chunk.
constexpr std::uint64_t largest_ratio = 64;
/// Between two questions whether reading is to end.
constexpr std::size_t check_interval = std::size_t{1} << 20U;

/// Follows the records of a chunk while they are unpacked.
class record_walk {
 public:
  record_walk(std::uint64_t size, std::uint64_t most_useless) noexcept
      : size_(size), most_useless_(most_useless) {}

  /// `all`: from the begin of the chunk. False if this is no intact chunk, or not worth its cost.
  [[nodiscard]] bool follow(bytes all) noexcept {
    while (next_ < all.size() && all.size() - next_ >= record_header_size) {
      const auto kind = static_cast<opcode>(all[next_]);
      if (kind == opcode{}) return false;  // the specification excludes it
      const std::uint64_t length = load_u64(all, next_ + 1);
      const std::uint64_t left = size_ - next_ - record_header_size;
      if (length > left) {
        next_ = static_cast<std::size_t>(size_);
        return has_message_;  // what is before it can be read
      }
      const auto size = record_header_size + static_cast<std::size_t>(length);
      if (kind == opcode::message) has_message_ = true;
      if (kind != opcode::message) useless_ += size;
      if (useless_ > most_useless_) return false;
      next_ += size;
    }
    return true;
  }
  [[nodiscard]] std::uint64_t useless() const noexcept { return useless_; }

 private:
  std::uint64_t size_;
  std::uint64_t most_useless_;
  std::size_t next_ = 0;
  std::uint64_t useless_ = 0;
  bool has_message_ = false;
};

}  // namespace

std::optional<chunk_header> chunk_header::from(bytes content, std::uint64_t length) noexcept {
  field_reader fields(content);
  const auto first_ns = fields.take<std::uint64_t>();
  const auto last_ns = fields.take<std::uint64_t>();
  chunk_header chunk{};
  chunk.size = fields.take<std::uint64_t>();
  chunk.crc = fields.take<std::uint32_t>();
  const auto name_size = fields.take<std::uint32_t>();
  if (name_size > longest_packing) return std::nullopt;
  const bytes name = fields.take(name_size);
  chunk.stored = fields.take<std::uint64_t>();
  chunk.header_size = chunk_fields + name_size;
  if (!fields.is_good() || first_ns > last_ns) return std::nullopt;
  if (chunk.size > largest_chunk || chunk.stored > largest_chunk) return std::nullopt;
  if (length != chunk.header_size + chunk.stored) return std::nullopt;
  const std::string_view packing(reinterpret_cast<const char*>(name.data()), name.size());
  using enum packed;
  chunk.how = packing.empty() ? no : packing == "zstd" ? zstd : other;
  if (chunk.how == other && packing != "lz4") return std::nullopt;
  if (chunk.how == no && chunk.size != chunk.stored) return std::nullopt;
  return chunk;
}

std::optional<bytes> chunk_contents::records_of(bytes stored, const chunk_header& chunk,
                                                byte_source& file) {
  const auto size = static_cast<std::size_t>(chunk.size);
  const std::uint64_t usual = largest_ratio * stored.size();
  record_walk walk(size, usual + spare_);
  crc32 sum;
  std::size_t done = 0;
  const auto take = [&](bytes all) {
    while (done < all.size()) {
      const std::size_t more = std::min(all.size() - done, check_interval);
      if (chunk.crc != 0) sum.add(all.subspan(done, more));
      done += more;
      if (!walk.follow(all.first(done)) || file.is_cancelled()) return false;
    }
    return true;
  };
  bool is_intact = false;
  bytes records = stored;
  if (chunk.how == chunk_header::packed::zstd) {
    is_intact = unpacker_.unpack(stored, size, unpacked_, take);
    bytes_unpacked_ += done;
    records = bytes(unpacked_).first(is_intact ? size : 0);
  } else {
    is_intact = take(stored);
  }
  const std::uint64_t useless = std::min<std::uint64_t>(walk.useless(), done);
  spare_ -= std::min(spare_, useless - std::min(useless, usual));
  if (!is_intact || (chunk.crc != 0 && sum.value() != chunk.crc)) return std::nullopt;
  return records;
}

}  // namespace g4lidar::mcap
