// SPDX-License-Identifier: MIT
// Formats errors, points and scans with {fmt}. An optional header.
#pragma once

#include <fmt/core.h>
#include <fmt/format.h>

#include <string_view>

#include "g4lidar/detail/text.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"

// The name, such as "permission".
template <>
struct fmt::formatter<g4lidar::problem> : fmt::formatter<std::string_view> {
  auto format(g4lidar::problem code, fmt::format_context& to) const {
    return fmt::formatter<std::string_view>::format(g4lidar::name_of(code), to);
  }
};

// The name, such as "opening".
template <>
struct fmt::formatter<g4lidar::task> : fmt::formatter<std::string_view> {
  auto format(g4lidar::task doing, fmt::format_context& to) const {
    return fmt::formatter<std::string_view>::format(g4lidar::name_of(doing), to);
  }
};

// The message.
template <>
struct fmt::formatter<g4lidar::error> : fmt::formatter<std::string_view> {
  auto format(const g4lidar::error& why, fmt::format_context& to) const {
    return fmt::formatter<std::string_view>::format(why.message(), to);
  }
};

// "12.345 deg, 1234.5 mm", or "no return" in place of the range.
template <>
struct fmt::formatter<g4lidar::point> : fmt::formatter<std::string_view> {
  auto format(const g4lidar::point& p, fmt::format_context& to) const {
    const auto text = g4lidar::detail::text_of(p);
    return fmt::formatter<std::string_view>::format(text.view(), to);
  }
};

// "scan 12: 1286 points", and its flags.
template <>
struct fmt::formatter<g4lidar::scan> : fmt::formatter<std::string_view> {
  auto format(const g4lidar::scan& s, fmt::format_context& to) const {
    const auto text = g4lidar::detail::text_of(s);
    return fmt::formatter<std::string_view>::format(text.view(), to);
  }
};
