// SPDX-License-Identifier: MIT
// The transmitter of the device: its output, byte by byte at the exact rate.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "command_effects.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "ring.hpp"

namespace g4lidar::sim {

/// Bytes that belong together: an answer, a text, or a packet with the true values of its samples.
struct transmission {
  std::array<std::uint8_t, 1 + longest_packet> data;
  std::uint8_t size = 0;
  std::uint8_t begin = 0;  ///< Of the packet; a stray byte may precede it.
  std::uint8_t count = 0;  ///< Of samples; 0: no packet.
  bool zero = false;
  bool damaged = false;
  std::uint64_t packet = 0;
  std::array<sample_truth, most_samples> truths;

  void assign(bytes content) noexcept;
  void assign(const sent_packet& sent, std::optional<std::uint8_t> stray) noexcept;
  void append(std::uint8_t byte) noexcept { data[size++] = byte; }
};

/// Sends bytes one after the other while there are any. Output that is added while it is full is
/// lost.
class wire {
 public:
  explicit wire(std::uint32_t baud) noexcept : baud_(baud) {}

  /// To be sent after everything else.
  void send(bytes content, std::int64_t now_ns) noexcept;
  void send(const transmission& sending, std::int64_t now_ns) noexcept;
  /// To be sent immediately, within the current output.
  void interject(const answer_bytes& answer, std::int64_t now_ns) noexcept;
  /// Discards output that has not begun; with `at_once`, also the rest of the current output.
  void cut(bool at_once) noexcept;
  /// Discards the rest of the current output.
  void cut_front() noexcept;
  /// No power.
  void reset() noexcept;

  [[nodiscard]] bool is_silent() const noexcept { return !busy_; }
  /// When the current byte has been sent.
  [[nodiscard]] std::int64_t next_ns() const noexcept { return next_ns_; }
  /// The byte that has just been sent.
  [[nodiscard]] std::uint8_t byte() const noexcept { return byte_; }
  /// Whether it belongs to a packet, and is not the first byte of the packet.
  [[nodiscard]] bool in_packet() const noexcept;
  [[nodiscard]] bool inside_packet() const noexcept;
  /// The packet is not intact any more.
  void damage() noexcept { queue_.front().damaged = true; }
  /// The transmission that ends with this byte; nullptr if none does.
  [[nodiscard]] const transmission* ending() const noexcept;
  /// Advances to the next byte.
  void advance() noexcept;

 private:
  void begin(std::int64_t now_ns) noexcept;
  void take_byte() noexcept;

  std::uint32_t baud_;
  ring<transmission, 16> queue_;
  ring<answer_bytes, 8> urgent_;
  std::size_t at_ = 0;         // the index of the next byte in the front transmission
  std::size_t urgent_at_ = 0;  // the same in the front transmission of urgent_
  bool busy_ = false;
  bool from_queue_ = false;  // the current byte is from the front transmission
  std::uint8_t byte_ = 0;
  std::int64_t begin_ns_ = 0;  // of this sequence of bytes without a pause
  std::int64_t sent_ = 0;      // bytes in it, including the current byte
  std::int64_t next_ns_ = forever_ns;
};

}  // namespace g4lidar::sim
