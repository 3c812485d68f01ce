// SPDX-License-Identifier: MIT
// Numbers as text and sample times: compared with printf and 128-bit arithmetic.
#include "export/digits.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>
#include <string>

#include "core/sample_clock.hpp"
#include "support/test_scale.hpp"

namespace g4lidar::test {
namespace {

using namespace g4_tool;
using namespace digits;

template <class Put>
std::string text_by(const Put& put) {
  std::array<char, 64> room{};
  return {room.data(), static_cast<std::size_t>(put(room.data()) - room.data())};
}

std::string by_printf(int decimals, double x) {
  std::array<char, 64> room{};
  std::snprintf(room.data(), room.size(), "%.*f", decimals, x);
  return room.data();
}

template <unsigned Decimals>
std::string angle(double degrees) {
  return text_by([&](char* at) { return put_angle<Decimals>(at, degrees); });
}

template <unsigned Decimals>
std::string fixed(double x) {
  return text_by([&](char* at) { return put_fixed<Decimals>(at, x); });
}

TEST(Digits, Integers_AgreeWithPrintf) {
  const auto check = [](std::uint64_t number) {
    const std::string text = text_by([&](char* at) { return put_number(at, number); });
    ASSERT_EQ(text, std::to_string(number));
  };
  for (std::uint64_t number = 0; number < 20'000; ++number) check(number);
  for (std::uint64_t power = 1; power < 10'000'000'000'000'000'000U / 10; power *= 10) {
    for (const std::uint64_t near : {power - 1, power, power + 1, 9 * power}) check(near);
  }
  check(std::numeric_limits<std::uint64_t>::max());
  for (const int seed : seeds(1)) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    for (int i = 0; i < 200'000; ++i) check(random() >> (random() % 64));
  }
}

TEST(Digits, NegativeIntegers_AgreeWithPrintf) {
  for (const std::int64_t number :
       {std::int64_t{-1}, std::int64_t{-99'999'999}, std::numeric_limits<std::int64_t>::min()}) {
    EXPECT_EQ(text_by([&](char* at) { return put_number(at, number); }), std::to_string(number));
  }
}

TEST(Digits, Angles_AgreeWithPrintf) {
  std::uniform_real_distribution<float> any(0.0F, 360.0F);
  for (const int seed : seeds(1)) {
    std::mt19937 random(static_cast<std::uint32_t>(seed));
    for (int i = 0; i < 500'000; ++i) {
      const float degrees = any(random);
      if (degrees >= 360.0F) continue;
      const auto exact = static_cast<double>(degrees);
      ASSERT_EQ(angle<6>(exact), by_printf(6, exact));
    }
  }
  // Multiples of 1/128 have seven decimals and are exactly between two texts: printf rounds them to
  // even.
  for (int i = 0; i < 360 * 128; ++i) ASSERT_EQ(angle<6>(i / 128.0), by_printf(6, i / 128.0));
}

TEST(Digits, Angle_IsNever360) {
  for (const double degrees :
       {359.9999995, 359.9999997, 359.99999999, std::nextafter(360.0, 0.0)}) {
    ASSERT_EQ(by_printf(6, degrees), "360.000000") << "no case for the guard";
    EXPECT_EQ(angle<6>(degrees), "0.000000");
  }
  EXPECT_EQ(angle<6>(359.9999994), "359.999999");
  EXPECT_EQ(angle<6>(static_cast<double>(std::nextafterf(360.0F, 0.0F))), "359.999969");
  EXPECT_EQ(angle<2>(359.9949), "359.99");
  EXPECT_EQ(angle<2>(359.9951), "0.00");
  EXPECT_EQ(angle<2>(0.0), "0.00");
  EXPECT_EQ(angle<2>(9.996), "10.00");
  EXPECT_EQ(angle<2>(99.996), "100.00");
  // Every float in the last hundredth of a degree.
  for (float degrees = 359.9901F; degrees < 360.0F; degrees = std::nextafterf(degrees, 400.0F)) {
    const std::string two = angle<2>(static_cast<double>(degrees));
    ASSERT_TRUE(two == "359.99" || two == "0.00") << two;
    ASSERT_EQ(angle<6>(static_cast<double>(degrees)).substr(0, 6), "359.99");
  }
}

TEST(Digits, EveryRange_AgreesWithPrintf) {
  for (int raw = 0; raw < 65'536; ++raw) {
    ASSERT_EQ(fixed<2>(raw / 4.0), by_printf(2, raw / 4.0));
  }
}

TEST(Digits, LargeFixedNumbers_AgreeWithPrintf) {
  for (const double x :
       {0.0, 0.0004, 0.9996, 99'999.999, 100'000.0, 2'828'427.125, 99'999'999.0, 12'345'678.875}) {
    EXPECT_EQ(fixed<3>(x), by_printf(3, x));
  }
}

TEST(SampleClock, IsExactAtEverySample) {
  for (const std::uint32_t rate : {1U, 7U, 4000U, 8000U, 9000U, 999'983U, 1'000'000U}) {
    sample_clock clock(rate);
    for (std::uint64_t index = 0; index < 200'000; ++index) {
      const auto expected = static_cast<std::int64_t>(index * 1'000'000'000U / rate);
      ASSERT_EQ(clock.now_ns(), expected) << index << " at " << rate;
      clock.tick();
    }
  }
}

TEST(SampleClock, DoesNotDriftInADay) {
  sample_clock clock(9000);
  for (int second = 0; second < 86'400; ++second) clock.tick(9000);
  EXPECT_EQ(clock.now_ns(), std::int64_t{86'400} * 1'000'000'000);
}

}  // namespace
}  // namespace g4lidar::test
