// SPDX-License-Identifier: MIT
// Counts as text.
#include "stream_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/logger.hpp"

namespace g4_dump {
std::string stats_in_words(const stream_counts& counts, std::uint64_t bytes) {
  return fmt::format(
      "{}: {} ({} suspect) with {}, {}\n"
      "{} skipped: {} noise, {} bad header, {} bad checksum, {} truncated\n",
      counted(bytes, "byte"), counted(counts.packets, "packet"), counts.suspect,
      counted(counts.points, "point"), counted(counts.responses, "response"),
      counted(counts.skipped_bytes(), "byte"), counts.skipped(skip_reason::noise),
      counts.skipped(skip_reason::bad_header), counts.skipped(skip_reason::bad_checksum),
      counts.skipped(skip_reason::truncated));
}

nlohmann::ordered_json counts_as_json(const stream_counts& counts, std::uint64_t bytes) {
  nlohmann::ordered_json skipped;
  for (std::size_t i = 0; i < skip_reasons; ++i) {
    skipped[name_of(static_cast<skip_reason>(i))] = counts.skipped_by_reason[i];
  }
  return {{"bytes", bytes},          {"packets", counts.packets}, {"responses", counts.responses},
          {"points", counts.points}, {"suspect", counts.suspect}, {"skipped", skipped}};
}

bool looks_like_text(std::span<const std::uint8_t> bytes) noexcept {
  constexpr std::size_t enough = 4096;
  const auto first = bytes.first(std::min(bytes.size(), enough));
  return !first.empty() && std::all_of(first.begin(), first.end(), [](std::uint8_t c) {
    return (c >= ' ' && c <= '~') || (c >= '\t' && c <= '\r');
  });
}

std::string why_no_packet(const stream_counts& counts, std::uint64_t bytes, bool has_text,
                          const std::string& title) {
  if (bytes == 0) {
    return fmt::format("{} is empty. Give raw bytes from the lidar's port while it was scanning.",
                       title);
  }
  const std::string found =
      fmt::format("no point packet in the {} of {}", counted(bytes, "byte"), title);
  if (has_text) {
    return found +
           ": this is text. Give raw bytes from the lidar's port, or use g4-dump convert for csv "
           "and jsonl.";
  }
  if (counts.responses > 0) {
    return fmt::format("{}, only {}: the lidar was not scanning. Start it, and record again.",
                       found, counts.responses == 1 ? "a response" : "responses");
  }
  return found +
         ". Was the port read at a wrong baud rate (a G4 needs 230400)? Give raw bytes from the "
         "lidar's port.";
}

std::string warning_about(const stream_counts& counts, std::uint64_t bytes) {
  if (counts.packets == 0 || counts.skipped_bytes() * 2 <= bytes) return {};
  return "More than half of the bytes belong to no packet. Was the port read at a wrong baud rate "
         "(a G4 needs 230400)?\n";
}

}  // namespace g4_dump
