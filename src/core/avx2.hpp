// SPDX-License-Identifier: MIT
// Arithmetic on eight samples at a time with AVX2 and FMA, and the division of a packet into groups
// of eight.
#pragma once

#include <immintrin.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "g4lidar/core/packet.hpp"

// For every function that holds such a register: compiled without special flags, the function would
// not have these registers; not inlined, it would pass them through memory.
#define G4LIDAR_AVX2 __attribute__((target("avx2,fma"), always_inline)) inline

namespace g4lidar::avx2 {

struct floats {
  __m256 v;
};
struct words {
  __m256i v;
};

G4LIDAR_AVX2 floats every(float x) { return {_mm256_set1_ps(x)}; }
G4LIDAR_AVX2 words every(int x) { return {_mm256_set1_epi32(x)}; }
G4LIDAR_AVX2 words bits_of(floats x) { return {_mm256_castps_si256(x.v)}; }
G4LIDAR_AVX2 floats floats_of(words x) { return {_mm256_castsi256_ps(x.v)}; }
G4LIDAR_AVX2 floats to_floats(words x) { return {_mm256_cvtepi32_ps(x.v)}; }
G4LIDAR_AVX2 words to_nearest(floats x) { return {_mm256_cvtps_epi32(x.v)}; }

G4LIDAR_AVX2 floats operator+(floats x, floats y) { return {_mm256_add_ps(x.v, y.v)}; }
G4LIDAR_AVX2 floats operator-(floats x, floats y) { return {_mm256_sub_ps(x.v, y.v)}; }
G4LIDAR_AVX2 floats operator*(floats x, floats y) { return {_mm256_mul_ps(x.v, y.v)}; }
G4LIDAR_AVX2 floats operator/(floats x, floats y) { return {_mm256_div_ps(x.v, y.v)}; }
G4LIDAR_AVX2 floats square_root(floats x) { return {_mm256_sqrt_ps(x.v)}; }
/// x * y + z, x * y - z, and z - x * y, rounded once.
G4LIDAR_AVX2 floats times_plus(floats x, floats y, floats z) {
  return {_mm256_fmadd_ps(x.v, y.v, z.v)};
}
G4LIDAR_AVX2 floats times_minus(floats x, floats y, floats z) {
  return {_mm256_fmsub_ps(x.v, y.v, z.v)};
}
G4LIDAR_AVX2 floats minus_times(floats x, floats y, floats z) {
  return {_mm256_fnmadd_ps(x.v, y.v, z.v)};
}

G4LIDAR_AVX2 words operator+(words x, words y) { return {_mm256_add_epi32(x.v, y.v)}; }
G4LIDAR_AVX2 words operator-(words x, words y) { return {_mm256_sub_epi32(x.v, y.v)}; }
G4LIDAR_AVX2 words operator&(words x, words y) { return {_mm256_and_si256(x.v, y.v)}; }
G4LIDAR_AVX2 words operator|(words x, words y) { return {_mm256_or_si256(x.v, y.v)}; }
G4LIDAR_AVX2 words operator^(words x, words y) { return {_mm256_xor_si256(x.v, y.v)}; }
template <int bits>
G4LIDAR_AVX2 words shifted_left(words x) {
  return {_mm256_slli_epi32(x.v, bits)};
}
template <int bits>
G4LIDAR_AVX2 words shifted_right(words x) {
  return {_mm256_srli_epi32(x.v, bits)};
}
/// y without the bits of x.
G4LIDAR_AVX2 words without(words x, words y) { return {_mm256_andnot_si256(x.v, y.v)}; }
/// The smaller one, as unsigned.
G4LIDAR_AVX2 words unsigned_min(words x, words y) { return {_mm256_min_epu32(x.v, y.v)}; }
/// All bits where the comparison is true, else none.
G4LIDAR_AVX2 words equal(words x, words y) { return {_mm256_cmpeq_epi32(x.v, y.v)}; }
/// As signed.
G4LIDAR_AVX2 words less(words x, words y) { return {_mm256_cmpgt_epi32(y.v, x.v)}; }
[[nodiscard]] G4LIDAR_AVX2 bool any(words x) { return _mm256_testz_si256(x.v, x.v) == 0; }
/// y where the top bit of `second` is set, else x.
G4LIDAR_AVX2 floats choose(words second, floats x, floats y) {
  return {_mm256_blendv_ps(x.v, y.v, _mm256_castsi256_ps(second.v))};
}

inline constexpr std::size_t lanes = 8;
/// The number of registers that the longest packet fills.
template <class Register>
using per_packet = std::array<Register, (max_samples + lanes - 1) / lanes>;

/// Which of eight samples is in which lane of a register: an order in which the output can be
/// assembled without instructions that cross the middle of the register.
using lane_order = std::array<int, lanes>;

/// The samples of a packet in groups of eight, in the lanes according to `order`; zeros behind the
/// last one.
template <lane_order order, sample_layout Layout>
class eights {
 public:
  G4LIDAR_AVX2 explicit eights(packet_view packet) : count_((packet.sample_count() + 7) / lanes) {
    const std::uint8_t* const data = packet.data().data() + packet_header_size;
    const std::size_t whole = packet.sample_count() / lanes;
    for (std::size_t i = 0; i < whole; ++i) raw_[i] = in_order(data + size * lanes * i);
    if (whole == count_) return;
    if constexpr (size == 2) {
      raw_[whole] = in_order(last_of(packet));
    } else {
      std::array<std::uint8_t, size * lanes> last{};
      const bytes rest = packet.data().subspan(packet_header_size + size * lanes * whole);
      std::memcpy(last.data(), rest.data(), rest.size());
      raw_[whole] = in_order(last.data());
    }
  }

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// The ranges of group `i`, in quarters of a millimetre.
  [[nodiscard]] G4LIDAR_AVX2 words quarters(std::size_t i) const {
    using enum sample_layout;
    if constexpr (Layout == flagged_mm) return raw_[i] & every(0xFFFC);
    if constexpr (Layout == half_mm) return shifted_left<1>(raw_[i]);
    if constexpr (Layout == whole_mm) return shifted_left<2>(raw_[i]);
    if constexpr (size == 3) return shifted_right<8>(raw_[i]) & every(0xFFFC);
    if constexpr (Layout == intensity_16) return shifted_left<2>(shifted_right<16>(raw_[i]));
    return raw_[i];
  }
  /// What the samples have beside the range, as in a point: their flags in bits 8 to 15, and the
  /// intensity in bits 16 to 31.
  [[nodiscard]] G4LIDAR_AVX2 words others(std::size_t i) const {
    using enum sample_layout;
    if constexpr (Layout == flagged_mm) return shifted_left<8>(raw_[i] & every(3));
    if constexpr (Layout == intensity_8) {
      return (raw_[i] & every(0x300)) | shifted_left<16>(raw_[i] & every(0xFF));
    }
    if constexpr (Layout == intensity_10) return shifted_left<16>(raw_[i] & every(0x3FF));
    if constexpr (Layout == intensity_16) return shifted_left<16>(raw_[i]);
    return every(0);
  }

  /// The indices of the eight samples of group `i` in the packet, as numbers.
  [[nodiscard]] static G4LIDAR_AVX2 floats places(std::size_t i) {
    static constexpr auto numbers = [] {
      std::array<float, max_samples> places_of_lanes{};
      for (std::size_t lane = 0; lane < max_samples; ++lane) {
        const int place = static_cast<int>(lane / lanes * lanes) + order[lane % lanes];
        places_of_lanes[lane] = static_cast<float>(place);
      }
      return places_of_lanes;
    }();
    return {_mm256_loadu_ps(numbers.data() + lanes * i)};
  }

 private:
  static constexpr std::size_t size = sample_size(Layout);

  /// Eight samples in lanes of 32 bits, the first byte at the bottom.
  [[nodiscard]] static G4LIDAR_AVX2 words in_order(const std::uint8_t* from) {
    if constexpr (size == 2) return in_order(load(from));
    if constexpr (size == 4) {
      __m256i samples;
      std::memcpy(&samples, from, sizeof samples);
      const __m256i places = _mm256_setr_epi32(order[0], order[1], order[2], order[3], order[4],
                                               order[5], order[6], order[7]);
      return {_mm256_permutevar8x32_epi32(samples, places)};
    }
    // 24 bytes: the first 16 and the last 16 of them.
    const __m256i first = _mm256_broadcastsi128_si256(load(from));
    const __m256i last = _mm256_broadcastsi128_si256(load(from + lanes));
    static constexpr auto of_first = picks_of_triples(0, 0, 2 * lanes);
    static constexpr auto of_last = picks_of_triples(lanes, 2 * lanes, 3 * lanes);
    return words{_mm256_shuffle_epi8(first, load_all(of_first))} |
           words{_mm256_shuffle_epi8(last, load_all(of_last))};
  }
  using byte_picks = std::array<char, 4 * lanes>;
  [[nodiscard]] static G4LIDAR_AVX2 __m256i load_all(const byte_picks& picks) {
    __m256i all;
    std::memcpy(&all, picks.data(), sizeof all);
    return all;
  }
  /// Which bytes of 16, which begin at byte `begin` of eight samples of 3 bytes, get into each lane:
  /// those of `from` to `end`.
  [[nodiscard]] static constexpr byte_picks picks_of_triples(std::size_t begin, std::size_t from,
                                                             std::size_t end) {
    byte_picks picks{};
    for (std::size_t byte = 0; byte < picks.size(); ++byte) {
      const std::size_t wanted = 3 * static_cast<std::size_t>(order[byte / 4]) + byte % 4;
      const bool is_there = byte % 4 < 3 && from <= wanted && wanted < end;
      picks[byte] = static_cast<char>(is_there ? wanted - begin : 0x80);  // 0x80 gives zero
    }
    return picks;
  }
  [[nodiscard]] static G4LIDAR_AVX2 __m128i load(const void* from) {
    __m128i samples;
    std::memcpy(&samples, from, sizeof samples);
    return samples;
  }
  [[nodiscard]] static G4LIDAR_AVX2 words in_order(__m128i samples) {
    constexpr auto picks = [] {
      std::array<char, 2 * lanes> of_bytes{};
      for (std::size_t byte = 0; byte < of_bytes.size(); ++byte) {
        of_bytes[byte] = static_cast<char>(2 * order[byte / 2] + static_cast<int>(byte % 2));
      }
      return of_bytes;
    }();
    return {_mm256_cvtepu16_epi32(_mm_shuffle_epi8(samples, load(picks.data())))};
  }
  /// The samples behind the last complete group, without reading behind the packet: its last 16
  /// bytes, shifted. A packet shorter than that is usually a zero packet of one sample.
  [[nodiscard]] static G4LIDAR_AVX2 __m128i last_of(packet_view packet) {
    const std::size_t count = packet.sample_count() % lanes;
    if (packet.sample_count() == 1)
      return _mm_cvtsi32_si128(load_u16(packet.data(), packet_header_size));
    if (packet.data().size() < 2 * lanes) {
      return _mm_cvtsi32_si128(static_cast<int>(load_u32(packet.data(), packet_header_size)));
    }
    static constexpr auto moves = [] {
      std::array<char, 4 * lanes> of_bytes{};
      for (std::size_t byte = 0; byte < of_bytes.size(); ++byte) {
        of_bytes[byte] = static_cast<char>(byte < 2 * lanes ? byte : 0x80);  // 0x80 gives zero
      }
      return of_bytes;
    }();
    return _mm_shuffle_epi8(load(packet.data().last(2 * lanes).data()),
                            load(moves.data() + 2 * (lanes - count)));
  }

  std::size_t count_;
  per_packet<words> raw_;
};

}  // namespace g4lidar::avx2
