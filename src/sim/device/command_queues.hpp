// SPDX-License-Identifier: MIT
// Between the bytes of the host and the answers of a simulated G4: commands and answers that wait for their time.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "command_effects.hpp"
#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/command.hpp"
#include "g4lidar/sim/device.hpp"
#include "line_receiver.hpp"
#include "ring.hpp"
#include "sim/purpose.hpp"

namespace g4lidar::sim {

/// A command that was received, and is due for execution.
struct due_command {
  std::int64_t due_ns;
  std::int64_t asked_ns;
  std::uint8_t code;
};

/// What does not fit into the buffers is lost.
class command_receiver {
 public:
  explicit command_receiver(std::uint64_t seed) noexcept
      : line_(stream_for(seed, purpose::line_to_device)) {}

  /// The host sends bytes at `baud`.
  void write(bytes from_host, std::uint32_t baud, std::int64_t now_ns) noexcept {
    free_ns_ = std::max(free_ns_, now_ns);
    for (const std::uint8_t byte : from_host) {  // what does not fit takes no time
      const std::int64_t through_ns = free_ns_ + 10'000'000'000 / baud;
      if (bytes_.push({through_ns, byte})) free_ns_ = through_ns;
    }
  }
  /// When the next byte has arrived.
  [[nodiscard]] std::int64_t next_byte_ns() const noexcept {
    return bytes_.empty() ? line_.due_ns() : bytes_.front().at_ns;
  }
  /// Passes what a device at `own_baud` receives of it.
  template <class Take>
  void receive(std::int64_t now_ns, std::uint32_t sent_baud, std::uint32_t own_baud,
               Take take) noexcept {
    const auto received = [&take](std::uint8_t byte, bool) { take(byte); };
    if (bytes_.empty()) return line_.rest(now_ns, received);
    const host_byte sent = bytes_.front();
    bytes_.pop();
    if (!is_same_rate(sent_baud, own_baud)) {
      return line_.hear(sent.byte, sent.at_ns, sent_baud, own_baud, received);
    }
    line_.reset();
    take(sent.byte);
  }
  /// The device hears a byte: the second byte of a command is due after `reaction_ns`.
  void hear(std::uint8_t byte, std::int64_t now_ns, std::int64_t reaction_ns) noexcept {
    const bool is_second = start_byte_seen_ && byte != command_start;
    start_byte_seen_ = byte == command_start;
    if (is_second) commands_.push({now_ns + reaction_ns, now_ns, byte});
  }
  /// The device does not hear the byte.
  void ignore() noexcept { start_byte_seen_ = false; }

  /// When the next command is due.
  [[nodiscard]] std::int64_t next_command_ns() const noexcept {
    return commands_.empty() ? forever_ns : commands_.front().due_ns;
  }
  /// Takes this command.
  [[nodiscard]] due_command take_command() noexcept {
    const due_command due = commands_.front();
    commands_.pop();
    return due;
  }
  [[nodiscard]] bool is_empty() const noexcept {
    return bytes_.empty() && line_.due_ns() == forever_ns && commands_.empty();
  }

  /// No power: bytes on the way still arrive.
  void power_off() noexcept {
    commands_.clear();
    start_byte_seen_ = false;
  }
  void unplug() noexcept {
    bytes_.clear();
    line_.reset();
    free_ns_ = 0;
  }

 private:
  struct host_byte {
    std::int64_t at_ns;
    std::uint8_t byte;
  };

  line_receiver line_;
  std::int64_t free_ns_ = 0;  // the end of the last byte
  ring<host_byte, 1'024> bytes_;
  bool start_byte_seen_ = false;
  ring<due_command, 64> commands_;
};

/// Answers that are sent later.
class answer_queue {
 public:
  /// No answer was given since the device booted.
  void boot() noexcept { has_answered_ = false; }
  /// Whether this is the first answer since then.
  [[nodiscard]] bool begin_answer() noexcept { return !std::exchange(has_answered_, true); }

  /// An answer beyond the capacity is lost.
  void add(const answer_bytes& answer, std::int64_t due_ns) noexcept {
    for (late_answer& place : answers_) {
      if (place.due_ns != forever_ns) continue;
      place = {due_ns, answer};
      next_ns_ = std::min(next_ns_, due_ns);
      return;
    }
  }
  /// Removes all answers that begin with these bytes.
  void remove(const answer_bytes& begin) noexcept {
    for (late_answer& place : answers_) {
      const auto* const from = place.what.data.data();
      if (std::equal(begin.data.data(), begin.data.data() + begin.size, from)) {
        place.due_ns = forever_ns;
      }
    }
  }
  void clear() noexcept {
    answers_.fill({});
    next_ns_ = forever_ns;
  }

  /// When the first of them is due, or was when it was removed.
  [[nodiscard]] std::int64_t next_ns() const noexcept { return next_ns_; }
  /// Passes all due answers to `send`.
  template <class Send>
  void take_due(std::int64_t now_ns, Send send) noexcept {
    next_ns_ = forever_ns;
    for (late_answer& place : answers_) {
      if (place.due_ns <= now_ns) {
        place.due_ns = forever_ns;
        send(place.what);
      }
      next_ns_ = std::min(next_ns_, place.due_ns);
    }
  }

 private:
  struct late_answer {
    std::int64_t due_ns = forever_ns;  // forever_ns: none
    answer_bytes what;
  };

  std::array<late_answer, 16> answers_{};
  std::int64_t next_ns_ = forever_ns;
  bool has_answered_ = true;
};

}  // namespace g4lidar::sim
