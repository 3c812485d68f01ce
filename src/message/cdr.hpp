// SPDX-License-Identifier: MIT
// Messages in CDR, little-endian: the encoding of ROS 2 messages. (OMG DDSI-RTPS, section 10)
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <type_traits>
#include <vector>

#include "g4lidar/core/bytes.hpp"

namespace g4lidar {

/// Writes one field after the other; each number is at a multiple of its size.
class cdr_writer {
 public:
  /// Appends to `out`, beginning with the encoding's header of four bytes.
  explicit cdr_writer(std::vector<std::uint8_t>& out) : out_(out) {
    out_.insert(out_.end(), {0, 1, 0, 0});
    origin_ = out_.size();
  }
  template <class Number>
  void put(Number value) {
    if constexpr (std::is_same_v<Number, float>) {
      put(std::bit_cast<std::uint32_t>(value));
    } else if constexpr (std::is_same_v<Number, double>) {
      put(std::bit_cast<std::uint64_t>(value));
    } else {
      static_assert(std::is_integral_v<Number>);
      while ((out_.size() - origin_) % sizeof(Number) != 0) out_.push_back(0);
      const auto bits = static_cast<std::uint64_t>(value);
      for (std::size_t i = 0; i < sizeof(Number); ++i) {
        out_.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
      }
    }
  }
  /// A sequence of bytes.
  void put(bytes data) {
    put(static_cast<std::uint32_t>(data.size()));
    out_.insert(out_.end(), data.begin(), data.end());
  }
  /// A string, terminated by a zero.
  void put(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    out_.insert(out_.end(), text.begin(), text.end());
    out_.push_back(0);
  }

 private:
  std::vector<std::uint8_t>& out_;
  std::size_t origin_ = 0;
};

/// A builtin_interfaces/Time, since 1970.
inline void put_time(cdr_writer& message, std::int64_t time_ns) {
  constexpr std::int64_t second_ns = 1'000'000'000;
  // The nanoseconds count from the previous second, also before 1970.
  const std::int64_t left_ns = time_ns % second_ns;
  const std::int64_t rest_ns = left_ns < 0 ? left_ns + second_ns : left_ns;
  const std::int64_t seconds = time_ns / second_ns - (left_ns < 0 ? 1 : 0);
  using limits = std::numeric_limits<std::int32_t>;
  message.put(
      static_cast<std::int32_t>(std::clamp<std::int64_t>(seconds, limits::min(), limits::max())));
  message.put(static_cast<std::uint32_t>(rest_ns));
}

/// A std_msgs/Header.
inline void put_header(cdr_writer& message, std::int64_t stamp_ns, std::string_view frame_id) {
  put_time(message, stamp_ns);
  message.put(frame_id);
}

}  // namespace g4lidar
