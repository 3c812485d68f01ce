// SPDX-License-Identifier: MIT
// What is written to a text_sink, as a string.
#pragma once

#include <string>
#include <string_view>

#include "io/text_sink.hpp"

namespace g4lidar::test {

/// All that `write(text_sink&)` writes.
template <class Write>
std::string written(const Write& write) {
  std::string all;
  g4_tool::callback_sink sink([&all](std::string_view text) { all += text; });
  write(sink);
  sink.flush();
  return all;
}

}  // namespace g4lidar::test
