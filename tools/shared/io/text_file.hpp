// SPDX-License-Identifier: MIT
// A small text file that an option names, as what the library reads from it.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "cli/exit_code.hpp"
#include "input.hpp"

namespace g4_tool {

/// What `parse` makes of the text in the file of that name: a variant of it and of an error with a
/// line. Throws a failure that names the file and the line. `what_to_give` ends its sentence.
template <class Made, class Parse>
[[nodiscard]] Made load_text(const std::string& path, std::size_t most_megabytes,
                             const std::string& what_to_give, Parse parse) {
  input in(path, what_to_give);
  std::string text;
  std::array<std::uint8_t, 16'384> part;
  while (const std::size_t count = in.read(part)) {
    text.append(reinterpret_cast<const char*>(part.data()), count);
    if (text.size() >> 20U >= most_megabytes) {
      throw failure(exit_code::bad_file, fmt::format("{} is longer than {} MB. {}", in.title(),
                                                     most_megabytes, what_to_give));
    }
  }
  auto made = parse(std::string_view(text));
  if (auto* const good = std::get_if<Made>(&made)) return std::move(*good);
  const auto& wrong = std::get<1>(made);
  const std::string line = wrong.line > 0 ? fmt::format(", line {}", wrong.line) : "";
  throw failure(exit_code::bad_file,
                fmt::format("{}{}: {}. {}", in.title(), line, wrong.message, what_to_give));
}

}  // namespace g4_tool
