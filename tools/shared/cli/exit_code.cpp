// SPDX-License-Identifier: MIT
#include "exit_code.hpp"

#include <array>

namespace g4_tool {

exit_code exit_code_for(const g4lidar::error& why, bool was_running) noexcept {
  using enum g4lidar::problem;
  switch (why.code()) {
    case bad_option:
    case bad_setting:
    case not_supported:
    case scanning:
    case not_scanning:
      return exit_code::usage;
    case no_port:
    case several_ports:
    case not_serial:
    case cannot_connect:
      return exit_code::no_device;
    case permission:
      return exit_code::permission;
    case busy:
    case interference:
      return exit_code::busy;
    case silence:
    case garbage:
    case bad_baud_rate:
    case timeout:
    case wrong_answer:
      return was_running ? exit_code::lost : exit_code::silent;
    case other_device:
      return exit_code::not_a_g4;
    case unhealthy:
    case does_not_stop:
    case not_reached:
    case brown_out:
      return exit_code::unhealthy;
    case gone:
    case reconnecting:
    case stalled:
      return exit_code::lost;
    case read_only:
    case end_of_input:
    case g4lidar::problem::bad_file:
      return exit_code::bad_file;
    case cancelled:
    case system:
      break;
  }
  return was_running ? exit_code::lost : exit_code::bad_file;
}

std::span<const tool_word> tool_words() noexcept {
  static constexpr std::array<tool_word, 15> words{{
      {"plug it in and open it again",
       "plug it in and run the command again; --on-loss reconnect "
       "waits for it"},
      {"has closed the connection: open it again",
       "has closed the connection: run the command again"},
      {"Call again: the next call waits until the lidar is back.",
       "Wait, or give --on-loss reconnect."},
      {"Call again or wait longer: the", "Wait longer: the"},
      {", and call again: scans continue", ": scans continue"},
      {"Stop the scan first, or allow it to be interrupted", "Stop the scan first: g4-dump stop"},
      {"Start the scan first", "Start the scan first: g4-dump start"},
      {"the program called wake()", "the command was interrupted"},
      {"open the lidar itself for that", "give the lidar as SOURCE"},
      {"Without a name the only lidar", "Without SOURCE the only lidar"},
      {"the option cannot have this value", "SOURCE or an option cannot have this value"},
      {"Correct the value or omit the option; every option has a default",
       "Correct it, or leave it out"},
      {"name it with the option model", "name it with --model"},
      {", or give lidar_options::answer_time a larger value", ""},
      {" (lidar_options::zero_angle)", ""},
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

}  // namespace g4_tool
