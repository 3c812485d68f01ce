// SPDX-License-Identifier: MIT
// How g4-serve ends WebSockets whose frames are wrong.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "server.hpp"

namespace {

using serve::raw_client;

class Frames : public serve::Server {};

// RFC 6455, 7.4.1: 1002 is a violation of the protocol, 1003 a kind of data that is not taken, 1007 a text that is not
// UTF-8, 1009 a message that is too long.
TEST_F(Frames, BadOnes_EndWithTheCode) {
  begin();
  const std::string half = std::string("\x01\x81", 2) + std::string(4, '\0') + '\xC3';
  const std::string unmasked = "\x81\x02{}";
  const std::string long_form = std::string("\x81\xFE\x00\x02", 4) + std::string(4, '\0') + "{}";
  for (const auto& [bytes, code] : std::vector<std::pair<std::string, int>>{
           {unmasked, 1002},
           {long_form, 1002},
           {raw_client::frame(3, "x"), 1002},
           {raw_client::frame(0, "x"), 1002},
           {raw_client::frame(9, std::string(126, 'p')), 1002},
           {raw_client::frame(1, "no json"), 1002},
           {raw_client::frame(2, "{}"), 1003},
           {raw_client::frame(1, "\xFF\xFF"), 1007},
           {raw_client::frame(1, "\xED\xA0\x80"), 1007},
           {half + raw_client::frame(0, "x"), 1007},
           {raw_client::frame(1, std::string(20'000, ' ')), 1009},
           {raw_client::frame(1, "", std::uint64_t{1} << 62U), 1009},
           {raw_client::frame(8, "\x03\xE8"), 1000}}) {
    const auto bad = open_page();
    bad->send(bytes);
    // What the server sends before its end is at most a few scans and texts.
    std::string last;
    while (const auto frame = bad->next_frame()) last = *frame;
    ASSERT_GE(last.size(), 2U) << code;
    const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(last[at]); };
    EXPECT_EQ(byte(0) << 8U | byte(1), code) << last;
  }
}

}  // namespace
