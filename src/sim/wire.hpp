// SPDX-License-Identifier: MIT
// The device's end of the serial line: what it wants to say, byte by byte at the true rate.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "g4lidar/packet.hpp"
#include "g4lidar/sim/fault.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "ring.hpp"
#include "settings.hpp"

namespace g4lidar::sim {

/// Bytes that belong together: an answer, a text, or a packet with what its samples truly were.
struct frame {
  std::array<std::uint8_t, 1 + max_packet_size> data;
  std::uint8_t size = 0;
  std::uint8_t begin = 0;  ///< Of the packet; a stray byte may stand before it.
  std::uint8_t count = 0;  ///< Of samples; 0: no packet.
  bool zero = false;
  bool damaged = false;
  std::uint64_t packet = 0;
  std::array<sample_truth, max_samples> truths;

  void assign(bytes content) noexcept;
  void assign(const sent_packet& sent, std::optional<std::uint8_t> stray) noexcept;
  void append(std::uint8_t byte) noexcept { data[size++] = byte; }
};

/// Bytes leave it one after the other while there are any. What it is given while it is full is lost.
class wire {
 public:
  explicit wire(std::uint32_t baud) noexcept : baud_(baud) {}

  /// To be said after everything else.
  void say(const frame& what, std::int64_t now_ns) noexcept;
  /// To be said at once, in the middle of what is being said.
  void interject(const answer_bytes& what, std::int64_t now_ns) noexcept;
  /// What has not begun is not said any more; with `at_once`, neither is the rest of what has.
  void cut(bool at_once) noexcept;
  /// The rest of what is being said is not said.
  void cut_front() noexcept;
  /// No power.
  void reset() noexcept;

  [[nodiscard]] bool is_silent() const noexcept { return !busy_; }
  /// When the byte on the line will be through.
  [[nodiscard]] std::int64_t next_ns() const noexcept { return next_ns_; }
  /// The byte that is through now.
  [[nodiscard]] std::uint8_t byte() const noexcept { return byte_; }
  /// Whether it belongs to a packet, and is not the packet's first.
  [[nodiscard]] bool in_packet() const noexcept;
  [[nodiscard]] bool inside_packet() const noexcept;
  /// The packet is no longer whole.
  void damage() noexcept { frames_.front().damaged = true; }
  /// The frame that ends with this byte; nullptr where none does.
  [[nodiscard]] const frame* ending() const noexcept;
  /// On to the next byte.
  void advance() noexcept;

 private:
  void begin(std::int64_t now_ns) noexcept;
  void take_byte() noexcept;

  std::uint32_t baud_;
  ring<frame, 16> frames_;
  ring<answer_bytes, 8> urgent_;
  std::size_t at_ = 0;         // in the front frame: of the next byte
  std::size_t urgent_at_ = 0;  // in the front one of urgent_
  bool busy_ = false;
  bool from_frame_ = false;  // the byte on the line comes from the front frame
  std::uint8_t byte_ = 0;
  std::int64_t begin_ns_ = 0;  // of this stretch of bytes without a pause
  std::int64_t sent_ = 0;      // bytes in it, that on the line included
  std::int64_t next_ns_ = forever_ns;
};

}  // namespace g4lidar::sim
