// SPDX-License-Identifier: MIT
// Replays a transcript (tests/transcripts/README.md) through the parser; without a heap.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "support/event_text.hpp"

namespace g4lidar::transcript {

/// The maximum number of input bytes of a section of a transcript.
inline constexpr std::size_t max_input = 1024;

/// One line of a transcript without its comment.
struct script_line {
  char kind = 0;  ///< '<' bytes in, '>' event out, '=' the model that sends them, 0 none.
  std::string_view text;
  std::size_t number = 0;  ///< From 1.
};

/// Returns the lines of a transcript one after the other, except empty ones.
class reader {
 public:
  constexpr explicit reader(std::string_view transcript) : rest_(transcript) { advance(); }

  [[nodiscard]] constexpr bool done() const { return line_.kind == 0; }
  [[nodiscard]] constexpr const script_line& line() const { return line_; }
  constexpr void advance() {
    line_.kind = 0;
    while (line_.kind == 0 && !rest_.empty()) {
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      std::string_view text = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      ++line_.number;
      text = text.substr(0, text.find('#'));
      while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.remove_suffix(1);
      if (text.size() < 2 || std::string_view("<>=").find(text[0]) == std::string_view::npos)
        continue;
      line_.kind = text[0];
      line_.text = text.substr(2);
    }
  }

 private:
  std::string_view rest_;
  script_line line_;
};

/// How the samples of a transcript are read: as those of the model that its first line names, "= x4", else
/// of a G4. Nothing if there is no such model.
[[nodiscard]] constexpr std::optional<sample_format> format_of(std::string_view transcript) {
  const reader script(transcript);
  if (script.line().kind != '=') return g4_format;
  const model* const named = model_named(script.line().text);
  if (named == nullptr) return std::nullopt;
  return named->samples;
}

[[nodiscard]] constexpr int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// Writes the bytes of the text `hex` ("AA 55") to the front of `out`; returns their number, or
/// nothing if it is not pairs of digits or does not fit.
[[nodiscard]] constexpr std::optional<std::size_t> read_hex(std::string_view hex,
                                                            std::span<std::uint8_t> out) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < hex.size();) {
    if (hex[i] == ' ') {
      ++i;
      continue;
    }
    const int high = hex_digit(hex[i]);
    const int low = i + 1 < hex.size() ? hex_digit(hex[i + 1]) : -1;
    if (high < 0 || low < 0 || count == out.size()) return std::nullopt;
    out[count++] = static_cast<std::uint8_t>(high * 16 + low);
    i += 2;
  }
  return count;
}

/// Feeds `input` to `parser`, cut by `cut(from) -> bytes of the next piece`, then ends it, and
/// passes each line of the log to `emit`; adjacent skips with one reason are one line. Returns
/// false, after a line with the error, if an event differs from the bytes of the input or if bytes
/// are missing.
template <class Cut, class Emit>
[[nodiscard]] constexpr bool log_section(stream_parser& parser, bytes input, Cut&& cut,
                                         Emit&& emit) {
  std::size_t reported = 0;  // bytes of the input covered by the events so far
  bool sound = true;
  skipped pending{0, skip_reason::noise};
  const auto show = [&](const line& text) { emit(text.view()); };
  const auto flush = [&] {
    if (pending.count > 0) show(text_of(pending));
    pending.count = 0;
  };
  const auto take = [&](const event& found) {
    if (const auto* gone = std::get_if<skipped>(&found)) {
      if (gone->reason != pending.reason) flush();
      pending = {pending.count + gone->count, gone->reason};
      reported += gone->count;
      return;
    }
    flush();
    const bytes data = data_of(found);
    if (const auto* packet = std::get_if<packet_view>(&found)) {
      show(text_of(*packet));
      const std::size_t shown = packet->layout() == g4_layout ? 0 : packet->sample_count();
      for (std::size_t i = 0; i < shown; ++i) show(text_of_sample(*packet, i));
    }
    if (const auto* reply = std::get_if<response_view>(&found)) show(text_of(*reply));
    if (const auto* time = std::get_if<time_packet_view>(&found)) show(text_of(*time));
    if (std::holds_alternative<empty_packet_view>(found)) show(line() << "empty packet");
    sound = sound && reported + data.size() <= input.size() &&
            std::equal(data.begin(), data.end(), input.subspan(reported).begin());
    reported += data.size();
  };
  for (std::size_t from = 0; from < input.size();) {
    const std::size_t count = std::min<std::size_t>(cut(from), input.size() - from);
    bytes piece = input.subspan(from, count);
    from += count;
    while (const auto found = parser.next(piece)) {
      take(*found);
      sound = sound && reported + parser.held() + piece.size() == from;
    }
    sound = sound && piece.empty() && reported + parser.held() == from;
  }
  flush();
  emit(std::string_view("finish"));
  while (const auto found = parser.finish()) take(*found);
  flush();
  sound = sound && reported == input.size() && parser.held() == 0;
  if (!sound) emit(std::string_view("(the events and counts above are not those of the input)"));
  return sound;
}

/// The first difference between a replay and its transcript; `ok` if there is none.
struct outcome {
  bool ok = true;
  std::size_t line_number = 0;
  std::string_view expected;
  line got;
};

/// Replays all sections of `transcript` through one parser, each cut by `cut`. `storage` holds the
/// input of one section at a time.
template <class Cut>
[[nodiscard]] constexpr outcome replay(std::string_view transcript, std::span<std::uint8_t> storage,
                                       Cut&& cut) {
  outcome result;
  const std::optional<sample_format> format = format_of(transcript);
  stream_parser parser(format.value_or(g4_format));
  reader script(transcript);
  const auto fail = [&](std::string_view got) {
    if (!result.ok) return;
    result = {false,
              script.line().number,
              script.done() ? std::string_view("(nothing more)") : script.line().text,
              {}};
    result.got << got;
  };
  const auto compare = [&](std::string_view got) {
    if (script.done() || script.line().kind != '>' || script.line().text != got) fail(got);
    if (!script.done() && script.line().kind == '>') script.advance();
  };
  if (!format) fail("(no model)");
  if (script.line().kind == '=') script.advance();
  while (!script.done() && result.ok) {
    std::size_t size = 0;
    for (; !script.done() && script.line().kind == '<'; script.advance()) {
      const auto count = read_hex(script.line().text, storage.subspan(size));
      if (!count) {
        fail("(not hexadecimal, or too long)");
        return result;
      }
      size += *count;
    }
    if (!log_section(parser, storage.first(size), cut, compare)) fail("(unsound)");
    if (!script.done() && script.line().kind != '<') fail("(nothing more)");
  }
  return result;
}

}  // namespace g4lidar::transcript
