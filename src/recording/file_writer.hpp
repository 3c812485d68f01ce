// SPDX-License-Identifier: MIT
// The implementation of recording_writer: the chunk being filled, and its file.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/recording/writer.hpp"
#include "mcap_file.hpp"
#include "messages.hpp"
#include "packer.hpp"

namespace g4lidar {

/// *Single thread.*
class recording_writer::file_writer {
 public:
  file_writer(mcap::mcap_file first, std::string_view path, const recording_options& options);

  void put_bytes(direction way, bytes data, std::int64_t time_ns) noexcept;
  void event(const recorded_event& what) noexcept;
  void scan(const g4lidar::scan& revolution) noexcept;
  void points(std::span<const point> delivered) noexcept { points_.add(delivered); }
  void device(const recorded_device& known) noexcept;
  void set_wall_clock(std::int64_t ahead_ns) noexcept;
  result<void> flush() noexcept;
  result<void> close() noexcept;

  [[nodiscard]] std::optional<error> take_error() noexcept;
  [[nodiscard]] recording_counts counts() const noexcept;
  [[nodiscard]] recorded_digest digest() const noexcept;
  [[nodiscard]] std::string_view path() const noexcept { return file_->path(); }

 private:
  /// If there is no memory, the chunk is lost.
  template <class Work>
  result<void> guarded(Work work) noexcept;
  template <class Put>
  void put(mcap::topic id, std::int64_t time_ns, std::size_t size, Put put) noexcept;
  void begin_chunk(std::int64_t time_ns);
  [[nodiscard]] result<void> end_chunk();
  [[nodiscard]] result<bytes> pack();
  [[nodiscard]] result<void> rotate();
  [[nodiscard]] result<void> end_file(bool is_only_one);
  [[nodiscard]] bool is_due(std::int64_t time_ns) const noexcept;
  [[nodiscard]] std::string next_path() const;
  void lose_chunk() noexcept;
  void keep_trouble(const result<void>& done) noexcept;

  recording_options options_;
  std::string first_path_;
  std::unique_ptr<mcap::mcap_file> file_;
  mcap::open_chunk chunk_;
  std::optional<mcap::packer> packer_;
  std::vector<std::uint8_t> packed_;
  std::vector<float> ranges_;
  bool is_closed_ = false;

  mcap::transport_state transport_;
  std::optional<recorded_device> device_;
  std::array<std::uint32_t, mcap::topic_count> sequences_{};
  std::int64_t ahead_ns_ = 0;  // of the wall clock
  bool is_ahead_given_ = false;
  std::int64_t chunk_ns_ = 0;       // when the chunk was begun
  std::int64_t file_ns_ = 0;        // when the first chunk of the file was
  std::int64_t chunk_last_ns_ = 0;  // the latest time in it
  std::int64_t file_last_ns_ = 0;   // and in the chunks before it
  std::int64_t last_ns_ = 0;        // of all
  std::uint64_t chunk_bytes_ = 0;   // from and to the device

  recording_counts counts_;
  std::uint64_t closed_bytes_ = 0;  // of the files before this one
  payload_digest payload_;
  payload_digest file_payload_;   // of this file
  payload_digest chunk_payload_;  // and of the open chunk
  point_digest points_;
  std::optional<error> trouble_;
  bool is_in_trouble_ = false;
};

}  // namespace g4lidar
