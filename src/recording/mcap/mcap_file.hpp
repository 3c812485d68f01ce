// SPDX-License-Identifier: MIT
// One MCAP file being written: chunks, and the summary behind them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "channels.hpp"
#include "crc32.hpp"
#include "g4lidar/error.hpp"
#include "messages.hpp"
#include "metadata.hpp"
#include "record_text.hpp"
#include "recording/new_file.hpp"

namespace g4lidar::mcap {

/// The messages of a chunk that is being filled. It is written to a file as a whole. *Allocates on
/// open.*
class open_chunk {
 public:
  open_chunk();

  [[nodiscard]] bool is_empty() const noexcept { return count_ == 0; }
  /// Whether a message of so many bytes still fits.
  [[nodiscard]] bool has_room_for(std::size_t size) const noexcept {
    return count_ + 2 < most_messages && text_.size() + size <= room;
  }

  /// Begins a message; write its data to text(), and then call end_message().
  void begin_message(channel_id id, std::uint32_t sequence, std::int64_t wall_ns);
  void end_message() { text_.end(begun_); }
  [[nodiscard]] record_text& text() noexcept { return text_; }
  void clear() noexcept;

  [[nodiscard]] bytes records() const noexcept { return text_.all(); }
  [[nodiscard]] std::uint64_t first_ns() const noexcept { return first_ns_; }
  [[nodiscard]] std::uint64_t last_ns() const noexcept { return last_ns_; }

  struct place {
    std::uint64_t wall_ns;
    std::uint64_t offset;
  };
  [[nodiscard]] std::span<const place> places(channel_id id) const noexcept {
    return places_[index_of(id)];
  }

 private:
  static constexpr std::size_t room = std::size_t{1} << 20U;
  static constexpr std::size_t most_messages = 16384;

  record_text text_;
  std::array<std::vector<place>, topic_count> places_;
  std::size_t begun_ = 0;
  std::size_t count_ = 0;
  std::uint64_t first_ns_ = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last_ns_ = 0;
};

/// *Single thread.* Only complete records are passed to the system; a partial write is reverted.
class mcap_file {
 public:
  /// Creates it, and writes the records before the chunks. `overwrite`: see new_file.
  [[nodiscard]] static result<mcap_file> create(const std::string& path,
                                                const channel_set& channels, bool overwrite);
  mcap_file(mcap_file&&) noexcept = default;

  /// `packed`: the records compressed with zstd, or empty.
  [[nodiscard]] result<void> add(const open_chunk& chunk, bytes packed);
  /// From now on it has these channels; those that it already has must be among them.
  [[nodiscard]] result<void> extend(const channel_set& channels);
  [[nodiscard]] result<void> add_metadata(std::string_view name, const word_map& words);
  /// Writes the summary; nothing can be added afterwards.
  [[nodiscard]] result<void> close();
  /// Replaces an older file when there is something to replace it by.
  [[nodiscard]] result<void> settle() noexcept {
    return has_chunks() ? file_.take_place() : result<void>();
  }
  /// The file itself.
  [[nodiscard]] new_file& place() noexcept { return file_; }

  /// Writes the records before the chunks; whatever was written before is dropped.
  [[nodiscard]] result<void> begin(const channel_set& channels);
  /// Whether there is nothing but these records.
  [[nodiscard]] bool is_empty() const noexcept { return !has_chunks() && metadata_.empty(); }

  [[nodiscard]] const std::string& path() const noexcept { return file_.path(); }
  [[nodiscard]] std::uint64_t size() const noexcept { return offset_; }
  /// Its size if it is closed now.
  [[nodiscard]] std::uint64_t closed_size() const noexcept;
  [[nodiscard]] bool has_chunks() const noexcept { return !chunks_.empty(); }

 private:
  struct chunk_place {
    std::uint64_t first_ns, last_ns, offset, length, index_length, packed_size, size;
    bool is_packed;
    std::array<std::uint64_t, topic_count> index_offsets;  // 0: none
  };
  struct metadata_place {
    std::uint64_t offset, length;
    std::string name;
  };

  explicit mcap_file(new_file file) noexcept : file_(std::move(file)) {}
  [[nodiscard]] result<void> write(bytes data);
  [[nodiscard]] result<void> write_all(bytes data) noexcept;
  [[nodiscard]] result<void> end_data();
  [[nodiscard]] result<void> summarise();
  void put_statistics();
  void put_chunk_index(const chunk_place& of);

  new_file file_;
  channel_set channels_;
  std::uint64_t offset_ = 0;
  crc32 crc_;  // of everything written, and later of the summary
  record_text text_;
  std::vector<chunk_place> chunks_;
  std::vector<metadata_place> metadata_;
  std::array<std::uint64_t, topic_count> messages_{};
};

}  // namespace g4lidar::mcap
