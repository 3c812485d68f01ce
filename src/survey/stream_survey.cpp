// SPDX-License-Identifier: MIT
#include "stream_survey.hpp"

#include <string_view>

namespace g4lidar {
namespace {

std::string_view words_for(text_kind what) noexcept {
  switch (what) {
    case text_kind::hex:
      return "This is text, bytes as hexadecimal digits: `xxd -r -p` makes bytes of it.";
    case text_kind::hexdump:
      return "This is text, the dump of bytes: `xxd -r` makes bytes of it if xxd wrote it.";
    case text_kind::plain:
      return "This is text, not the packets of a lidar.";
    case text_kind::none:
      break;
  }
  return {};
}

std::string_view words_for(stream_change what) noexcept {
  switch (what) {
    case stream_change::telnet:
      return "The bridge speaks telnet (each FF is doubled): set it to raw TCP.";
    case stream_change::crlf:
      return "Each 0A has a 0D before it: the bytes were transferred as text. Transfer them as "
             "binary.";
    case stream_change::utf8:
      return "Bytes above 7F are EF BF BD: a program has read the bytes as text in UTF-8.";
    case stream_change::cooked_line:
      return "No 03, 04, 0D, 11 or 13 arrived: a terminal line has taken them. Set it to raw mode "
             "(`stty raw`).";
    case stream_change::none:
      break;
  }
  return {};
}

}  // namespace

std::string stream_survey::finding() const {
  if (const other_maker* const other = maker()) {
    std::string text = "These are the frames of ";
    text.append(other->product).append(" (").append(other->frames).append(").");
    if (!other->driver.empty())
      text.append(" Its usual driver is ").append(other->driver).append(".");
    return text;
  }
  const std::string_view text = words_for(text_.text());
  return std::string(text.empty() ? words_for(text_.change()) : text);
}

}  // namespace g4lidar
