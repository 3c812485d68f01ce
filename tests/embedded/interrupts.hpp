// SPDX-License-Identifier: MIT
// The interrupt of the board, for tests of events between any two instructions.
#pragma once

#include <cstdint>

namespace self_test {

/// Calls `handler` from an interrupt after `cycles` cycles of the processor, and then repeatedly:
/// the handler returns the number of cycles until the next interrupt.
void start_ticks(std::uint32_t cycles, std::uint32_t (*handler)());
void stop_ticks();

}  // namespace self_test
