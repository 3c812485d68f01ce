// SPDX-License-Identifier: MIT
// Dialogues with a session as text: the events of device and time, and the actions of the session.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "g4lidar/core/session.hpp"
#include "support/packet_bytes.hpp"

namespace g4lidar::test {

inline constexpr std::int64_t ms = 1'000'000;

// ---- events ------------------------------------------------------------------------------------
inline constexpr std::array<std::uint8_t, 12> one_packet{0xAA, 0x55, 0x01, 0x01, 0x53, 0xAE,
                                                         0x53, 0xAE, 0xAB, 0x54, 0x00, 0x00};

/// Passes `response`, a complete response, to `to`.
constexpr void take_reply(auto& to, bytes response, std::int64_t now_ns) {
  to.take(event(*response_view::from(response)), now_ns);
}
constexpr void take_packet(auto& to, std::int64_t now_ns) {
  to.take(event(*packet_view::from(one_packet)), now_ns);
}
constexpr void take_noise(auto& to, std::int64_t now_ns) {
  to.take(event(skipped{3, skip_reason::noise}), now_ns);
}

inline buffer header_reply() { return {0xA5, 0x5A, 0x05, 0, 0, 0x40, 0x81}; }
inline buffer info_reply() {
  return {0xA5, 0x5A, 0x14, 0, 0, 0, 4, 5, 2, 3, 3, 2, 0, 2, 1, 1, 0, 1, 0, 0, 0, 0, 7, 0, 0, 7, 3};
}
inline buffer health_reply(unsigned status) {
  return {0xA5, 0x5A, 3, 0, 0, 0, 6, static_cast<std::uint8_t>(status), 0, 0};
}
inline buffer byte_reply(unsigned value) {
  return {0xA5, 0x5A, 1, 0, 0, 0, 4, static_cast<std::uint8_t>(value)};
}
inline buffer frequency_reply(unsigned chz) {
  buffer out{0xA5, 0x5A, 4, 0, 0, 0, 4};
  append_u16(out, chz);
  append_u16(out, 0);
  return out;
}

// ---- words -------------------------------------------------------------------------------------
[[nodiscard]] inline std::string word_for(verdict how) {
  switch (how) {
    case verdict::answered:
      return "answered";
    case verdict::not_reached:
      return "not_reached";
    case verdict::timed_out:
      return "timed_out";
    case verdict::still_scanning:
      return "still_scanning";
  }
  return "?";
}
[[nodiscard]] inline std::string word_for(refusal why) {
  switch (why) {
    case refusal::busy:
      return "busy";
    case refusal::scanning:
      return "scanning";
    case refusal::bad_setting:
      return "bad_setting";
    case refusal::not_supported:
      return "not_supported";
  }
  return "?";
}
[[nodiscard]] inline std::string word_for(notice what) {
  switch (what) {
    case notice::none:
      return "none";
    case notice::found_scanning:
      return "found_scanning";
    case notice::protection_starved:
      return "protection_starved";
    case notice::protection_found_on:
      return "protection_found_on";
    case notice::spinning_up:
      return "spinning_up";
    case notice::restarted:
      return "restarted";
    case notice::stalled:
      return "stalled";
  }
  return "?";
}
/// The number in an answer: a setting's byte, an angle, a frequency, a health's status; nothing for the
/// others.
[[nodiscard]] inline std::string word_for(const answer& value) {
  return std::visit(
      [](const auto& held) -> std::string {
        using held_type = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<held_type, std::monostate>) {
          return "";
        } else if constexpr (std::is_same_v<held_type, device_information>) {
          return ":" + std::string(held.serial_number());
        } else if constexpr (std::is_same_v<held_type, health>) {
          return ":" + std::to_string(static_cast<int>(held.status));
        } else if constexpr (std::is_same_v<held_type, scan_frequency>) {
          return ":" + std::to_string(held.chz);
        } else if constexpr (std::is_same_v<held_type, sample_rate>) {
          return ":" + std::to_string(code_of_rate(g4_model, to_hz(held)));
        } else if constexpr (std::is_same_v<held_type, zero_angle> ||
                             std::is_same_v<held_type, pitch_angle>) {
          return ":" + std::to_string(held.cdeg);
        } else {
          return ":" + std::to_string(static_cast<int>(held));
        }
      },
      value);
}

// ---- dialogues ---------------------------------------------------------------------------------
/// A session and its clock. play() takes a text of words:
///
///     in    <info <health:N <byte:N <freq:N <header <packet <noise   comes 1 ms after the last word
///           wait        time passes until look() is due, and look() is called
///           late        the same, 10 s after that
///           +N          N ms pass, with all calls of look() that are due
///     out   >xx         the command byte that it sends
///           !word       an event
///           =word:N     an outcome, and the number in its answer
///
/// and returns the text of what happened: the same text, if all outputs occur.
class played {
 public:
  explicit played(const session_times& times = {}) : talk(times) {}

  /// The dialogue that begins with a request.
  std::string ask(const request& wanted, std::string_view script,
                  while_scanning how = while_scanning::refuse) {
    out_.clear();
    const auto refused = talk.begin(wanted, now_ns, how);
    if (refused) add(word_for(*refused));
    collect();
    return go_on(script);
  }
  std::string play(std::string_view script) {
    out_.clear();
    return go_on(script);
  }

  session talk;
  outcome last{};
  std::int64_t now_ns = 1'000'000 * ms;

 private:
  std::string go_on(std::string_view script) {
    std::istringstream words{std::string(script)};
    std::string word;
    while (words >> word) {
      if (word[0] == '>' || word[0] == '!' || word[0] == '=') continue;
      if (word == "busy" || word == "scanning" || word == "bad_setting") continue;
      add(word);
      now_ns += ms;
      happen(word);
      collect();
    }
    return out_;
  }

  void happen(const std::string& word) {
    const auto number = [&] {
      return static_cast<unsigned>(std::stoul(word.substr(word.find(':') + 1)));
    };
    const auto begins = [&](std::string_view with) { return word.rfind(with, 0) == 0; };
    if (word == "wait" || word == "late") {
      now_ns = std::max(now_ns, talk.next_look_ns()) + (word == "late" ? 10'000 * ms : 0);
      talk.look(now_ns);
    } else if (word[0] == '+') {
      pass(std::stoll(word.substr(1)) * ms - ms);
    } else if (word == "<packet") {
      take_packet(talk, now_ns);
    } else if (word == "<noise") {
      take_noise(talk, now_ns);
    } else if (word == "<header") {
      take_reply(talk, header_reply(), now_ns);
    } else if (word == "<info") {
      take_reply(talk, info_reply(), now_ns);
    } else if (begins("<health:")) {
      take_reply(talk, health_reply(number()), now_ns);
    } else if (begins("<byte:")) {
      take_reply(talk, byte_reply(number()), now_ns);
    } else if (begins("<freq:")) {
      take_reply(talk, frequency_reply(number()), now_ns);
    } else {
      add("(what?)");
    }
  }

  void pass(std::int64_t ns) {
    const std::int64_t until = now_ns + ns;
    while (talk.next_look_ns() <= until) {
      now_ns = std::max(now_ns, talk.next_look_ns());
      talk.look(now_ns);
      collect();
    }
    now_ns = until;
  }

  void collect() {
    const std::size_t before = out_.size();
    const bool has_nothing = talk.has_nothing();
    while (const auto sent = talk.to_send()) {
      std::array<char, 8> text{};
      std::snprintf(text.data(), text.size(), ">%02X", static_cast<unsigned>((*sent)[1]));
      add(text.data());
    }
    if (const notice reported = talk.noticed(); reported != notice::none)
      add("!" + word_for(reported));
    if (const auto done = talk.finished()) {
      last = *done;
      add("=" + word_for(done->how) + word_for(done->value));
    }
    EXPECT_EQ(has_nothing, out_.size() == before);
  }

  void add(const std::string& word) {
    if (!out_.empty()) out_ += ' ';
    out_ += word;
  }

  std::string out_;
};

/// Compares a dialogue with its own text.
#define EXPECT_ASKED(bench, wanted, script) EXPECT_EQ((bench).ask(wanted, script), script)
#define EXPECT_PLAYED(bench, script) EXPECT_EQ((bench).play(script), script)

/// A session whose device is known to be idle, and whose link is known to be clear.
class session_requests : public ::testing::Test {
 protected:
  session_requests() {
    EXPECT_ASKED(bench, requests::device_info(),
                 ">00 >65 wait >90 <info =answered:2021101000070073");
  }
  played bench;
};

}  // namespace g4lidar::test
