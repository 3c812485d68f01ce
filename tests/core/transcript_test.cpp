// SPDX-License-Identifier: MIT
// Every transcript of tests/transcripts, replayed with every division of the input.
//
// With G4LIDAR_TRANSCRIPTS_REWRITE set the logs are replaced by the output of the parser; then
// check the difference line by line.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "support/family_reference.hpp"
#include "support/reference_parser.hpp"
#include "support/stream_log.hpp"
#include "support/transcript.hpp"

namespace g4lidar {
namespace {

using test::buffer;

std::vector<std::string> transcript_names() {
  std::vector<std::string> names;
  std::error_code no_such_directory;
  for (const auto& entry :
       std::filesystem::directory_iterator(G4LIDAR_TRANSCRIPTS, no_such_directory)) {
    if (entry.path().extension() == ".txt") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::filesystem::path path_of(const std::string& name) {
  return std::filesystem::path(G4LIDAR_TRANSCRIPTS) / (name + ".txt");
}

std::string text_of_file(const std::string& name) {
  std::ifstream file(path_of(name), std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The inputs of all sections.
std::vector<buffer> inputs_of(std::string_view text) {
  std::vector<buffer> inputs(1);
  std::array<std::uint8_t, transcript::max_input> storage{};
  char last = '<';
  for (transcript::reader script(text); !script.done(); script.advance()) {
    const char kind = script.line().kind;
    if (kind == '<') {
      if (last == '>') inputs.emplace_back();
      const std::size_t count = transcript::read_hex(script.line().text, storage).value_or(0);
      inputs.back().insert(inputs.back().end(), storage.begin(),
                           storage.begin() + static_cast<std::ptrdiff_t>(count));
    }
    last = kind;
  }
  return inputs;
}

std::size_t longest_of(const std::vector<buffer>& inputs) {
  std::size_t longest = 0;
  for (const buffer& input : inputs) longest = std::max(longest, input.size());
  return longest;
}

void write_anew(const std::string& name) {
  const std::string text = text_of_file(name);
  std::ofstream out(path_of(name), std::ios::binary);
  std::istringstream in(text);
  stream_parser parser(transcript::format_of(text).value_or(g4_format));
  std::array<std::uint8_t, transcript::max_input> storage{};
  std::size_t size = 0;
  bool logged = false;
  for (std::string whole; std::getline(in, whole);) {
    if (whole.starts_with('>') && logged) continue;
    if (whole.starts_with('>')) {
      logged = true;
      static_cast<void>(transcript::log_section(
          parser, bytes(storage).first(size), [](std::size_t) { return transcript::max_input; },
          [&](std::string_view event) { out << "> " << event << '\n'; }));
      continue;
    }
    if (whole.starts_with('<')) {
      if (logged) size = 0;
      logged = false;
      const std::string_view hex = std::string_view(whole).substr(1, whole.find('#') - 1);
      size += transcript::read_hex(hex, std::span(storage).subspan(size)).value_or(0);
    }
    out << whole << '\n';
  }
}

class Transcript : public testing::TestWithParam<std::string> {
 protected:
  Transcript() : text_(text_of_file(GetParam())), inputs_(inputs_of(text_)) {}

  template <class Cut>
  bool replays(Cut cut) {
    const transcript::outcome result = transcript::replay(text_, storage_, cut);
    EXPECT_TRUE(result.ok) << GetParam() << ".txt:" << result.line_number
                           << "\n  expected: " << result.expected
                           << "\n  got:      " << result.got.view();
    return result.ok;
  }

  std::string text_;
  std::vector<buffer> inputs_;
  std::array<std::uint8_t, transcript::max_input> storage_{};
};

TEST_P(Transcript, InOnePiece) {
  if (std::getenv("G4LIDAR_TRANSCRIPTS_REWRITE") != nullptr) {
    write_anew(GetParam());
    GTEST_SKIP() << "the logs were replaced";
  }
  replays([](std::size_t) { return transcript::max_input; });
}

TEST_P(Transcript, InPiecesOfEverySize) {
  for (std::size_t size = 1; size <= longest_of(inputs_); ++size) {
    SCOPED_TRACE("pieces of " + std::to_string(size));
    if (!replays([=](std::size_t) { return size; })) return;
  }
}

TEST_P(Transcript, InThreePiecesOfEverySize) {
  const std::size_t longest = longest_of(inputs_);
  if (longest > 64) return;  // the short ones only: the number of divisions grows with the square
  for (std::size_t first = 1; first < longest; ++first) {
    for (std::size_t second = first + 1; second < longest; ++second) {
      const auto cut = [=](std::size_t from) {
        return from < first ? first - from : from < second ? second - from : longest;
      };
      SCOPED_TRACE("cut at " + std::to_string(first) + " and " + std::to_string(second));
      if (!replays(cut)) return;
    }
  }
}

TEST_P(Transcript, AgreesWithTheReference) {
  const transcript::reader script(text_);
  reference::packet_form form;
  if (script.line().kind == '=') {
    const auto& all = reference::wire_formats;
    const auto named = std::ranges::find(all, script.line().text, &reference::wire_format::model);
    ASSERT_NE(named, all.end()) << script.line().text;
    form = {static_cast<std::size_t>(named->sample_bytes), named->most_samples};
  }
  for (const buffer& input : inputs_) {
    stream_parser parser(transcript::format_of(text_).value_or(g4_format));
    test::stream_log log(input);
    log.feed(parser, input.size());
    log.finish(parser);
    EXPECT_EQ(test::difference(log, reference::read(input, form)), "");
  }
}

INSTANTIATE_TEST_SUITE_P(All, Transcript, testing::ValuesIn(transcript_names()),
                         [](const auto& name) { return name.param; });

TEST(Transcripts, ArePresent) { EXPECT_GE(transcript_names().size(), 40U); }

constexpr std::string_view small_transcript =
    "# A comment\n"
    "\n"
    "< AA 55 01 01 53 AE  # a comment behind the bytes\n"
    "< 53 AE AB 54 00 00\n"
    "> packet size=12 zero frequency_dhz=0 samples=1 first_deg=348.640625 last_deg=348.640625\n"
    "> finish\n";

constexpr bool replays_in_whole(std::string_view text) {
  std::array<std::uint8_t, transcript::max_input> storage{};
  return transcript::replay(text, storage, [](std::size_t) { return std::size_t{5}; }).ok;
}

static_assert(replays_in_whole(small_transcript), "the parser works at compile time");

TEST(TranscriptReplay, DetectsDifferences) {
  EXPECT_TRUE(replays_in_whole(small_transcript));
  const std::string text(small_transcript);
  EXPECT_FALSE(replays_in_whole(text + "> skipped 1 noise\n")) << "an event that does not come";
  EXPECT_FALSE(replays_in_whole(text.substr(0, text.find('>')) + "> finish\n")) << "one too many";
  EXPECT_FALSE(replays_in_whole(text.substr(0, text.rfind('>')))) << "finish is missing";
  EXPECT_FALSE(replays_in_whole(text + "< 00\n")) << "input without a log";
  EXPECT_FALSE(replays_in_whole("< A\n> finish\n")) << "half a byte";
  EXPECT_FALSE(replays_in_whole("< G0\n> finish\n")) << "no digit";
  EXPECT_TRUE(replays_in_whole(text + "< 00\n> skipped 1 noise\n> finish\n")) << "a second section";
  EXPECT_TRUE(replays_in_whole("= g4\n" + text));
  EXPECT_FALSE(replays_in_whole("= x4\n" + text)) << "the sample is missing";
  EXPECT_FALSE(replays_in_whole("= t-mini\n" + text)) << "the packet is longer";
  EXPECT_FALSE(replays_in_whole("= x44\n" + text)) << "no model";
  EXPECT_FALSE(replays_in_whole(text + "= g4\n")) << "a model behind bytes";
}

}  // namespace
}  // namespace g4lidar
