// SPDX-License-Identifier: MIT
// For tests of the times at which the driver reads: a driver in virtual time, and the units.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>

#include "g4lidar/lidar.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar::test {

using namespace std::chrono_literals;

constexpr std::int64_t us = 1'000;
constexpr std::int64_t ms = 1'000 * us;
constexpr std::int64_t second = 1'000 * ms;

}  // namespace g4lidar::test
