// SPDX-License-Identifier: MIT
// Numbers by which two recordings, or the points of two runs, are told to be the same.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string_view>

#include "g4lidar/bytes.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// Which way bytes went.
enum class direction : std::uint8_t { from_device, to_device };

/// FNV-1a over what went over a line: the bytes and their directions in order, however the readings
/// were cut. *Single thread, never allocates, never waits.*
class payload_digest {
 public:
  /// Bytes that went that way.
  constexpr void add(direction way, bytes data) noexcept {
    if (data.empty()) return;
    if (is_first_ || way != way_) mix(0x100U + static_cast<unsigned>(way));
    is_first_ = false;
    way_ = way;
    for (const std::uint8_t byte : data) mix(byte);
  }
  /// The digest of all so far.
  [[nodiscard]] constexpr std::uint64_t value() const noexcept { return hash_; }

 private:
  constexpr void mix(unsigned symbol) noexcept { hash_ = (hash_ ^ symbol) * 0x100000001B3U; }

  std::uint64_t hash_ = 0xCBF29CE484222325U;
  direction way_ = direction::from_device;
  bool is_first_ = true;
};

/// The same over points, in words of 32 bits: all that is in them, the times too.
/// The last bits of angles and times depend on the processor: see computed_with().
class point_digest {
 public:
  /// Points, in order.
  constexpr void add(std::span<const point> points) noexcept {
    for (const point& p : points) {
      mix(std::bit_cast<std::uint32_t>(p.angle_deg));
      mix(std::bit_cast<std::uint32_t>(p.range_mm));
      mix(static_cast<std::uint32_t>(static_cast<std::uint64_t>(p.time_ns)));
      mix(static_cast<std::uint32_t>(static_cast<std::uint64_t>(p.time_ns) >> 32U));
      mix(p.revolution);
      mix(static_cast<std::uint32_t>(p.marks));
    }
    count_ += points.size();
  }
  /// The digest of all so far.
  [[nodiscard]] constexpr std::uint64_t value() const noexcept { return hash_; }
  /// How many points.
  [[nodiscard]] constexpr std::uint64_t count() const noexcept { return count_; }

 private:
  // A word at a time: 24 bytes one by one would cost more than to decode them.
  constexpr void mix(std::uint32_t word) noexcept { hash_ = (hash_ ^ word) * 0x100000001B3U; }

  std::uint64_t hash_ = 0xCBF29CE484222325U;
  std::uint64_t count_ = 0;
};

/// The digests of a recording, kept in it when it is closed: of the payload of each file by itself, and
/// of the points where there is one file only.
struct recorded_digest {
  std::uint64_t payload = 0;
  std::uint64_t points = 0;
  std::uint64_t point_count = 0;  ///< 0: no points were shown to the writer.
  bool is_comparable = true;  ///< Whether points that are computed here have the same last bits.
};

/// What points are computed with here, "x86_64 avx2": where that differs, so may the last bits of
/// angles and times, and digests of points cannot be compared. It lives for ever.
[[nodiscard]] G4LIDAR_API std::string_view computed_with() noexcept;

}  // namespace g4lidar
