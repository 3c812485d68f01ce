// SPDX-License-Identifier: MIT
#include "mask_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <variant>

#include "cli/exit_code.hpp"
#include "input.hpp"

namespace g4_dump {

g4lidar::mask load_mask(const std::string& path) {
  constexpr std::size_t longest = std::size_t{1} << 24;
  constexpr const char* what_to_give = "Give a file with lines 'polygon x1 y1 x2 y2 x3 y3 ...'.";
  input in(path, what_to_give);
  std::string text;
  std::array<std::uint8_t, 16'384> part;
  while (const std::size_t count = in.read(part)) {
    text.append(reinterpret_cast<const char*>(part.data()), count);
    if (text.size() > longest) {
      throw failure(exit_code::bad_file, in.title() + " is longer than 16 MB. " + what_to_give);
    }
  }
  auto made = g4lidar::parse_mask(text);
  if (auto* const good = std::get_if<g4lidar::mask>(&made)) return std::move(*good);
  const auto& wrong = std::get<g4lidar::mask_error>(made);
  const std::string line = wrong.line > 0 ? fmt::format(", line {}", wrong.line) : "";
  throw failure(exit_code::bad_file,
                fmt::format("{}{}: {}. {}", in.title(), line, wrong.message, what_to_give));
}

}  // namespace g4_dump
