// SPDX-License-Identifier: MIT
// Reads CDR by its rules: little-endian, each number at a multiple of its size behind the first four bytes.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace g4lidar::test {

class cdr_reader {
 public:
  explicit cdr_reader(const std::vector<std::uint8_t>& message) : message_(message) {
    EXPECT_EQ(message.at(0), 0);
    EXPECT_EQ(message.at(1), 1);
  }
  template <class Number>
  Number number() {
    at_ = 4 + (at_ - 4 + sizeof(Number) - 1) / sizeof(Number) * sizeof(Number);
    Number value{};
    std::memcpy(&value, &message_.at(at_ + sizeof(Number) - 1) - (sizeof(Number) - 1),
                sizeof(Number));
    at_ += sizeof(Number);
    return value;
  }
  std::string text() {
    const auto size = number<std::uint32_t>();
    std::string value(reinterpret_cast<const char*>(&message_.at(at_)), size);
    at_ += size;
    EXPECT_EQ(value.back(), '\0');
    value.pop_back();
    return value;
  }
  [[nodiscard]] bool is_at_end() const { return at_ == message_.size(); }

 private:
  const std::vector<std::uint8_t>& message_;
  std::size_t at_ = 4;
};

}  // namespace g4lidar::test
