// SPDX-License-Identifier: MIT
// The answers of a simulated lidar: when they are sent, and what faults make of them.
#pragma once

#include <cstdint>

#include "command_queues.hpp"
#include "fault_injector.hpp"
#include "g4lidar/sim/device_options.hpp"

namespace g4lidar::sim {

class answerer {
 public:
  /// Options and faults must outlive it.
  answerer(const device_options& options, fault_injector& faults) noexcept
      : options_(options), faults_(faults) {}

  /// Answers the command `code`, `later_ns` from now. Passes what is to be sent at once to `send`.
  template <class Send>
  void answer(std::uint8_t code, answer_bytes answer, std::int64_t later_ns, std::int64_t now_ns,
              Send send) noexcept {
    if (queue.begin_answer()) later_ns += options_.first_answer_ns;
    if (faults_.strike(fault_kind::mute, code) != nullptr) return;
    if (faults_.strike(fault_kind::wrong, code) != nullptr) answer = another_than(answer);
    const bool twice = faults_.strike(fault_kind::twice, code) != nullptr;
    const fault* const late = faults_.strike(fault_kind::late);
    if (late != nullptr) later_ns += late->amount;
    for (int times = twice ? 2 : 1; times > 0; --times) {
      if (later_ns > 0) {
        queue.add(answer, now_ns + later_ns);
      } else {
        send(answer);
      }
    }
  }
  /// A stopped device sends no header; a header that a fault has delayed is still sent.
  void forget_header() noexcept;
  /// What 91 and 92 answer.
  [[nodiscard]] health condition() const noexcept;

  answer_queue queue;

 private:
  /// A possible answer to a query of another kind.
  [[nodiscard]] answer_bytes another_than(const answer_bytes& right) noexcept;

  const device_options& options_;
  fault_injector& faults_;
};

}  // namespace g4lidar::sim
