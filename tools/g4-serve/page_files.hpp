// SPDX-License-Identifier: MIT
// The files of the web page, embedded into the program by embed.cmake.
#pragma once

#include <span>
#include <string_view>

namespace g4_tool {

struct page_file {
  std::string_view path;  ///< "/", "/page.css".
  std::string_view type;  ///< Its media type.
  std::string_view content;
};

/// All files; static.
[[nodiscard]] std::span<const page_file> page_files() noexcept;

}  // namespace g4_tool
