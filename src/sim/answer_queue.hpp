// SPDX-License-Identifier: MIT
// Answers of a simulated G4 that are sent later.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "g4lidar/sim/fault.hpp"
#include "settings.hpp"

namespace g4lidar::sim {

class answer_queue {
 public:
  /// No answer was given since the device booted.
  void boot() noexcept { has_answered_ = false; }
  /// Whether this is the first answer since then.
  [[nodiscard]] bool begin_answer() noexcept { return !std::exchange(has_answered_, true); }

  /// An answer beyond the capacity is lost.
  void add(const answer_bytes& what, std::int64_t due_ns) noexcept {
    for (late_answer& place : answers_) {
      if (place.due_ns != forever_ns) continue;
      place = {due_ns, what};
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
