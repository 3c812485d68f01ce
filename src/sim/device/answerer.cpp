// SPDX-License-Identifier: MIT
#include "sim/exact.hpp"

#include "answerer.hpp"

#include <array>
#include <cstddef>

namespace g4lidar::sim {

void answerer::forget_header() noexcept {
  if (options_.header_ns > 0) queue.remove(answer_with(response_kind::scan_started, {}));
}

health answerer::condition() const noexcept {
  if (const fault* bad = faults_.find(fault_kind::health)) {
    return {static_cast<health_status>(bad->amount), 1};
  }
  return options_.condition;
}

answer_bytes answerer::another_than(const answer_bytes& right) noexcept {
  const std::array others{
      answer_with(response_kind::byte,
                  std::array{static_cast<std::uint8_t>(faults_.draw(fault_kind::wrong, 2))}),
      answer_with(response_kind::frequency, std::array<std::uint8_t, 4>{0xBC, 0x02, 0, 0}),
      answer_with(condition()), answer_with(options_.info)};
  auto which = static_cast<std::size_t>(faults_.draw(fault_kind::wrong, others.size()));
  if (others[which].size == right.size) which = (which + 1) % others.size();
  return others[which];
}

}  // namespace g4lidar::sim
