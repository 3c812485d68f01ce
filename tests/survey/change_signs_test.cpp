// SPDX-License-Identifier: MIT
// Streams of simulated lidars, changed as the documents of terminals, of telnet and of encodings state it, and by a real
// terminal line.
#include "survey/change_signs.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <string_view>

#include "discovery/fitting_models.hpp"
#include "support/patience.hpp"
#include "support/test_scale.hpp"
#include "survey/streams.hpp"
#include "transport/pty.hpp"

namespace g4lidar::test {
namespace {

change_signs seen_in(const byte_list& all, std::size_t piece = 4096) {
  change_signs seen;
  for (std::size_t at = 0; at < all.size(); at += piece) {
    seen.take(bytes(all).subspan(at, std::min(piece, all.size() - at)));
  }
  return seen;
}

byte_list g4_stream(std::size_t size = 65'536) {
  return stream_of(g4_model, sim::built_in_world(), 1, size);
}

/// Each byte as these bytes.
byte_list with_each(const byte_list& all, const std::function<byte_list(std::uint8_t)>& as) {
  byte_list changed;
  for (const std::uint8_t byte : all) {
    const byte_list more = as(byte);
    changed.insert(changed.end(), more.begin(), more.end());
  }
  return changed;
}

byte_list without(const byte_list& all, const byte_list& taken) {
  return with_each(all, [&](std::uint8_t byte) {
    return std::ranges::find(taken, byte) == taken.end() ? byte_list{byte} : byte_list{};
  });
}

/// UTF-8 of the character with this number (RFC 3629).
byte_list utf8_of(unsigned number) {
  const auto low_of = [](unsigned value) { return static_cast<std::uint8_t>(0x80 + value % 64); };
  if (number < 0x80) return {static_cast<std::uint8_t>(number)};
  if (number < 0x800) return {static_cast<std::uint8_t>(0xC0 + number / 64), low_of(number)};
  return {static_cast<std::uint8_t>(0xE0 + number / 4096), low_of(number / 64), low_of(number)};
}

/// What a program reads from a pseudo-terminal with these flags to whose other end `all` is written.
byte_list through_terminal(const byte_list& all, tcflag_t input, tcflag_t local) {
  const pty line;
  termios how{};
  EXPECT_EQ(::tcgetattr(line.keep(), &how), 0);
  ::cfmakeraw(&how);
  how.c_iflag |= input;
  how.c_lflag |= local | NOFLSH;
  EXPECT_EQ(::tcsetattr(line.keep(), TCSANOW, &how), 0);
  byte_list got;
  const auto read_some = [&](int wait_ms) {
    pollfd polled{line.keep(), POLLIN, 0};
    while (::poll(&polled, 1, wait_ms) > 0) {
      std::array<std::uint8_t, 4096> piece{};
      const ssize_t count = ::read(line.keep(), piece.data(), piece.size());
      if (count <= 0) return false;
      got.insert(got.end(), piece.begin(), piece.begin() + count);
      if (wait_ms > 0) return true;
    }
    return false;
  };
  constexpr std::string_view end = "-the end-";
  const auto is_complete = [&] {
    return got.size() >= end.size() &&
           std::equal(end.begin(), end.end(), got.end() - static_cast<std::ptrdiff_t>(end.size()));
  };
  constexpr std::size_t piece = 1024;
  for (std::size_t at = 0; at < all.size(); at += piece) {
    const std::size_t count = std::min(piece, all.size() - at);
    EXPECT_EQ(::write(line.master(), all.data() + at, count), static_cast<ssize_t>(count));
    read_some(0);
  }
  EXPECT_EQ(::write(line.master(), end.data(), end.size()), static_cast<ssize_t>(end.size()));
  while (!is_complete() && read_some(patience_ms)) continue;
  EXPECT_TRUE(is_complete());
  got.resize(got.size() - std::min(end.size(), got.size()));
  return got;
}

std::string missing_in(const change_signs& seen) {
  std::string all;
  for (unsigned each = 0; each < 32; ++each) {
    if (seen.missing().test(each)) all.append(all.empty() ? "" : " ").append(std::to_string(each));
  }
  return all;
}

struct line_mode {
  tcflag_t input;
  tcflag_t local;
  stream_change change;
  std::string_view missing;
};

// termios(3): what each flag of the input takes or replaces.
TEST(ChangeSigns, KnowEachModeOfATerminalLine) {
  const byte_list all = g4_stream();
  const std::array modes{
      line_mode{0, 0, stream_change::none, ""},
      line_mode{ICRNL, 0, stream_change::cooked_line, "13"},
      line_mode{IGNCR, 0, stream_change::cooked_line, "13"},
      line_mode{IXON, 0, stream_change::flow_control, "17 19"},
      line_mode{ICRNL | IXON, 0, stream_change::cooked_line, "13 17 19"},
      line_mode{0, ISIG, stream_change::cooked_line, "3"},
      line_mode{ICRNL | IXON, ISIG, stream_change::cooked_line, "3 13 17 19"},
      line_mode{ISTRIP, 0, stream_change::seven_bits, ""},
      line_mode{ISTRIP | ICRNL | IXON, ISIG, stream_change::seven_bits, ""},
  };
  for (const line_mode& each : modes) {
    const change_signs seen = seen_in(through_terminal(all, each.input, each.local));
    EXPECT_EQ(seen.change(), each.change) << each.input << ' ' << each.local;
    if (each.change == stream_change::seven_bits) continue;
    EXPECT_EQ(missing_in(seen), each.missing) << each.input << ' ' << each.local;
  }
}

// What a terminal in its usual mode takes shows after half a second.
TEST(ChangeSigns, KnowTheUsualModeSoon) {
  const byte_list all = g4_stream(8'192);
  byte_list changed = without(all, {0x03, 0x04, 0x11, 0x13});
  std::ranges::replace(changed, 0x0D, 0x0A);
  EXPECT_EQ(seen_in(changed).change(), stream_change::cooked_line);
}

// The short packets show it before the absence of the two characters can be no chance.
TEST(ChangeSigns, KnowFlowControlByShortPackets) {
  for (const char* const word : {"g4", "x4", "t-mini-pro", "t-mini-plus-sh"}) {
    for (const int seed : seeds(5)) {
      const byte_list all = stream_of(*model_named(word), sim::built_in_world(),
                                      static_cast<std::uint32_t>(seed), 22'000);
      const change_signs seen = seen_in(without(all, {0x11, 0x13}));
      EXPECT_EQ(seen.change(), stream_change::flow_control) << word << seed;
      EXPECT_EQ(missing_in(seen), "17 19") << word << seed;
    }
  }
}

// A bridge drops any byte, in about every second packet.
TEST(ChangeSigns, NoFalseAlarmWhereBytesAreDropped) {
  for (const char* const word : {"g4", "x4", "t-mini-pro", "t-mini-plus-sh"}) {
    for (const int seed : seeds(20)) {
      const byte_list all = stream_of(*model_named(word), sim::built_in_world(),
                                      static_cast<std::uint32_t>(seed), 22'000);
      std::mt19937_64 random(static_cast<std::uint64_t>(seed));
      const byte_list dropped = with_each(all, [&](std::uint8_t byte) {
        return random() % 200 == 0 ? byte_list{} : byte_list{byte};
      });
      EXPECT_EQ(seen_in(dropped).change(), stream_change::none) << word << seed;
    }
  }
}

TEST(ChangeSigns, KnowTabsThatBecameBlanks) {
  std::size_t column = 0;
  const byte_list changed = with_each(g4_stream(), [&](std::uint8_t byte) {
    if (byte == 0x09) {
      const byte_list blanks(8 - column % 8, 0x20);
      column = 0;
      return blanks;
    }
    column = byte == 0x0A || byte == 0x0D ? 0 : column + 1;
    return byte_list{byte};
  });
  const change_signs seen = seen_in(changed);
  EXPECT_EQ(seen.change(), stream_change::tabs);
  EXPECT_EQ(missing_in(seen), "9");
}

TEST(ChangeSigns, KnowLineEndsThatATransferOfTextInserted) {
  const byte_list changed = with_each(g4_stream(), [](std::uint8_t byte) {
    return byte == 0x0A ? byte_list{0x0D, 0x0A} : byte_list{byte};
  });
  EXPECT_EQ(seen_in(changed).change(), stream_change::crlf);
  EXPECT_EQ(seen_in(changed, 1).change(), stream_change::crlf);
}

TEST(ChangeSigns, KnowTelnet) {
  const byte_list greeting{255, 251, 3, 255, 253, 3, 255, 251, 1, 255, 253, 1};
  byte_list changed = greeting;
  for (const std::uint8_t byte :
       stream_of(*model_named("t-mini-plus"), sim::built_in_world(), 1, 65'536)) {
    if (byte == 0xFF) changed.push_back(0xFF);
    changed.push_back(byte);
  }
  EXPECT_EQ(seen_in(changed).change(), stream_change::telnet);
  EXPECT_EQ(seen_in(changed, 1).change(), stream_change::telnet);
  EXPECT_EQ(seen_in(greeting).change(), stream_change::telnet) << "before the lidar sends";
}

TEST(ChangeSigns, KnowBytesThatWereTakenForTextInUtf8) {
  const byte_list replaced = with_each(g4_stream(), [](std::uint8_t byte) {
    return byte < 0x80 ? byte_list{byte} : utf8_of(0xFFFD);
  });
  EXPECT_EQ(seen_in(replaced).change(), stream_change::utf8);
}

TEST(ChangeSigns, KnowBytesThatWereTakenForTextInLatin1OrAnotherEncoding) {
  const byte_list all = g4_stream(4'096);
  const byte_list latin1 = with_each(all, [](std::uint8_t byte) { return utf8_of(byte); });
  for (const std::size_t piece : {1U, 4096U})
    EXPECT_EQ(seen_in(latin1, piece).change(), stream_change::latin1);
  // Windows-1252 has the euro sign at 80.
  const byte_list windows = with_each(all, [](std::uint8_t byte) {
    return utf8_of(byte >= 0x80 && byte < 0xA0 ? 0x20AC - 0x80U + byte : byte);
  });
  EXPECT_EQ(seen_in(windows).change(), stream_change::recoded);
}

TEST(ChangeSigns, NoFalseAlarmInStreamsOfAllModels) {
  int streams = 0;
  for (const sim::world& scene : some_worlds()) {
    for (const model& which : models) {
      for (const int seed : seeds(10)) {
        const byte_list all = stream_of(which, scene, static_cast<std::uint32_t>(seed), 32'768);
        change_signs seen;
        for (std::size_t at = 0; at < all.size(); at += 2048) {
          seen.take(bytes(all).subspan(at, 2048));
          ASSERT_EQ(seen.change(), stream_change::none)
              << which.word << ", seed " << seed << ", " << at << ": " << missing_in(seen);
        }
        ++streams;
      }
    }
  }
  EXPECT_GE(streams, 1'000);
}

// 10^7 bytes; more in the nightly.
TEST(ChangeSigns, NoFalseAlarmInRandomBytes) {
  for (const int seed : seeds(10)) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    byte_list all(1'000'000);
    for (std::uint8_t& each : all) each = static_cast<std::uint8_t>(random());
    EXPECT_EQ(seen_in(all).change(), stream_change::none) << seed;
  }
}

TEST(ChangeSigns, NoFalseAlarmInOneByteOrTwoAgainAndAgain) {
  for (unsigned byte = 0; byte < 256; ++byte) {
    const auto one = static_cast<std::uint8_t>(byte);
    EXPECT_EQ(seen_in(byte_list(20'000, one)).change(), stream_change::none) << byte;
    byte_list two;
    for (int i = 0; i < 10'000; ++i) two.insert(two.end(), {one, 0xFE});
    EXPECT_EQ(seen_in(two).change(), stream_change::none) << byte;
  }
}

// A wall at 643.25 mm all around: each sample is 0D 0A.
TEST(ChangeSigns, NoFalseAlarmWhereEachSampleIsALineEnd) {
  byte_list all;
  std::mt19937 random(3);
  for (int packet = 0; packet < 400; ++packet) {
    const auto some = static_cast<unsigned>(random());
    const auto byte = [&](unsigned at) {
      return static_cast<std::uint8_t>((some >> at) % 256 | 1);
    };
    all.insert(all.end(),
               {0xAA, 0x55, 0x00, 0x28, byte(0), 0x20, byte(8), 0x30, byte(16), byte(24)});
    for (int i = 0; i < 40; ++i) all.insert(all.end(), {0x0D, 0x0A});
  }
  EXPECT_EQ(seen_in(all).change(), stream_change::none);
}

}  // namespace
}  // namespace g4lidar::test
