// SPDX-License-Identifier: MIT
// Bytes on the wire: little-endian loads from them, the same on every processor, and the result of checking them.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <span>
#include <type_traits>

#include "g4lidar/detail/api.hpp"

namespace g4lidar {

/// A view of bytes on the wire. The caller owns them.
using bytes = std::span<const std::uint8_t>;

/// The 16 bits at `data[at]` and `data[at + 1]`, least significant byte first. *Pure.*
/// Reading past the end is a mistake of the caller.
[[nodiscard]] constexpr std::uint16_t load_u16(bytes data, std::size_t offset) noexcept {
  return static_cast<std::uint16_t>(data[offset] | (data[offset + 1] << 8));
}

/// The 32 bits that start at `data[at]`, least significant byte first. *Pure.*
[[nodiscard]] constexpr std::uint32_t load_u32(bytes data, std::size_t offset) noexcept {
  return static_cast<std::uint32_t>(load_u16(data, offset)) |
         (static_cast<std::uint32_t>(load_u16(data, offset + 2)) << 16);
}

/// The 64 bits that start at `data[at]`, least significant byte first. *Pure.*
[[nodiscard]] constexpr std::uint64_t load_u64(bytes data, std::size_t offset) noexcept {
  const std::uint8_t* const p = data.data() + offset;
  // One expression over single bytes: compilers translate it to a plain 8-byte load.
  return static_cast<std::uint64_t>(p[0]) | static_cast<std::uint64_t>(p[1]) << 8 |
         static_cast<std::uint64_t>(p[2]) << 16 | static_cast<std::uint64_t>(p[3]) << 24 |
         static_cast<std::uint64_t>(p[4]) << 32 | static_cast<std::uint64_t>(p[5]) << 40 |
         static_cast<std::uint64_t>(p[6]) << 48 | static_cast<std::uint64_t>(p[7]) << 56;
}

/// Writes `value` to `out[at]` and `out[at + 1]`, least significant byte first.
constexpr void store_u16(std::span<std::uint8_t> out, std::size_t offset,
                         std::uint16_t value) noexcept {
  out[offset] = static_cast<std::uint8_t>(value & 0xFFU);
  out[offset + 1] = static_cast<std::uint8_t>(value >> 8);
}

/// An argument that owns its bytes and is destroyed at the end of the call: a view of it would
/// dangle, so the functions that return views refuse it at compile time.
template <class T>
concept dying_owner =
    !std::is_lvalue_reference_v<T> && !std::ranges::borrowed_range<std::remove_cvref_t<T>> &&
    std::convertible_to<const std::remove_cvref_t<T>&, bytes>;

/// How far the available bytes decide whether they begin with a packet or response.
enum class wire_state : std::uint8_t {
  valid,         ///< A complete packet or response that passes all checks.
  incomplete,    ///< No contradiction yet; more bytes are needed to decide.
  bad_header,    ///< The header or an impossible content excludes both.
  bad_checksum,  ///< A complete packet by its header, but its checksum does not match.
};

/// The result for one front. More bytes behind it change only the result `incomplete`.
struct wire_check {
  wire_state state;
  /// valid: the size of the packet or response. incomplete: with fewer bytes than this the result
  /// stays `incomplete` (always more than are available). bad_header, bad_checksum: the number of
  /// bytes that the refused header claimed.
  std::size_t size;

  friend constexpr bool operator==(const wire_check&, const wire_check&) = default;
};

}  // namespace g4lidar
