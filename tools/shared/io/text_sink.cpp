// SPDX-License-Identifier: MIT
#include "text_sink.hpp"

#include <algorithm>

namespace g4_tool {

text_sink::text_sink() : buffer_(new char[capacity]) {}
text_sink::~text_sink() = default;

void text_sink::write(std::string_view text) {
  while (!text.empty()) {
    const std::string_view part = text.substr(0, max_room);
    wrote(std::ranges::copy(part, room(part.size())).out);
    text.remove_prefix(part.size());
  }
}

}  // namespace g4_tool
