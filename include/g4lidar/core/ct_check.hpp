// SPDX-License-Identifier: MIT
// The CRC-8 that some devices send before each zero packet: over the CT bytes of the revolution.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/skipped.hpp"

namespace g4lidar {

namespace detail {

/// The CRC of each single byte.
inline constexpr auto crc_steps = [] {
  std::array<std::uint8_t, 256> made{};
  for (unsigned i = 0; i < made.size(); ++i) {
    unsigned value = i;
    for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ ((value & 1U) != 0 ? 0x8CU : 0U);
    made[i] = static_cast<std::uint8_t>(value);
  }
  return made;
}();

}  // namespace detail

/// `crc` continued over `byte`: CRC-8/MAXIM, polynomial 31h reflected, start 0. *Pure.*
/// (protocol: The stream, CRC byte)
[[nodiscard]] constexpr std::uint8_t next_crc(std::uint8_t crc, std::uint8_t byte) noexcept {
  return detail::crc_steps[crc ^ unsigned{byte}];
}

/// The CT bytes of the revolution that is being received: whether all of them were, and their CRC.
/// *Single thread, never allocates.*
class ct_revolution {
 public:
  /// Passes a packet, suspect or not. If a revolution ends with it that was received from zero packet
  /// to zero packet, with exactly one byte of noise before the last one and no other skipped byte:
  /// whether this byte is its CRC. What is known to be damaged proves nothing.
  constexpr std::optional<bool> add(packet_view packet) noexcept {
    std::optional<bool> fits;
    if (packet.is_zero()) {
      if (is_open_ && noise_ == 1) fits = byte_ == crc_;
      is_open_ = true;
      crc_ = 0;
    } else if (noise_ != 0) {
      is_open_ = false;
    }
    crc_ = next_crc(crc_, packet.ct());
    noise_ = 0;
    return fits;
  }
  /// Passes skipped bytes.
  constexpr void add(skipped gone) noexcept {
    if (gone.reason != skip_reason::noise) is_open_ = false;
    noise_ = std::min<std::size_t>(noise_ + gone.count, 2);
    byte_ = gone.last;
  }

 private:
  std::uint8_t crc_ = 0;
  std::uint8_t byte_ = 0;  // the last skipped one
  std::size_t noise_ = 0;  // bytes since the last packet, at most 2
  bool is_open_ = false;   // received from its zero packet on, without a skipped byte
};

/// Compares the byte before each zero packet with the CRC of the CT bytes of the revolution that
/// ends there. *Single thread, never allocates.*
///
/// What the byte means is not known at first: most devices send any byte there. When it has fitted
/// in three revolutions in a row, it is a check: from then on a byte that does not fit means that a
/// packet of its revolution was lost. A random byte fits in one of 256 revolutions, so a byte that
/// did not fit before has to fit as often in a row as it did not fit, up to 16 times. After three
/// revolutions in a row that do not fit it is unknown again.
///
/// (protocol: The stream, CRC byte)
class ct_check {
 public:
  /// The result for one packet.
  enum class result : std::uint8_t {
    none,      ///< No revolution ends with it, or there is nothing to compare.
    match,     ///< The byte is a check, and fits: no packet of the revolution was lost.
    mismatch,  ///< The byte is a check, and does not fit.
  };

  /// Passes a packet, suspect or not.
  constexpr void add(packet_view packet) noexcept {
    const std::optional<bool> fits = received_.add(packet);
    last_ = fits ? judge(*fits) : result::none;
  }
  /// Passes skipped bytes.
  constexpr void add(skipped gone) noexcept { received_.add(gone); }
  /// The result for the last packet.
  [[nodiscard]] constexpr result last() const noexcept { return last_; }
  /// Whether the byte is a check now.
  [[nodiscard]] constexpr bool is_trusted() const noexcept { return is_trusted_; }

 private:
  static constexpr std::uint8_t in_a_row = 3;
  static constexpr std::uint8_t most = 16;

  [[nodiscard]] constexpr result judge(bool fits) noexcept {
    const bool was_trusted = is_trusted_;
    if (is_trusted_) {
      misfits_ = fits ? std::uint8_t{0} : static_cast<std::uint8_t>(misfits_ + 1);
      fits_ = 0;
      is_trusted_ = misfits_ < in_a_row;
    } else if (fits) {
      fits_ = static_cast<std::uint8_t>(fits_ + 1);
      is_trusted_ = fits_ >= std::max(in_a_row, misfits_);
      if (is_trusted_) misfits_ = 0;
    } else {
      fits_ = 0;
      misfits_ = std::min(static_cast<std::uint8_t>(misfits_ + 1), most);
    }
    if (fits) return is_trusted_ ? result::match : result::none;
    return was_trusted ? result::mismatch : result::none;
  }

  ct_revolution received_;
  std::uint8_t fits_ = 0;     // in a row, before it is trusted
  std::uint8_t misfits_ = 0;  // in a row while it is trusted; before, all
  bool is_trusted_ = false;
  result last_ = result::none;
};

}  // namespace g4lidar
