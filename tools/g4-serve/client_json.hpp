// SPDX-License-Identifier: MIT
// Parses JSON from clients, within limits of size and depth.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

namespace g4_tool {

/// The longest text of a client, in bytes.
inline constexpr std::size_t longest_request = 16'384;

/// An object with the key "op", nested at most as deep as the protocols need; else nothing.
[[nodiscard]] inline std::optional<nlohmann::json> request_in(std::string_view text) {
  constexpr int greatest_depth = 4;
  if (text.size() > longest_request) return std::nullopt;
  bool is_deep = false;
  auto read = nlohmann::json::parse(
      text,
      [&is_deep](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
        is_deep = is_deep || depth > greatest_depth;
        return true;
      },
      false);
  if (is_deep || !read.is_object()) return std::nullopt;
  const auto op = read.find("op");
  if (op == read.end() || !op->is_string()) return std::nullopt;
  return read;
}

/// The finite number of a key; else nothing.
[[nodiscard]] inline std::optional<double> number_in(const nlohmann::json& object,
                                                     const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// A whole number from 0 to 2^32 - 1; else nothing.
[[nodiscard]] inline std::optional<std::uint32_t> id_in(const nlohmann::json& value) {
  if (!value.is_number_unsigned()) return std::nullopt;
  const auto number = value.get<std::uint64_t>();
  if (number > UINT32_MAX) return std::nullopt;
  return static_cast<std::uint32_t>(number);
}

}  // namespace g4_tool
