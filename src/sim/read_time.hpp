// SPDX-License-Identifier: MIT
// Times in texts.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace g4lidar::sim {

/// "5s", "1.5ms", "200us", "30ns", "2min" or "0" in nanoseconds, at most 11 days.
[[nodiscard]] std::optional<std::int64_t> read_time_ns(std::string_view text) noexcept;

}  // namespace g4lidar::sim
