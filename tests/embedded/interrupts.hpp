// SPDX-License-Identifier: MIT
// The board's one interrupt, for tests of what happens between any two instructions.
#pragma once

#include <cstdint>

namespace self_test {

/// Calls `handler` from an interrupt after `cycles` cycles of the processor, and again and again after
/// as many cycles from its end as it gives.
void start_ticks(std::uint32_t cycles, std::uint32_t (*handler)());
void stop_ticks();

}  // namespace self_test
