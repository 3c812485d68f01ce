// SPDX-License-Identifier: MIT
#include "stream_survey.hpp"

#include <string_view>

namespace g4lidar {
namespace {

constexpr std::string_view again = "Record the bytes again, as they are.";

std::string_view words_for(text_kind what) noexcept {
  switch (what) {
    case text_kind::hex:
      return "This is text, bytes as hexadecimal digits: `xxd -r -p FILE NEW` makes bytes of it.";
    case text_kind::xxd:
      return "This is text, the dump of bytes by xxd: `xxd -r FILE NEW` makes bytes of it.";
    case text_kind::byte_dump:
      return "This is text, the dump of bytes by hexdump -C or od: "
             "`sed -E 's/^[0-9A-Fa-f]{4,}//; s/[|>].*//' FILE | xxd -r -p > NEW` makes bytes of "
             "it.";
    case text_kind::other_dump:
      return "This is text, the dump of bytes in words, by hexdump or od.";
    case text_kind::c_array:
      return "This is text, bytes as numbers of C: "
             "`grep -o '0[xX][0-9A-Fa-f]*' FILE | cut -c 3- | xxd -r -p > NEW` makes bytes of it.";
    case text_kind::python:
      return "This is text, bytes as a literal of Python: `python3 -c 'import ast, sys; "
             "sys.stdout.buffer.write(ast.literal_eval(sys.stdin.read()))' < FILE > NEW` makes "
             "bytes of it.";
    case text_kind::escapes:
      return "This is text, bytes as they are written in programs.";
    case text_kind::numbers:
      return "This is text, bytes as decimal numbers: `python3 -c 'import re, sys; "
             "sys.stdout.buffer.write(bytes(map(int, re.findall(\"[0-9]+\", sys.stdin.read()))))' "
             "< FILE > NEW` makes bytes of it.";
    case text_kind::plain:
      return "This is text, not the packets of a lidar.";
    case text_kind::none:
      break;
  }
  return {};
}

std::string words_for(const text_signs& seen) {
  const text_kind what = seen.text();
  std::string text(words_for(what));
  const bool is_lost = what == text_kind::byte_dump && seen.leaves_out();
  if (is_lost) text = "This is text, the dump of bytes by hexdump or od, without equal lines.";
  const bool needs_again = is_lost || what == text_kind::other_dump || what == text_kind::escapes;
  return needs_again ? text.append(" ").append(again) : text;
}

/// "0D, 11 and 13".
std::string list_of(const change_signs::control_set& controls) {
  std::string text;
  std::size_t left = controls.count();
  for (unsigned each = 0; each < controls.size(); ++each) {
    if (!controls.test(each)) continue;
    if (!text.empty()) text += left == 1 ? " and " : ", ";
    constexpr std::string_view digits = "0123456789ABCDEF";
    text.append(digits.substr(each >> 4U, 1)).append(digits.substr(each & 15U, 1));
    --left;
  }
  return text;
}

std::string words_for(const change_signs& seen) {
  const stream_change what = seen.change();
  std::string text(words_for(what));
  if (what >= stream_change::flow_control)
    text.insert(0, "No " + list_of(seen.missing()) + " arrived: ");
  if (what == stream_change::recoded) text.append(" ").append(again);
  return text;
}

std::string_view words_for(echo_kind what) noexcept {
  switch (what) {
    case echo_kind::loop_back:
      return "Nothing arrives but what was sent: the wires of both directions are connected, or "
             "the bridge echoes. No lidar answers.";
    case echo_kind::console:
      return "What was sent comes back, and text: a console (a login, a shell, a boot loader) is "
             "at this port, and no lidar.";
    case echo_kind::none:
      break;
  }
  return {};
}

}  // namespace

std::string_view words_for(stream_change what) noexcept {
  switch (what) {
    case stream_change::telnet:
      return "The bridge speaks telnet (each FF is doubled): set it to raw TCP.";
    case stream_change::crlf:
      return "Each 0A has a 0D before it: the bytes were transferred as text. Transfer them as "
             "binary.";
    case stream_change::utf8:
      return "Bytes above 7F are EF BF BD: a program has read the bytes as text in UTF-8. They are "
             "lost.";
    case stream_change::latin1:
      return "Bytes above 7F are two (C2 or C3, and another): a program has read the bytes as text "
             "in Latin-1 and written them as UTF-8. `iconv -f UTF-8 -t LATIN1 FILE > NEW` makes "
             "bytes of it.";
    case stream_change::recoded:
      return "Bytes above 7F are two or three: a program has read the bytes as text and written "
             "them as UTF-8.";
    case stream_change::seven_bits:
      return "No byte above 7F arrived: bit 7 of each was taken. Set the line to eight data bits "
             "without parity, and to raw mode (`stty raw cs8`).";
    case stream_change::flow_control:
      return "flow control by software (XON, XOFF) has taken them. Switch it off (`stty -ixon "
             "-ixoff`, or in the settings of the bridge).";
    case stream_change::tabs:
      return "each became blanks, as a program does for text. Transfer the bytes as binary.";
    case stream_change::cooked_line:
      return "a terminal line has taken or replaced them. Set it to raw mode (`stty raw`).";
    case stream_change::none:
      break;
  }
  return {};
}

std::string stream_survey::finding() const {
  if (const other_maker* const other = maker()) {
    std::string text = "These are the frames of ";
    text.append(other->product).append(" (").append(other->frames).append(").");
    if (!other->driver.empty())
      text.append(" Its usual driver is ").append(other->driver).append(".");
    return text;
  }
  if (echo() != echo_kind::none) return std::string(words_for(echo()));
  if (text() == text_kind::none) return words_for(change_);
  return layout_.has_packet() ? std::string() : words_for(text_);  // packets behind a boot text
}

}  // namespace g4lidar
