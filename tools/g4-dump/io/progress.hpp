// SPDX-License-Identifier: MIT
// Counts and a progress bar on standard error.
#pragma once

#include <chrono>
#include <cstdint>
#include <string_view>

namespace g4_dump {

/// A line of a terminal that is drawn over, ten times a second, and wiped away at the end. With -q, and
/// where standard error is not a terminal, nothing is drawn.
class status_line {
 public:
  explicit status_line(bool wanted);
  status_line(const status_line&) = delete;
  status_line& operator=(const status_line&) = delete;
  ~status_line() { clear(); }

  /// Whether draw() is to be called now.
  [[nodiscard]] bool is_due();
  void draw(std::string_view text);
  void clear();
  /// How long it has been there.
  [[nodiscard]] double seconds() const;

 private:
  using clock = std::chrono::steady_clock;

  bool on_;
  bool drawn_ = false;
  clock::time_point begin_ = clock::now();
  clock::time_point next_ = begin_;
};

/// Shows how much of a known number of bytes is done.
class progress_bar {
 public:
  /// Below this many bytes it is over before anybody has read the bar.
  static constexpr std::uint64_t least_bytes = 16'000'000;

  explicit progress_bar(std::uint64_t all_bytes, bool wanted = true)
      : line_(wanted && all_bytes >= least_bytes), all_(all_bytes) {}

  void show(std::uint64_t done_bytes);

 private:
  status_line line_;
  std::uint64_t all_;
};

}  // namespace g4_dump
