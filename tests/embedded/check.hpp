// SPDX-License-Identifier: MIT
// The functions that a self-test needs without a test framework: checks, counted and reported.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <source_location>
#include <span>
#include <string_view>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/point.hpp"

namespace self_test {

/// The results of the checks so far.
struct tally {
  std::size_t passed = 0;
  std::size_t failed = 0;
};
inline tally result;

// ---- the functions of the board: host.cpp or cortex_m.cpp --------------------------------------
void put(std::string_view text);
/// Tests that only this board can run.
void test_board();

// ---- the suites --------------------------------------------------------------------------------
void test_worked_examples();
void test_transcripts();
void test_points();
void test_ring();
void test_scans();
void test_session();

// ---- checks ------------------------------------------------------------------------------------
void put_number(std::size_t number);

/// Counts a check and, if it failed, prints its place. Returns `ok`.
bool check(bool ok, std::source_location at = std::source_location::current());

/// Whether `actual` is within `tolerance` of `expected`; false for not-a-number.
template <std::floating_point Real>
[[nodiscard]] constexpr bool near(Real actual, double expected, double tolerance) {
  const double off = static_cast<double>(actual) - expected;
  return off <= tolerance && -off <= tolerance;
}

/// `value`, unknown to the compiler: the following is computed on the board.
template <class T>
[[nodiscard]] T unknown(T value) {
  T volatile hidden = value;
  return hidden;
}
[[nodiscard]] inline g4lidar::bytes unknown(g4lidar::bytes data) {
  return {unknown(data.data()), unknown(data.size())};
}

/// Memory for the points of two packets, shared by all tests: the boards are small.
using packet_room = std::array<g4lidar::point, g4lidar::max_samples>;
inline packet_room room;
inline packet_room other_room;

// ---- packets to test with ----------------------------------------------------------------------
/// A packet made byte by byte, without the library.
class made_packet {
 public:
  struct angles {
    std::uint16_t first_64ths;
    std::uint16_t last_64ths;
  };

  made_packet(std::uint8_t ct, angles at, std::span<const std::uint16_t> samples)
      : size_(10 + 2 * samples.size()) {
    put_word(0, 0x55AA);
    put_word(2, ct + 256U * static_cast<unsigned>(samples.size()));
    put_word(4, at.first_64ths * 2U + 1U);
    put_word(6, at.last_64ths * 2U + 1U);
    for (std::size_t i = 0; i < samples.size(); ++i) put_word(10 + 2 * i, samples[i]);
    unsigned low = 0;
    unsigned high = 0;
    for (std::size_t i = 0; i < size_; i += 2) {
      if (i == 8) continue;
      low ^= data_[i];
      high ^= data_[i + 1];
    }
    put_word(8, low + 256U * high);
  }

  [[nodiscard]] g4lidar::bytes data() const& { return unknown(g4lidar::bytes(data_).first(size_)); }

 private:
  void put_word(std::size_t at, unsigned value) {
    data_[at] = static_cast<std::uint8_t>(value % 256U);
    data_[at + 1] = static_cast<std::uint8_t>(value / 256U % 256U);
  }

  std::array<std::uint8_t, 170> data_{};
  std::size_t size_;
};

}  // namespace self_test
