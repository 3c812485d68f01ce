// SPDX-License-Identifier: MIT
// A small seeded random number generator that gives the same numbers on every processor.
#pragma once

#include <array>
#include <cstdint>

#include "g4lidar/detail/api.hpp"

namespace g4lidar::sim {

/// xoshiro256** of Blackman and Vigna, its state initialised by their splitmix64. *Single thread.*
/// A copy continues with the same numbers. Integers only, except for exact scalings by powers of
/// two.
class random_stream {
 public:
  /// Streams with different `seed` or `purpose` are independent: additional numbers of one do not
  /// change the numbers of the other.
  constexpr explicit random_stream(std::uint64_t seed, std::uint64_t purpose = 0) noexcept {
    std::uint64_t filler = seed;
    filler = splitmix64(filler) ^ purpose;
    for (std::uint64_t& word : state_) word = splitmix64(filler);
  }

  /// 64 random bits.
  constexpr std::uint64_t next() noexcept {
    const std::uint64_t result = rotated(state_[1] * 5, 7) * 9;
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = rotated(state_[3], 45);
    return result;
  }

  /// A number in [0, 1), a multiple of 2^-53.
  constexpr double uniform() noexcept { return static_cast<double>(next() >> 11) * 0x1p-53; }

  /// A number with mean 0 and standard deviation 1, nearly Gaussian: a sum of twelve uniform ones.
  /// Never beyond 6 in magnitude; a multiple of 2^-16, thus exact.
  constexpr double gaussian() noexcept {
    std::int32_t sum = -6 * 65535;  // twelve times the mean of 16 bits
    for (int word = 0; word < 3; ++word) {
      const std::uint64_t bits = next();
      for (int part = 0; part < 64; part += 16) {
        sum += static_cast<std::int32_t>((bits >> part) & 0xFFFFU);
      }
    }
    return static_cast<double>(sum) * 0x1p-16;
  }

 private:
  static constexpr std::uint64_t splitmix64(std::uint64_t& state) noexcept {
    state += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
  }
  static constexpr std::uint64_t rotated(std::uint64_t word, int left) noexcept {
    return (word << left) | (word >> (64 - left));
  }

  std::array<std::uint64_t, 4> state_{};
};

}  // namespace g4lidar::sim
