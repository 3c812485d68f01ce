// SPDX-License-Identifier: MIT
#include "tool_words.hpp"

#include <array>

namespace g4_dump {

std::span<const tool_word> tool_words() noexcept {
  static constexpr std::array<tool_word, 10> words{{
      {"plug it in and open it again",
       "plug it in and run the command again; --on-loss reconnect "
       "waits for it"},
      {"has closed the connection: open it again",
       "has closed the connection: run the command again"},
      {"Call again: the next call waits until the lidar is back.",
       "Wait, or give --on-loss reconnect."},
      {"Stop the scan first, or allow it to be interrupted", "Stop the scan first: g4-dump stop"},
      {"Start the scan first", "Start the scan first: g4-dump start"},
      {"the program called wake()", "the command was interrupted"},
      {"open the lidar itself for that", "give the lidar as SOURCE"},
      {"the option cannot have this value", "SOURCE or an option cannot have this value"},
      {"Correct the value or omit the option; every option has a default",
       "Correct it, or leave it out"},
      {", or give lidar_options::answer_time a larger value", ""},
  }};
  return words;
}

std::string in_tool_words(std::string_view text) {
  std::string all(text);
  for (const tool_word& each : tool_words()) {
    if (const std::size_t at = all.find(each.library); at != std::string::npos) {
      all.replace(at, each.library.size(), each.tool);
    }
  }
  return all;
}

}  // namespace g4_dump
