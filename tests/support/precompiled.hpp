// SPDX-License-Identifier: MIT
// The headers that most tests include, compiled once if G4LIDAR_TEST_PCH is on. It contains no
// header of this library: a change of one would recompile every test. Each test includes the
// headers that it uses nevertheless.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>
#include <vector>
