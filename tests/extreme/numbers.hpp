// SPDX-License-Identifier: MIT
// Extreme values of every type of number, and calls with all of them. A call must end, and the sanitizers of the preset
// `debug` must find nothing in it: what a function makes of such values is tested elsewhere.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <type_traits>
#include <vector>

#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "support/random_stream.hpp"

namespace g4lidar::extreme {

/// The extreme values of a type.
template <class T>
std::vector<T> values() {
  using limits = std::numeric_limits<T>;
  if constexpr (std::is_same_v<T, bool>) {
    return {false, true};
  } else if constexpr (std::is_enum_v<T>) {
    std::vector<T> all;
    for (const unsigned number : {0U, 1U, 2U, 3U, 7U, 17U, 18U, 127U, 128U, 255U})
      all.push_back(static_cast<T>(number));
    return all;
  } else if constexpr (std::is_floating_point_v<T>) {
    std::vector<T> all{T(0),
                       limits::denorm_min(),
                       limits::min(),
                       T(0.5),
                       T(1),
                       T(45),
                       T(90),
                       T(359.99997),
                       T(360),
                       T(720),
                       T(1e6),
                       T(1e15),
                       T(65535.75),
                       limits::max(),
                       limits::infinity(),
                       limits::quiet_NaN()};
    // Around the ends of the types of integers.
    for (const int bits : {8, 15, 16, 23, 24, 31, 32, 53, 62, 63, 64, 100}) {
      T power = 1;
      for (int i = 0; i < bits; ++i) power *= 2;
      all.push_back(power);
    }
    for (std::size_t i = all.size(); i-- > 0;) all.push_back(-all[i]);
    return all;
  } else if constexpr (requires {
                         typename T::rep;
                         typename T::period;
                       }) {  // of std::chrono
    std::vector<T> all;
    for (const auto count : values<typename T::rep>()) all.push_back(T(count));
    return all;
  } else {
    std::vector<T> all{T(0),
                       T(1),
                       T(2),
                       T(3),
                       T(7),
                       T(64),
                       T(100),
                       limits::max(),
                       limits::max() - 1,
                       limits::max() / 2,
                       limits::max() / 2 + 1};
    for (const auto number : {180LL, 255LL, 360LL, 65'535LL, 65'536LL, 1'000'000'000LL, 1LL << 32U,
                              1LL << 61U, 1LL << 62U}) {
      if (static_cast<unsigned long long>(number) < static_cast<unsigned long long>(limits::max()))
        all.push_back(static_cast<T>(number));
    }
    if constexpr (std::is_signed_v<T>) {
      for (std::size_t i = all.size(); i-- > 1;) all.push_back(static_cast<T>(-all[i]));
      all.push_back(limits::min());
    }
    return all;
  }
}

/// One of them at random.
template <class T>
T any(test::dice& random) {
  static const std::vector<T> all = values<T>();
  return all[random.next() % all.size()];
}

/// The same for structures of numbers.
template <>
inline point any<point>(test::dice& random) {
  return {any<float>(random),         any<float>(random),       any<std::int64_t>(random),
          any<std::uint32_t>(random), any<point_flags>(random), any<std::uint8_t>(random),
          any<std::uint16_t>(random)};
}
template <>
inline pose_2d any<pose_2d>(test::dice& random) {
  return {any<double>(random), any<double>(random), any<double>(random)};
}
template <>
inline twist_2d any<twist_2d>(test::dice& random) {
  return {any<double>(random), any<double>(random), any<double>(random)};
}
template <>
inline mounting any<mounting>(test::dice& random) {
  return {any<pose_2d>(random), any<bool>(random)};
}
template <>
inline stamped_pose any<stamped_pose>(test::dice& random) {
  return {any<std::int64_t>(random), any<pose_2d>(random)};
}
template <>
inline stamped_odometry any<stamped_odometry>(test::dice& random) {
  return {any<std::int64_t>(random), any<pose_2d>(random), any<twist_2d>(random)};
}

/// Up to `most` of them.
template <class T>
std::vector<T> several(test::dice& random, std::size_t most) {
  std::vector<T> made(random.next() % (most + 1));
  for (T& each : made) each = any<T>(random);
  return made;
}

/// How often calls with several arguments at random are made.
inline constexpr int calls = 3000;

/// Calls `call` with all extreme values of one argument, or of several: all combinations of up to two, and many of more.
template <class First, class... More, class Call>
void with_extremes(Call call) {
  if constexpr (sizeof...(More) == 0) {
    for (const First first : values<First>()) call(first);
  } else if constexpr (sizeof...(More) == 1) {
    for (const First first : values<First>()) {
      with_extremes<More...>([&](const auto& second) { call(first, second); });
    }
  } else {
    test::dice random(1);
    for (int i = 0; i < calls; ++i) {
      std::tuple<First, More...> arguments{any<First>(random), any<More>(random)...};
      std::apply(call, arguments);
    }
  }
}

/// Calls `call` many times with a source of random numbers, for any() and several().
template <class Call>
void many_times(Call call, int times = calls) {
  test::dice random(2);
  for (int i = 0; i < times; ++i) call(random);
}

/// Uses a result, so that it is computed.
template <class T>
void use(const T& result) {
  const volatile auto* const at = reinterpret_cast<const volatile unsigned char*>(&result);
  static_cast<void>(*at);
}

}  // namespace g4lidar::extreme
