// SPDX-License-Identifier: MIT
#include "chunk_source.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "g4lidar/recording/writer.hpp"
#include "record_text.hpp"

namespace g4lidar::mcap {
namespace {

constexpr std::size_t window_room = std::size_t{256} << 10U;
/// Wrong guesses may cost this many times the size of the file.
constexpr std::uint64_t patience = 8;

}  // namespace

chunk_source::chunk_source(std::shared_ptr<byte_source> file, found_channels known)
    : file_(std::move(file)),
      size_(file_->size()),
      limit_(size_),
      window_(window_room),
      contents_(std::move(known)) {}

// ---- bytes --------------------------------------------------------------------------------------

/// What the window has from `offset` on: at least `least` bytes (at most its size), or all that the file has.
bytes chunk_source::ahead(std::uint64_t offset, std::size_t least) {
  const bool begins_in = offset >= window_at_ && offset <= window_at_ + window_size_;
  const std::uint64_t held = begins_in ? window_at_ + window_size_ - offset : 0;
  const std::uint64_t there = offset < size_ ? size_ - offset : 0;
  if (held < std::min<std::uint64_t>(least, there)) {
    window_at_ = offset;
    window_size_ = file_->read(offset, window_);
  }
  const std::uint64_t skipped = std::min<std::uint64_t>(offset - window_at_, window_size_);
  return bytes(window_).first(window_size_).subspan(static_cast<std::size_t>(skipped));
}

/// `size` bytes from `offset` on (at most the size of the window), or all available ones.
bytes chunk_source::window(std::uint64_t offset, std::size_t size) {
  const bytes all = ahead(offset, size);
  return all.first(std::min(size, all.size()));
}

/// The same for any size.
bytes chunk_source::content(std::uint64_t offset, std::size_t size) {
  if (size <= window_room) return window(offset, size);
  if (stored_.size() < size) stored_.resize(size);
  return bytes(stored_).first(file_->read(offset, std::span(stored_).first(size)));
}

// ---- the sequence of records -------------------------------------------------------------------

/// A proper end: the end of the data, optionally a summary, the footer, the magic.
void chunk_source::look_at_end() {
  is_open_ = true;
  at_ = trusted_ = begin_of_records;
  constexpr std::size_t tail = footer_size + magic.size();
  constexpr std::size_t data_end_size = record_header_size + data_end_length;
  if (size_ < begin_of_records + data_end_size + tail) return;
  const auto last = window(size_ - tail, tail);
  if (last.size() < tail || !std::ranges::equal(last.last(magic.size()), magic)) return;
  if (last[0] != static_cast<std::uint8_t>(opcode::footer) || load_u64(last, 1) != 20) return;
  const std::uint64_t summary = load_u64(last, record_header_size);
  const std::uint64_t end = summary == 0 ? size_ - tail : summary;
  if (end > size_ - tail || end < begin_of_records + data_end_size) return;
  const auto before = window(end - data_end_size, data_end_size);
  const bool is_data_end = before.size() == data_end_size &&
                           before[0] == static_cast<std::uint8_t>(opcode::data_end) &&
                           load_u64(before, 1) == data_end_length;
  if (!is_data_end) return;
  has_end_ = true;
  summary_start_ = summary;
  limit_ = end;
}

std::uint64_t chunk_source::summary_start() {
  if (!is_open_) look_at_end();
  return summary_start_;
}

void chunk_source::seek(std::uint64_t offset) noexcept {
  at_ = std::max(offset, begin_of_records);
  is_sought_ = true;
  is_at_end_ = false;
}

record_block chunk_source::next() {
  if (!is_open_) {
    const std::uint64_t sought = at_;
    look_at_end();
    if (is_sought_) at_ = sought;
  }
  recording_damage kept = damage_;
  if (is_sought_) {
    resynchronise(at_);
    damage_ = kept;
    if (file_->is_cancelled()) return {};
    is_sought_ = false;
  }
  while (!is_at_end_ && !file_->trouble() && !file_->is_cancelled()) {
    kept = damage_;
    const record_block found = step();
    // Unreadable data is not damage, and a cancelled step is repeated.
    if (file_->trouble() || file_->is_cancelled()) damage_ = kept;
    if (!found.records.empty()) return found;
  }
  return {};
}

/// One record: its block, if it is to be read, else nothing.
record_block chunk_source::step() {
  if (at_ >= limit_) {
    end_here();
    return {};
  }
  const auto begin = window(at_, record_header_size + longest_chunk_header);
  const auto header = believe_at(begin, at_);
  if (!header) {
    resynchronise(trusted_);
    return {};
  }
  if (header->kind == opcode::chunk) return chunk_at(at_, header->length);
  is_guess_ = false;
  if (header->kind == opcode::data_end) {
    end_here();
    return {};
  }
  const std::uint64_t at = at_;
  const std::uint64_t size = record_header_size + header->length;
  at_ += size;
  const bool is_read = header->kind == opcode::message || header->kind == opcode::channel ||
                       header->kind == opcode::metadata;
  if (!is_read || size > largest_record) return {};
  const auto record = content(at, static_cast<std::size_t>(size));
  if (record.size() < size) return {};  // the file has become shorter
  if (header->kind == opcode::channel) contents_.take_channel(record.subspan(record_header_size));
  return {record, at};
}

record_block chunk_source::chunk_at(std::uint64_t offset, std::uint64_t length) {
  const auto begin = window(offset + record_header_size, longest_chunk_header);
  const auto chunk = chunk_header::from(begin, length);
  if (!chunk) return {};  // believe() has checked it
  if (chunk->how == chunk_header::packed::zstd && !has_zstd()) {
    file_->fail(
        error(task::reading, problem::bad_option, "a recording packed with zstd: built without"));
    return {};
  }
  const auto records = records_of(offset + record_header_size + chunk->header_size, *chunk);
  if (file_->is_cancelled()) return {};
  if (!records) {
    lose_chunk(offset, length);
    return {};
  }
  is_guess_ = false;
  at_ = trusted_ = offset + record_header_size + length;
  return {*records, offset};
}

/// The uncompressed records, if they are intact.
std::optional<bytes> chunk_source::records_of(std::uint64_t offset, const chunk_header& chunk) {
  if (chunk.how == chunk_header::packed::other) return std::nullopt;
  const auto stored = content(offset, static_cast<std::size_t>(chunk.stored));
  if (stored.size() < chunk.stored) return std::nullopt;
  return contents_.records_of(stored, chunk, *file_);
}

/// A chunk is damaged. If another record follows it, it was a chunk; otherwise its length is also
/// wrong, or it was not a chunk.
void chunk_source::lose_chunk(std::uint64_t offset, std::uint64_t length) {
  const std::uint64_t size = record_header_size + length;
  const auto behind = window(offset + size, record_header_size + longest_chunk_header);
  const bool is_followed = offset + size == limit_ || believe_at(behind, offset + size).has_value();
  const bool was_guess = std::exchange(is_guess_, false);
  wasted_ += size;
  if (is_followed || !was_guess) ++damage_.chunks_lost;
  if (is_followed || wasted_ / patience > size_) {
    damage_.bytes_skipped += size;
    at_ = trusted_ = offset + size;
    return;
  }
  damage_.bytes_skipped += 1;
  return resynchronise(offset + 1);
}

/// Searches for a chunk, from `from` on. Bytes that were read are not read again for each wrong guess.
void chunk_source::resynchronise(std::uint64_t from) {
  std::uint64_t at = from;
  while (at + record_header_size < limit_) {
    if (file_->is_cancelled()) return;
    constexpr std::size_t wanted = record_header_size + longest_chunk_header;
    const auto part = ahead(at, wanted + 1);
    if (part.size() < record_header_size) break;
    std::size_t i = 0;
    const bool is_last = at + part.size() >= limit_;
    const std::size_t end = is_last || part.size() < wanted ? part.size() : part.size() - wanted;
    for (; i < end; ++i) {
      const void* const found =
          std::memchr(part.data() + i, static_cast<int>(opcode::chunk), end - i);
      if (found == nullptr) {
        i = end;
        break;
      }
      i = static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - part.data());
      if (believe_at(part.subspan(i), at + i)) {
        damage_.bytes_skipped += at + i - from;
        at_ = trusted_ = at + i;
        is_guess_ = true;
        return;
      }
    }
    at += std::max<std::size_t>(i, 1);
  }
  damage_.bytes_skipped += limit_ - std::min(from, limit_);
  at_ = limit_;
}

void chunk_source::end_here() noexcept {
  is_at_end_ = true;
  at_ = limit_;
  if (!has_end_) damage_.is_cut_off = true;
}

bytes chunk_source::record_at(std::uint64_t offset, opcode kind) {
  const bytes begin = window(offset, record_header_size);
  if (begin.size() < record_header_size) return {};
  const std::uint64_t length = load_u64(begin, 1);
  const bool is_it = begin[0] == static_cast<std::uint8_t>(kind);
  if (!is_it || length > largest_record) return {};
  const bytes found = content(offset + record_header_size, static_cast<std::size_t>(length));
  return found.size() < length ? bytes{} : found;
}

}  // namespace g4lidar::mcap
