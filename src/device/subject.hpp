// SPDX-License-Identifier: MIT
// What an error is about, put together without the heap: the line, what was asked, the numbers.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "g4lidar/request.hpp"

namespace g4lidar {

/// As much of the text as an error keeps. *Never allocates.*
class subject {
 public:
  explicit subject(std::string_view begin) noexcept { add(begin); }

  subject& add(std::string_view text) noexcept {
    const std::size_t count = std::min(text.size(), text_.size() - size_);
    std::copy_n(text.begin(), count, text_.begin() + size_);
    size_ += count;
    return *this;
  }
  subject& add(std::uint32_t number) noexcept {
    std::array<char, 10> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    return add({digits.data(), static_cast<std::size_t>(end - digits.data())});
  }
  /// "12 Hz", "7.5 Hz", "7.03 Hz".
  subject& add(scan_frequency frequency) noexcept {
    add(std::uint32_t{frequency.chz} / 100U);
    const std::uint32_t rest = frequency.chz % 100U;
    if (rest != 0) add(rest < 10 ? ".0" : ".").add(rest % 10 == 0 ? rest / 10 : rest);
    return add(" Hz");
  }
  /// "scan frequency 12 Hz", "health". Nothing for what the task says already: start, stop.
  subject& add(const request& wanted) noexcept;

  // NOLINTNEXTLINE(google-explicit-constructor): it is a text.
  operator std::string_view() const noexcept { return {text_.data(), size_}; }

 private:
  std::array<char, 95> text_{};
  std::size_t size_ = 0;
};

}  // namespace g4lidar
