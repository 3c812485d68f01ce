// SPDX-License-Identifier: MIT
// The receiver of a serial line whose sender has another baud rate: it samples the bits of the sender at
// its own times, and so receives other bytes, more or fewer of them.
#pragma once

#include <array>
#include <cstdint>

#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/random.hpp"

namespace g4lidar::sim {

/// Whether a receiver gets all bytes right without looking at bits: the rates differ by at most 2.5 %.
[[nodiscard]] constexpr bool is_same_rate(std::uint32_t sent, std::uint32_t received) noexcept {
  const std::uint64_t off = sent > received ? sent - received : received - sent;
  return off * 40 <= received;
}

/// Eight data bits, no parity, one stop bit, as a UART receives them. It detects the edge of a start bit up
/// to a sixteenth of a bit late, and samples each bit up to a fifth of a bit behind its middle: a receiver
/// that is 3 % too slow, or 5 % too fast, begins to fail. What has no stop bit is a byte like the others, as
/// a tty passes it; the next start bit needs an edge. *Single thread. Never allocates.*
class line_receiver {
 public:
  explicit line_receiver(random_stream random) noexcept : random_(random) {}

  /// A byte was sent until `end_ns`, at `sent_baud`. The line was high since the byte before. Passes the
  /// bytes that a receiver at `own_baud` has received by then to `take`, and whether each has a stop bit.
  template <class Take>
  void hear(std::uint8_t byte, std::int64_t end_ns, std::uint32_t sent_baud, std::uint32_t own_baud,
            Take take) noexcept {
    own_baud_ = own_baud;
    const std::int64_t begin_ns = end_ns - bits(10, sent_baud);
    run(begin_ns, true, take);
    // Start bit, data, stop bit; from the lowest bit on.
    const unsigned levels = unsigned{byte} << 1U | 0x200U;
    bool before = true;
    for (int i = 0; i < 10; ++i) {
      const bool high = (levels >> i & 1U) != 0;
      if (before && !high) edge(begin_ns + bits(i, sent_baud));
      run(begin_ns + bits(i + 1, sent_baud), high, take);
      before = high;
    }
  }
  /// Nothing is sent until `now_ns`: the line is high.
  template <class Take>
  void rest(std::int64_t now_ns, Take take) noexcept {
    run(now_ns, true, take);
  }
  /// When the byte is complete that is being received; forever_ns: none is.
  [[nodiscard]] std::int64_t due_ns() const noexcept {
    return next_ == 0 ? forever_ns : edge_ns_ + bits(10, own_baud_);
  }
  /// Begins again: another rate, or no power.
  void reset() noexcept { next_ = 0; }

 private:
  static constexpr std::int64_t bits(std::int64_t count, std::uint32_t baud) noexcept {
    return count * 1'000'000'000 / baud;
  }

  // The first edge after the last byte begins a byte.
  void edge(std::int64_t at_ns) noexcept {
    if (next_ != 0 || at_ns < free_ns_) return;
    edge_ns_ = at_ns + part_of_bit(1, 16);
    next_ = 1;
    received_ = 0;
    choose_sample();
  }
  void choose_sample() noexcept {
    sample_ns_ = edge_ns_ + bits(2 * next_ - 1, own_baud_) / 2 + part_of_bit(20, 100);
  }
  // Random, from 0 to `numerator / denominator` of a bit.
  std::int64_t part_of_bit(std::int64_t numerator, std::int64_t denominator) noexcept {
    const auto drawn = static_cast<std::int64_t>(random_.next() >> 48);
    return bits(numerator, own_baud_) * drawn / (65'536 * denominator);
  }

  // All samples before `until_ns`, until when the line has this level.
  template <class Take>
  void run(std::int64_t until_ns, bool high, Take take) noexcept {
    while (next_ != 0 && sample_ns_ < until_ns) {
      if (next_ == 1 && high) {
        next_ = 0;  // no start bit
        return;
      }
      if (next_ == 10) {
        free_ns_ = sample_ns_;
        next_ = 0;
        take(static_cast<std::uint8_t>(received_), high);
        return;
      }
      if (next_ > 1 && high) received_ |= 1U << (next_ - 2);
      ++next_;
      choose_sample();
    }
  }

  random_stream random_;
  std::uint32_t own_baud_ = 230'400;
  std::int64_t edge_ns_ = 0;    // of the start bit
  std::int64_t sample_ns_ = 0;  // the next one
  std::int64_t free_ns_ = 0;    // when the last byte ended
  int next_ = 0;  // the sample: 1 the start bit, 10 the stop bit; 0: waits for an edge
  unsigned received_ = 0;
};

}  // namespace g4lidar::sim
