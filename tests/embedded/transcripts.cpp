// SPDX-License-Identifier: MIT
// Every transcript of tests/transcripts, in one piece and in pieces of every size.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "check.hpp"
#include "embedded_transcripts.hpp"
#include "support/transcript.hpp"

namespace self_test {
namespace {

std::array<std::uint8_t, g4lidar::transcript::max_input> storage;

/// The longest input of a transcript; 0 if it contains invalid hexadecimal.
std::size_t longest_input(std::string_view text) {
  std::size_t longest = 0;
  std::size_t size = 0;
  for (g4lidar::transcript::reader script(text); !script.done(); script.advance()) {
    if (script.line().kind == '>') {
      size = 0;
      continue;
    }
    if (script.line().kind == '=') continue;
    const auto count = g4lidar::transcript::read_hex(script.line().text, storage);
    if (!count) return 0;
    size += *count;
    longest = std::max(longest, size);
  }
  return longest;
}

bool replays(const embedded_transcript& transcript, std::size_t piece) {
  const auto outcome =
      g4lidar::transcript::replay(transcript.text, storage, [=](std::size_t) { return piece; });
  if (check(outcome.ok)) return true;
  put("  ");
  put(transcript.name);
  put(".txt:");
  put_number(outcome.line_number);
  put(" in pieces of ");
  put_number(piece);
  put("\n  expected: ");
  put(outcome.expected);
  put("\n  got:      ");
  put(outcome.got.view());
  put("\n");
  return false;
}

}  // namespace

void test_transcripts() {
  for (const embedded_transcript& transcript : transcripts) {
    const std::size_t longest = longest_input(transcript.text);
    std::size_t piece = std::max<std::size_t>(longest, 1);
    while (piece > 0 && replays(transcript, piece)) --piece;
  }
}

}  // namespace self_test
