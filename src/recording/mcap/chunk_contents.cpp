// SPDX-License-Identifier: MIT
#include "chunk_contents.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "crc32.hpp"
#include "format.hpp"
#include "record_text.hpp"

namespace g4lidar::mcap {
namespace {

/// What is not a message may be this many times as large as the stored chunk.
constexpr std::uint64_t largest_ratio = 64;
/// Messages may be so much larger. Those of 64 KiB that have nothing but zeros are some thousand times as large.
constexpr std::uint64_t more_of_others = 16;
constexpr std::uint64_t more_of_ours = 64;
/// Between two questions whether reading is to end.
constexpr std::size_t check_interval = std::size_t{1} << 20U;

/// Follows the records of a chunk while they are unpacked.
class record_walk {
 public:
  record_walk(std::uint64_t size, std::uint64_t most, found_channels& channels) noexcept
      : size_(size), most_(most), channels_(channels) {}

  /// `all`: from the begin of the chunk. False if this is no intact chunk, or not worth its cost.
  [[nodiscard]] bool follow(bytes all) {
    constexpr std::size_t to_channel = record_header_size + sizeof(std::uint16_t);
    while (next_ < all.size() && all.size() - next_ >= record_header_size) {
      if (all.size() - next_ < to_channel && all.size() < size_) return true;
      const place channel = std::exchange(channel_, {});
      if (channel.size > 0) channels_.take(field_reader(all.subspan(channel.at, channel.size)));
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
      if (kind == opcode::channel)
        channel_ = {next_ + record_header_size, size - record_header_size};
      cost_ += kind == opcode::message ? size / ratio_of_message(all.subspan(next_)) : size;
      if (cost_ > most_) return false;
      next_ += size;
    }
    return true;
  }
  [[nodiscard]] std::uint64_t cost() const noexcept { return cost_; }

 private:
  [[nodiscard]] std::uint64_t ratio_of_message(bytes record) const noexcept {
    const bytes id = record.subspan(record_header_size);
    const bool is_ours = id.size() >= 2 && channels_.reads(load_u16(id, 0));
    return is_ours ? more_of_ours : more_of_others;
  }

  struct place {
    std::size_t at = 0;
    std::size_t size = 0;
  };

  std::uint64_t size_;
  std::uint64_t most_;
  found_channels& channels_;
  std::size_t next_ = 0;
  place channel_;  // the record before it, if that is one of a channel
  std::uint64_t cost_ = 0;
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
  record_walk walk(size, usual + spare_, channels_);
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
  const std::uint64_t cost = std::min<std::uint64_t>(walk.cost(), done);
  spare_ -= std::min(spare_, cost - std::min(cost, usual));
  if (!is_intact || (chunk.crc != 0 && sum.value() != chunk.crc)) return std::nullopt;
  return records;
}

}  // namespace g4lidar::mcap
