// SPDX-License-Identifier: MIT
// Counts as text.
#include "stats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace g4_dump {
namespace {

using g4lidar::skip_reason;

std::string counted(std::uint64_t number, const char* noun) {
  return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
}

}  // namespace

std::string stats_in_words(const g4lidar::stream_counts& counts, std::uint64_t bytes) {
  return fmt::format(
      "{}: {} ({} suspect) with {}, {}\n"
      "{} skipped: {} noise, {} bad header, {} bad checksum, {} truncated\n",
      counted(bytes, "byte"), counted(counts.packets, "packet"), counts.suspect,
      counted(counts.points, "point"), counted(counts.responses, "response"),
      counted(counts.skipped_bytes(), "byte"), counts.skipped(skip_reason::noise),
      counts.skipped(skip_reason::bad_header), counts.skipped(skip_reason::bad_checksum),
      counts.skipped(skip_reason::truncated));
}

std::string stats_as_json(const g4lidar::stream_counts& counts, std::uint64_t bytes) {
  nlohmann::ordered_json skipped;
  for (std::size_t i = 0; i < g4lidar::skip_reasons; ++i) {
    skipped[name_of(static_cast<skip_reason>(i))] = counts.skipped_by_reason[i];
  }
  nlohmann::ordered_json all;
  all["bytes"] = bytes;
  all["packets"] = counts.packets;
  all["responses"] = counts.responses;
  all["points"] = counts.points;
  all["suspect"] = counts.suspect;
  all["skipped"] = std::move(skipped);
  return all.dump() + "\n";
}

void text_detector::look_at(std::span<const std::uint8_t> bytes) noexcept {
  constexpr std::uint64_t enough = 4096;
  const auto count = std::min<std::uint64_t>(bytes.size(), enough - seen_);
  const std::span<const std::uint8_t> part = bytes.first(static_cast<std::size_t>(count));
  seen_ += part.size();
  text_ += static_cast<std::uint64_t>(std::count_if(part.begin(), part.end(), [](std::uint8_t c) {
    return (c >= ' ' && c <= '~') || (c >= '\t' && c <= '\r');
  }));
}

std::string why_no_packet(const g4lidar::stream_counts& counts, std::uint64_t bytes, bool is_text,
                          const std::string& title) {
  if (bytes == 0) {
    return fmt::format(
        "{} is empty. Give bytes as they came from the lidar's port while it was "
        "scanning.",
        title);
  }
  const std::string found =
      fmt::format("no point packet in the {} of {}", counted(bytes, "byte"), title);
  if (is_text) {
    return found +
           ": this is text. Give raw bytes as they came from the lidar's port; what was "
           "decoded already cannot be decoded again.";
  }
  if (counts.responses > 0) {
    return fmt::format(
        "{}, only {}: the lidar was not scanning. Record again after sending it "
        "A5 60, the command to start.",
        found, counts.responses == 1 ? "a response" : "responses");
  }
  return found +
         ". Perhaps the port was read at a wrong baud rate (a G4 needs 230400), or this is "
         "not a raw recording: give bytes as they came from the lidar's port.";
}

std::string warning_about(const g4lidar::stream_counts& counts, std::uint64_t bytes) {
  if (counts.packets == 0 || counts.skipped_bytes() * 2 <= bytes) return {};
  return "More than half of the bytes belong to no packet. Perhaps the port was read at a wrong "
         "baud rate (a G4 needs 230400), or this is not a raw recording.\n";
}

}  // namespace g4_dump
