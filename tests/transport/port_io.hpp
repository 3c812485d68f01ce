// SPDX-License-Identifier: MIT
// Reads and writes text on a transport, for the tests of ports.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "g4lidar/transport/transport.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {

/// `time` from now on, by the transport's clock.
inline std::int64_t in(const transport& port, std::chrono::nanoseconds time) {
  return port.now_ns() + time.count();
}

/// Reads until `size` bytes have arrived or nothing arrives for ten seconds; returns the error, if
/// any.
inline result<std::string> read_text(transport& port, std::size_t size) {
  std::string all;
  std::array<std::uint8_t, 64> buffer{};
  while (all.size() < size) {
    const auto got = port.read(buffer, in(port, patience));
    if (!got) return tl::unexpected(got.error());
    if (got->count == 0) return failure(task::reading, problem::timeout);
    EXPECT_LE(got->arrival_ns, port.now_ns());
    for (const std::uint8_t byte : bytes(buffer).first(got->count)) {
      all.push_back(static_cast<char>(byte));
    }
  }
  return all;
}

inline result<void> write_text(transport& port, std::string_view text) {
  const std::string copy(text);
  const bytes data(reinterpret_cast<const std::uint8_t*>(copy.data()), copy.size());
  return port.write(data, in(port, patience));
}

}  // namespace g4lidar::test
