// SPDX-License-Identifier: MIT
#include "g4lidar/export/text_sink.hpp"

#include <cstring>

namespace g4lidar {

text_sink::text_sink() : buffer_(new char[capacity]) {}
text_sink::~text_sink() = default;

void text_sink::write(std::string_view text) {
  while (!text.empty()) {
    const std::string_view part = text.substr(0, max_room);
    char* const at = room(part.size());
    std::memcpy(at, part.data(), part.size());
    wrote(at + part.size());
    text.remove_prefix(part.size());
  }
}

}  // namespace g4lidar
