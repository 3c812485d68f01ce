// SPDX-License-Identifier: MIT
#include "chunk_source.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "crc32.hpp"
#include "record_text.hpp"
#include "transport/system_calls.hpp"

namespace g4lidar::mcap {
namespace {

constexpr std::size_t window_room = std::size_t{256} << 10U;
/// A chunk's fields before its records, with the longest name of a compression.
constexpr std::size_t longest_packing = 16;
constexpr std::size_t chunk_fields = 8 + 8 + 8 + 4 + 4 + 8;
constexpr std::size_t longest_chunk_header = chunk_fields + longest_packing;
constexpr std::size_t data_end_length = 4;
/// Wrong guesses may cost this many times the size of the file.
constexpr std::uint64_t patience = 8;

class file_source final : public byte_source {
 public:
  file_source(owned_fd fd, std::uint64_t size, std::string path) noexcept
      : fd_(std::move(fd)), size_(size), path_(std::move(path)) {}

  [[nodiscard]] std::uint64_t size() const noexcept override { return size_; }

 private:
  [[nodiscard]] result<std::size_t> read_some(std::uint64_t at,
                                              std::span<std::uint8_t> out) noexcept override {
    std::size_t done = 0;
    while (done < out.size()) {
      const auto from = static_cast<off_t>(at + done);
      const ssize_t count = uninterrupted(
          [&] { return ::pread(fd_.get(), out.data() + done, out.size() - done, from); });
      if (count < 0) return failure(task::reading, problem::system, path_, errno);
      if (count == 0) break;
      done += static_cast<std::size_t>(count);
    }
    return done;
  }

  owned_fd fd_;
  std::uint64_t size_;
  std::string path_;
};

}  // namespace

result<std::shared_ptr<byte_source>> open_file_source(std::string_view path) {
  std::string name(path);
  constexpr int flags = O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC;  // it may be a pipe
  owned_fd fd(uninterrupted([&] { return ::open(name.c_str(), flags); }));
  if (fd.get() < 0) return failure(task::opening, problem::system, path, errno);
  struct stat file{};
  if (::fstat(fd.get(), &file) != 0) return failure(task::opening, problem::system, path, errno);
  if (!S_ISREG(file.st_mode)) {
    return failure(task::opening, problem::bad_option, name + " is not a file");
  }
  return std::make_shared<file_source>(std::move(fd), static_cast<std::uint64_t>(file.st_size),
                                       std::move(name));
}

bool has_magic(byte_source& file) noexcept {
  std::array<std::uint8_t, magic.size()> begin{};
  return file.read(0, begin) == begin.size() && begin == magic;
}

chunk_source::chunk_source(std::shared_ptr<byte_source> file)
    : file_(std::move(file)), size_(file_->size()), limit_(size_), window_(window_room) {}

// ---- bytes --------------------------------------------------------------------------------------

/// `size` bytes from `at` on (at most the size of the window), or all available ones.
bytes chunk_source::window(std::uint64_t at, std::size_t size) {
  const bool begins_in = at >= window_at_ && at <= window_at_ + window_size_;
  const std::uint64_t held = begins_in ? window_at_ + window_size_ - at : 0;
  const std::uint64_t there = at < size_ ? size_ - at : 0;
  if (held < std::min<std::uint64_t>(size, there)) {
    window_at_ = at;
    window_size_ = file_->read(at, window_);
  }
  const std::uint64_t skipped = std::min<std::uint64_t>(at - window_at_, window_size_);
  const bytes all = bytes(window_).first(window_size_).subspan(static_cast<std::size_t>(skipped));
  return all.first(std::min(size, all.size()));
}

/// The same for any size.
bytes chunk_source::content(std::uint64_t at, std::size_t size) {
  if (size <= window_room) return window(at, size);
  if (stored_.size() < size) stored_.resize(size);
  return bytes(stored_).first(file_->read(at, std::span(stored_).first(size)));
}

// ---- plausibility checks -----------------------------------------------------------------------

/// Whether a record can begin like this, at `at`. Chunks, which are searched for, have several
/// fields to check.
std::optional<chunk_source::record_header> chunk_source::believe(bytes begin,
                                                                 std::uint64_t at) const noexcept {
  if (begin.size() < record_header_size) return std::nullopt;
  const record_header header{static_cast<opcode>(begin[0]), load_u64(begin, 1)};
  const std::uint64_t left = limit_ - std::min(limit_, at);
  if (left < record_header_size || header.length > left - record_header_size) return std::nullopt;
  switch (header.kind) {
    case opcode::chunk:
      if (!chunk_from(begin.subspan(record_header_size), header.length)) return std::nullopt;
      break;
    case opcode::message_index:
      if (header.length < 6 || (header.length - 6) % 16 != 0) return std::nullopt;
      break;
    case opcode::data_end:
      if (header.length != data_end_length) return std::nullopt;
      break;
    case opcode::message:
      if (header.length < message_header_size) return std::nullopt;
      break;
    case opcode::header:
    case opcode::schema:
    case opcode::channel:
    case opcode::attachment:
    case opcode::metadata:
      break;
    default:
      if (begin[0] < 0x80) return std::nullopt;  // otherwise it is an extension of another program
  }
  return header;
}

std::optional<chunk_source::chunk_header> chunk_source::chunk_from(bytes content,
                                                                   std::uint64_t length) noexcept {
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
  using enum chunk_header::packed;
  chunk.how = packing.empty() ? no : packing == "zstd" ? zstd : other;
  if (chunk.how == other && packing != "lz4") return std::nullopt;
  if (chunk.how == no && chunk.size != chunk.stored) return std::nullopt;
  return chunk;
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
  if (std::exchange(is_sought_, false)) {
    resynchronise(at_);
    damage_ = kept;
  }
  while (!is_at_end_ && !file_->trouble()) {
    kept = damage_;
    const record_block found = step();
    if (file_->trouble()) damage_ = kept;  // unreadable data is not damage
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
  const auto header = believe(begin, at_);
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
  return {record, at};
}

record_block chunk_source::chunk_at(std::uint64_t at, std::uint64_t length) {
  const auto begin = window(at + record_header_size, longest_chunk_header);
  const auto chunk = chunk_from(begin, length);
  if (!chunk) return {};  // believe() has checked it
  if (chunk->how == chunk_header::packed::zstd && !has_zstd()) {
    file_->fail(
        error(task::reading, problem::bad_option, "a recording packed with zstd: built without"));
    return {};
  }
  const auto records = records_of(at + record_header_size + chunk->header_size, *chunk);
  if (!records) {
    lose_chunk(at, length);
    return {};
  }
  is_guess_ = false;
  at_ = trusted_ = at + record_header_size + length;
  return {*records, at};
}

/// The uncompressed records, if their checksum matches.
std::optional<bytes> chunk_source::records_of(std::uint64_t at, const chunk_header& chunk) {
  if (chunk.how == chunk_header::packed::other) return std::nullopt;
  const auto stored = content(at, static_cast<std::size_t>(chunk.stored));
  if (stored.size() < chunk.stored) return std::nullopt;
  bytes records = stored;
  if (chunk.how == chunk_header::packed::zstd) {
    const auto size = static_cast<std::size_t>(chunk.size);
    if (!unpacker_.unpack(stored, size, unpacked_)) return std::nullopt;
    records = bytes(unpacked_).first(size);
  }
  if (chunk.crc != 0 && crc32_of(records) != chunk.crc) return std::nullopt;
  return records;
}

/// A chunk is damaged. If another record follows it, it was a chunk; otherwise its length is also
/// wrong, or it was not a chunk.
void chunk_source::lose_chunk(std::uint64_t at, std::uint64_t length) {
  const std::uint64_t size = record_header_size + length;
  const auto behind = window(at + size, record_header_size + longest_chunk_header);
  const bool is_followed = at + size == limit_ || believe(behind, at + size).has_value();
  const bool was_guess = std::exchange(is_guess_, false);
  wasted_ += size;
  if (is_followed || !was_guess) ++damage_.chunks_lost;
  if (is_followed || wasted_ / patience > size_) {
    damage_.bytes_skipped += size;
    at_ = trusted_ = at + size;
    return;
  }
  damage_.bytes_skipped += 1;
  return resynchronise(at + 1);
}

/// Searches for a chunk, from `from` on.
void chunk_source::resynchronise(std::uint64_t from) {
  std::uint64_t at = from;
  while (at + record_header_size < limit_) {
    const auto part = window(at, window_room);
    if (part.size() < record_header_size) break;
    std::size_t i = 0;
    constexpr std::size_t wanted = record_header_size + longest_chunk_header;
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
      if (believe(part.subspan(i), at + i)) {
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
