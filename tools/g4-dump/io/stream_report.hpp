// SPDX-License-Identifier: MIT
// The counts of raw bytes as text or JSON, and what is wrong with an input that holds no packet.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "g4lidar/core/stream_counts.hpp"

namespace g4_dump {

/// Two lines for people.
[[nodiscard]] std::string stats_in_words(const g4lidar::stream_counts& counts, std::uint64_t bytes);

/// An object with the keys bytes, packets, responses, points, suspect and skipped, the latter an
/// object of bytes by reason.
[[nodiscard]] nlohmann::ordered_json counts_as_json(const g4lidar::stream_counts& counts,
                                                    std::uint64_t bytes);

/// Whether bytes look like text, which no recording is: only the first ones are looked at.
[[nodiscard]] bool looks_like_text(std::span<const std::uint8_t> bytes) noexcept;

/// Why there is no packet in `bytes` bytes of `title`, and what to do: whole sentences.
[[nodiscard]] std::string why_no_packet(const g4lidar::stream_counts& counts, std::uint64_t bytes,
                                        bool has_text, const std::string& title);

/// A warning about an input most of which is no packet; empty if there is nothing to warn of.
[[nodiscard]] std::string warning_about(const g4lidar::stream_counts& counts, std::uint64_t bytes);

}  // namespace g4_dump
