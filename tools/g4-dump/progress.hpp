// SPDX-License-Identifier: MIT
// A progress bar on standard error.
#pragma once

#include <chrono>
#include <cstdint>

namespace g4_dump {

/// Shows how much of a known number of bytes is done, ten times a second, and wipes itself away.
class progress_bar {
 public:
  /// Below this many bytes it is over before anybody has read the bar.
  static constexpr std::uint64_t least_bytes = 16'000'000;

  /// Shows nothing where `wanted` is false, the bytes are few, or standard error is no terminal.
  progress_bar(bool wanted, std::uint64_t all_bytes);
  progress_bar(const progress_bar&) = delete;
  progress_bar& operator=(const progress_bar&) = delete;
  ~progress_bar() { clear(); }

  void show(std::uint64_t done_bytes);
  void clear();

 private:
  using clock = std::chrono::steady_clock;

  bool on_;
  bool drawn_ = false;
  std::uint64_t all_;
  clock::time_point begin_ = clock::now();
  clock::time_point next_ = begin_;
};

}  // namespace g4_dump
