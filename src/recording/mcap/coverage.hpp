// SPDX-License-Identifier: MIT
// The times and the bytes of a recorded file and of its open chunk.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/recording/contents.hpp"

namespace g4lidar {

/// What is in the file, and in the chunk that is being filled. *Single thread, never allocates.*
class coverage {
 public:
  /// A chunk begins; `is_first` of its file.
  void begin_chunk(std::int64_t time_ns, bool is_first) noexcept {
    if (is_first) file_ns_ = time_ns;
    chunk_ns_ = chunk_last_ns_ = time_ns;
    chunk_bytes_ = 0;
  }
  void add(std::int64_t time_ns) noexcept { chunk_last_ns_ = std::max(chunk_last_ns_, time_ns); }
  void add(direction direction, bytes data) noexcept {
    chunk_payload_.add(direction, data);
    chunk_bytes_ += data.size();
  }
  /// The chunk was written.
  void keep_chunk() noexcept {
    file_payload_ = chunk_payload_;
    file_last_ns_ = chunk_last_ns_;
  }
  /// The chunk was lost; returns its number of bytes from and to the device.
  std::uint64_t lose_chunk() noexcept {
    chunk_payload_ = file_payload_;
    return std::exchange(chunk_bytes_, 0);
  }
  /// The open chunk, with these bytes, is the first of another file.
  void begin_file(const payload_digest& chunk) noexcept {
    file_ns_ = chunk_ns_;
    file_payload_ = {};
    chunk_payload_ = chunk;
  }

  /// From the begin of the chunk to `time_ns`.
  [[nodiscard]] std::int64_t chunk_age_ns(std::int64_t time_ns) const noexcept {
    return detail::saturating_sub(time_ns, chunk_ns_);
  }
  /// From the begin of the file to the end of the open chunk.
  [[nodiscard]] std::int64_t length_ns() const noexcept {
    return detail::saturating_sub(chunk_last_ns_, file_ns_);
  }
  /// Of what was written to the file.
  [[nodiscard]] const payload_digest& payload() const noexcept { return file_payload_; }
  [[nodiscard]] std::int64_t first_ns() const noexcept { return file_ns_; }
  [[nodiscard]] std::int64_t last_ns() const noexcept { return file_last_ns_; }

 private:
  std::int64_t chunk_ns_ = 0;
  std::int64_t chunk_last_ns_ = 0;
  std::uint64_t chunk_bytes_ = 0;
  std::int64_t file_ns_ = 0;
  std::int64_t file_last_ns_ = 0;
  payload_digest file_payload_;
  payload_digest chunk_payload_;  // of the file and the open chunk
};

}  // namespace g4lidar
