// SPDX-License-Identifier: MIT
// The faults of one device: which are at work now, whom they strike, and what they do to a byte.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "g4lidar/sim/fault.hpp"
#include "g4lidar/sim/random.hpp"

namespace g4lidar::sim {

/// What becomes of a byte on its way to the host.
struct passed_byte {
  std::array<std::uint8_t, 2> bytes{};
  std::uint8_t count = 0;
  bool inserted = false;  ///< Something came before it.
  bool damaged = false;   ///< It is not what it was, or is lost.
};

class fault_line {
 public:
  fault_line(std::span<const fault> faults, std::uint64_t seed);

  /// When a fault next begins or ends, after the time that was last set.
  [[nodiscard]] std::int64_t next_edge_ns() const noexcept { return edge_ns_; }
  void set_time(std::int64_t now_ns) noexcept;

  /// The first fault of this kind that is at work; nullptr where none is.
  [[nodiscard]] const fault* find(fault_kind kind) const noexcept;
  /// The end of the last of this kind that are at work; 0 where none is.
  [[nodiscard]] std::int64_t end_of(fault_kind kind) const noexcept;
  /// Whether one of this kind begins just now.
  [[nodiscard]] bool begins(fault_kind kind) const noexcept;
  /// Draws: the fault of this kind that strikes, or nullptr. Each that is at work draws once.
  [[nodiscard]] const fault* strike(fault_kind kind) noexcept;
  /// A number of 0 to below `count` for what a fault of this kind does; 0 where none is at work.
  [[nodiscard]] std::uint64_t draw(fault_kind kind, std::uint64_t count) noexcept;
  /// A byte goes to the host.
  [[nodiscard]] passed_byte pass(std::uint8_t byte) noexcept;

 private:
  struct entry {
    fault what;
    std::int64_t end_ns;
    random_stream random;
    std::int64_t left = 0;  // of a burst
    bool at_work = false;
  };
  void damage(entry& by, passed_byte& passing) noexcept;

  std::vector<entry> entries_;
  std::int64_t now_ns_ = -1;
  std::int64_t edge_ns_ = 0;
  bool on_the_wire_ = false;  // one is at work that looks at each byte
};

}  // namespace g4lidar::sim
