// SPDX-License-Identifier: MIT
// A line of text, composed without printf, which would need a heap and 20 KiB of code.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string_view>

/// A non-negative number, written with two digits behind the point.
struct fixed {
  float value;
};

/// Up to 160 characters; longer text is cut off.
class line {
 public:
  line& operator<<(std::string_view text) {
    for (const char letter : text) put(letter);
    return *this;
  }
  line& operator<<(std::unsigned_integral auto number) {
    std::array<char, 20> digits;
    std::size_t count = 0;
    auto left = static_cast<std::uint64_t>(number);
    do {
      digits[count++] = static_cast<char>('0' + left % 10U);
      left /= 10U;
    } while (left != 0);
    while (count > 0) put(digits[--count]);
    return *this;
  }
  line& operator<<(fixed number) {
    const auto hundredths = static_cast<std::uint32_t>(number.value * 100.0F + 0.5F);
    *this << hundredths / 100U << ".";
    put(static_cast<char>('0' + hundredths / 10U % 10U));
    put(static_cast<char>('0' + hundredths % 10U));
    return *this;
  }
  [[nodiscard]] std::string_view text() const { return {letters_.data(), size_}; }

 private:
  void put(char letter) {
    if (size_ < letters_.size()) letters_[size_++] = letter;
  }

  std::array<char, 160> letters_;
  std::size_t size_ = 0;
};
