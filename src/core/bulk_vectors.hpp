// SPDX-License-Identifier: MIT
// Vectors of the compiler, for one instruction set: with AVX2 of eight numbers, else of four.
// For the files that compile bulk_kernel.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

// The instruction set is an attribute of each function, so that the inline functions of other headers
// are compiled without it. Each function that holds a vector is inlined: else it would pass the vector
// through memory, and g++ divides vectors where it has no registers for them.
#ifndef G4LIDAR_KERNEL_TARGET
#define G4LIDAR_KERNEL_TARGET
#define G4LIDAR_KERNEL_LANES 4
#endif
#define G4LIDAR_KERNEL G4LIDAR_KERNEL_TARGET __attribute__((always_inline)) inline

namespace g4lidar::bulk {

namespace {

constexpr std::size_t lanes = G4LIDAR_KERNEL_LANES;
constexpr auto every_lane = std::make_index_sequence<lanes>();
constexpr auto every_pair = std::make_index_sequence<lanes / 2>();

using floats [[gnu::vector_size(4 * lanes)]] = float;
using words [[gnu::vector_size(4 * lanes)]] = std::int32_t;
using pairs [[gnu::vector_size(4 * lanes)]] = std::uint64_t;  // of two words

G4LIDAR_KERNEL words bits_of(floats x) { return __builtin_bit_cast(words, x); }
G4LIDAR_KERNEL floats floats_of(words x) { return __builtin_bit_cast(floats, x); }
/// x where all bits of `mask` are set, 0 where none is.
G4LIDAR_KERNEL floats masked(words mask, floats x) { return floats_of(mask & bits_of(x)); }
[[nodiscard]] G4LIDAR_KERNEL bool any(words mask) {
  const auto both = __builtin_bit_cast(pairs, mask);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < lanes / 2; ++i) bits |= both[i];
  return bits != 0;
}

/// Number i of the result is number pick(i) of both together.
template <auto pick, class Vector, std::size_t... i>
G4LIDAR_KERNEL Vector picked(Vector a, Vector b, std::index_sequence<i...> /*numbers*/) {
#ifdef __clang__
  return __builtin_shufflevector(a, b, static_cast<int>(pick(i))...);
#else
  return __builtin_shuffle(a, b, decltype(a < b){static_cast<int>(pick(i))...});
#endif
}
// Registers of AVX2 have two blocks of 16 bytes, and the following instructions stay in a block.

/// The first (half 0) or last two words of each block of a and b in turns.
template <std::size_t half>
G4LIDAR_KERNEL pairs paired(words a, words b) {
  constexpr auto pick = [](std::size_t i) {
    return i / 4 * 4 + 2 * half + i % 4 / 2 + i % 2 * lanes;
  };
  return __builtin_bit_cast(pairs, picked<pick>(a, b, every_lane));
}
template <std::size_t half>
G4LIDAR_KERNEL pairs paired(floats a, floats b) {
  return paired<half>(bits_of(a), bits_of(b));
}
/// Of each block, pair `of_a` of a and pair `of_b` of b.
template <std::size_t of_a, std::size_t of_b>
G4LIDAR_KERNEL pairs joined(pairs a, pairs b) {
  constexpr auto pick = [](std::size_t i) {
    return i % 2 == 0 ? i + of_a : i - 1 + of_b + lanes / 2;
  };
  return picked<pick>(a, b, every_pair);
}
/// Writes the first blocks of all vectors, then the second ones.
template <std::size_t count>
G4LIDAR_KERNEL void store_blocks(const pairs (&from)[count], void* out) {
  auto* const to = static_cast<std::uint8_t*>(out);
  if constexpr (lanes == 4) {
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + 16 * i, &from[i], 16);
  } else {
    constexpr auto first = [](std::size_t i) { return i + i / 2 * 2; };
    constexpr auto second = [](std::size_t i) { return i + i / 2 * 2 + 2; };
    for (std::size_t i = 0; i < count; i += 2) {
      const pairs firsts = picked<first>(from[i], from[i + 1], every_pair);
      const pairs seconds = picked<second>(from[i], from[i + 1], every_pair);
      std::memcpy(to + 16 * i, &firsts, sizeof firsts);
      std::memcpy(to + 16 * (i + count), &seconds, sizeof seconds);
    }
  }
}

}  // namespace

}  // namespace g4lidar::bulk
