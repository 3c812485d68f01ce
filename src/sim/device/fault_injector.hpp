// SPDX-License-Identifier: MIT
// The faults of one device: which are active, which packets or answers they affect, and their
// effect on a byte.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/random.hpp"

namespace g4lidar::sim {

/// The fate of a byte on its way to the host.
struct passed_byte {
  std::array<std::uint8_t, 2> bytes{};
  std::uint8_t count = 0;
  bool inserted = false;  ///< A byte was inserted before it.
  bool damaged = false;   ///< It was changed or lost.
};

class fault_injector {
 public:
  fault_injector(std::span<const fault> faults, std::uint64_t seed);

  /// When a fault next begins or ends, after the time that was set last.
  [[nodiscard]] std::int64_t next_edge_ns() const noexcept { return edge_ns_; }
  void set_time(std::int64_t now_ns) noexcept;

  /// The first active fault of this kind; nullptr if there is none.
  [[nodiscard]] const fault* find(fault_kind kind) const noexcept;
  /// The end of the last active fault of this kind; 0 if there is none.
  [[nodiscard]] std::int64_t end_of(fault_kind kind) const noexcept;
  /// Whether a fault of this kind begins now.
  [[nodiscard]] bool begins(fault_kind kind) const noexcept;
  /// Draws: the fault of this kind that takes effect, or nullptr. Each active fault draws once; of those to
  /// answers only the ones of every command and of `code`.
  [[nodiscard]] const fault* strike(fault_kind kind, std::uint8_t code = 0) noexcept;
  /// A number from 0 to below `count` for the effect of a fault of this kind; 0 if none is active.
  [[nodiscard]] std::uint64_t draw(fault_kind kind, std::uint64_t count) noexcept;
  /// A byte is sent to the host.
  [[nodiscard]] passed_byte pass(std::uint8_t byte) noexcept;

 private:
  struct entry {
    fault what;
    std::int64_t end_ns;
    random_stream random;
    std::int64_t left = 0;  // remaining bytes of a burst
    bool at_work = false;
  };
  void damage(entry& rule, passed_byte& passing) noexcept;

  std::vector<entry> entries_;
  std::int64_t now_ns_ = -1;
  std::int64_t edge_ns_ = 0;
  bool on_the_wire_ = false;  // an active fault affects single bytes
};

}  // namespace g4lidar::sim
