// SPDX-License-Identifier: MIT
// The counts at the end, in words or as JSON, and what they say about an input that is no good.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "g4lidar/stream_counts.hpp"

namespace g4_dump {

/// Two lines for people.
[[nodiscard]] std::string stats_in_words(const g4lidar::stream_counts& counts, std::uint64_t bytes);

/// One JSON object with the keys bytes, packets, responses, points, suspect and skipped, the latter
/// an object of bytes by reason; and a line break.
[[nodiscard]] std::string stats_as_json(const g4lidar::stream_counts& counts, std::uint64_t bytes);

/// Whether bytes look like text, which no recording is.
class text_detector {
 public:
  void look_at(std::span<const std::uint8_t> bytes) noexcept;
  [[nodiscard]] bool is_text() const noexcept { return seen_ > 0 && text_ == seen_; }

 private:
  std::uint64_t seen_ = 0;
  std::uint64_t text_ = 0;
};

/// Why there is no packet in `bytes` bytes of `title`, and what to do: whole sentences.
[[nodiscard]] std::string why_no_packet(const g4lidar::stream_counts& counts, std::uint64_t bytes,
                                        bool is_text, const std::string& title);

/// What to think of an input most of which is no packet: sentences; empty if all is well.
[[nodiscard]] std::string warning_about(const g4lidar::stream_counts& counts, std::uint64_t bytes);

}  // namespace g4_dump
