// SPDX-License-Identifier: MIT
// The implementation of recording_reader: reads recorded items from the records of the chunks.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "channels.hpp"
#include "chunk_source.hpp"
#include "g4lidar/recording/reader.hpp"
#include "messages.hpp"
#include "metadata.hpp"

namespace g4lidar {

/// *Single thread.*
class recording_reader::file_reader {
 public:
  /// `path` is for errors.
  [[nodiscard]] static result<std::unique_ptr<file_reader>> open(
      std::shared_ptr<mcap::byte_source> file, std::string_view path,
      const reading_options& options);

  [[nodiscard]] result<std::optional<recorded_item>> next() noexcept;
  [[nodiscard]] const std::optional<recorded_device>& device() const noexcept { return device_; }
  [[nodiscard]] const std::optional<recorded_digest>& digest() const noexcept { return digest_; }
  /// As its driver has read it at last, where that is not what it was opened as.
  [[nodiscard]] const g4lidar::model& model() const noexcept {
    const g4lidar::model* const last = device_ ? device_->read_as() : nullptr;
    return last != nullptr ? *last : channels_.model();
  }
  [[nodiscard]] const g4lidar::model& begun_as() const noexcept { return channels_.model(); }
  [[nodiscard]] std::int64_t first_ns() const noexcept { return first_ns_; }
  [[nodiscard]] std::int64_t last_ns() const noexcept { return last_ns_; }
  [[nodiscard]] const recording_damage& damage() const noexcept;
  [[nodiscard]] std::uint64_t position() const noexcept { return chunks_->position(); }
  [[nodiscard]] std::uint64_t size() const noexcept { return chunks_->size(); }

 private:
  file_reader(std::shared_ptr<mcap::byte_source> file, std::string_view path);

  [[nodiscard]] result<void> begin(const reading_options& options);
  [[nodiscard]] result<void> check();  // why reading ended early, if so
  void read_summary();
  void read_front();
  void seek(std::int64_t from_ns);
  [[nodiscard]] std::optional<std::uint64_t> chunk_before(std::int64_t from_ns);
  void find_end();
  [[nodiscard]] std::optional<std::int64_t> first_time_in(bytes& records);
  [[nodiscard]] std::optional<std::int64_t> first_time_ahead();

  [[nodiscard]] std::optional<recorded_item> advance();
  [[nodiscard]] std::optional<recorded_item> read();
  [[nodiscard]] std::optional<recorded_item> item_in(mcap::field_reader record) noexcept;
  void take(mcap::opcode kind, mcap::field_reader record);
  [[nodiscard]] bool skips(std::uint32_t sequence) noexcept;

  std::string path_;
  std::shared_ptr<mcap::byte_source> file_;
  std::unique_ptr<mcap::chunk_source> chunks_;
  bytes records_;  // of the block, not read yet
  mcap::found_channels channels_;
  std::optional<recorded_device> device_;
  std::optional<recorded_digest> digest_;
  mutable recording_damage damage_;
  std::uint64_t bytes_skipped_ = 0;            // in chunks
  std::optional<std::int64_t> wall_ahead_ns_;  // at the last item with both times
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::int64_t from_ns_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t to_ns_ = never_ns;
  std::optional<std::uint32_t> sequence_;  // the last one, of bytes from the device
  bool is_gap_ = false;
  bool is_over_ = false;
  std::optional<recorded_item> waiting_;  // the item behind a generated event
  mcap::transport_state transport_;       // the state after the returned items
  bool is_state_reported_ = true;         // otherwise the skipped state is returned first
};

/// Opens a recording in any kind of byte source.
struct recording_access {
  /// As which model its driver began to read it.
  [[nodiscard]] static const model& begun_as(const recording_reader& of) noexcept;
  [[nodiscard]] static result<recording_reader> open(std::shared_ptr<mcap::byte_source> file,
                                                     std::string_view path,
                                                     const reading_options& options);
};

}  // namespace g4lidar
