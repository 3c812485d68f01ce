// SPDX-License-Identifier: MIT
// Digests that show whether two recordings, or the points of two runs, are equal.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string_view>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// The direction of bytes.
enum class direction : std::uint8_t { from_device, to_device };

/// FNV-1a over the bytes of a connection and their directions, in order, however the reads were
/// divided. *Single thread, never allocates, never waits.*
class payload_digest {
 public:
  /// Adds bytes of that direction.
  constexpr void add(direction direction, bytes data) noexcept {
    if (data.empty()) return;
    if (is_first_ || direction != way_) mix(0x100U + static_cast<unsigned>(direction));
    is_first_ = false;
    way_ = direction;
    for (const std::uint8_t byte : data) mix(byte);
  }
  /// The digest of everything so far.
  [[nodiscard]] constexpr std::uint64_t value() const noexcept { return hash_; }

 private:
  constexpr void mix(unsigned symbol) noexcept { hash_ = (hash_ ^ symbol) * 0x100000001B3U; }

  std::uint64_t hash_ = 0xCBF29CE484222325U;
  direction way_ = direction::from_device;
  bool is_first_ = true;
};

/// The same for points, in words of 32 bits: all their members, including the times. The last bits
/// may depend on the architecture: see computed_with().
class point_digest {
 public:
  /// Adds points, in order.
  constexpr void add(std::span<const point> points) noexcept {
    for (const point& p : points) {
      mix(std::bit_cast<std::uint32_t>(p.angle_deg));
      mix(std::bit_cast<std::uint32_t>(p.range_mm));
      mix(static_cast<std::uint32_t>(static_cast<std::uint64_t>(p.time_ns)));
      mix(static_cast<std::uint32_t>(static_cast<std::uint64_t>(p.time_ns) >> 32U));
      mix(p.revolution);
      // A model without sample flags and intensity has 0 there: the digests of a G4's points are those
      // from before points had them, so the version of the computation is the same.
      mix(static_cast<std::uint32_t>(p.flags) | std::uint32_t{p.sample_flags} << 8U |
          std::uint32_t{p.intensity} << 16U);
    }
    count_ += points.size();
  }
  /// The digest of everything so far.
  [[nodiscard]] constexpr std::uint64_t value() const noexcept { return hash_; }
  /// The number of points.
  [[nodiscard]] constexpr std::uint64_t count() const noexcept { return count_; }

 private:
  // One word at a time: 24 single bytes would cost more than decoding the point.
  constexpr void mix(std::uint32_t word) noexcept { hash_ = (hash_ ^ word) * 0x100000001B3U; }

  std::uint64_t hash_ = 0xCBF29CE484222325U;
  std::uint64_t count_ = 0;
};

/// The digests that a closed recording contains: of the payload of each file, and of the points if
/// there is only one file.
struct recorded_digest {
  std::uint64_t payload = 0;
  std::uint64_t points = 0;
  std::uint64_t point_count = 0;  ///< 0: the writer received no points.
  bool is_same_version = true;    ///< Whether this version of the library computes the same points.
  bool is_comparable = true;  ///< Whether points computed on this machine have the same last bits.
};

/// The architecture that points are computed with on this machine, "x86_64". If it differs,
/// the last bits of angles and times may differ, and digests of points cannot be compared. Valid
/// forever.
[[nodiscard]] G4LIDAR_API std::string_view computed_with() noexcept;

}  // namespace g4lidar
