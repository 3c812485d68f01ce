// SPDX-License-Identifier: MIT
// Each option about the source, with each verb that has it and each kind of source: it is used where the documents
// state so, and refused elsewhere, with the advice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "program.hpp"
#include "support/family_reference.hpp"

namespace {

using cli::outcome;
using cli::run;
using ::testing::HasSubstr;
using words = std::vector<std::string>;

/// What can use an option, a letter each: p a port, t a network bridge, s a simulated lidar, r a recording, b a file of
/// raw bytes, - standard input.
struct option_case {
  words given;
  std::string_view users;
};

const option_case on_loss{{"--on-loss", "reconnect"}, "pts"};
const option_case ends{{"--on-loss", "exit"}, "pts"};
const option_case baud{{"--baud", "115200"}, "pts"};
const option_case model{{"--model", "g4"}, "ptsrb-"};
const option_case certain{{"--model", "g4!"}, "ptsrb-"};
const option_case listen{{"--listen"}, "pts"};
const option_case leave{{"--leave-dtr"}, "pts"};
const option_case all_ports{{"--all-ports"}, "p"};
const option_case sample_rate{{"--sample-rate", "8000"}, "b-"};
const option_case loop{{"--loop"}, "rb"};
const option_case speed{{"--playback-speed", "2"}, "rb"};

/// A verb, the arguments that let it end soon, its options, and the kinds of source that it reads.
struct verb_case {
  std::string_view name;
  words more;
  std::vector<option_case> options;
  std::string_view reads;
};
void PrintTo(const verb_case& of, std::ostream* out) { *out << of.name; }

std::vector<option_case> device_options(std::vector<option_case> more = {}) {
  more.insert(more.end(), {on_loss, ends, baud, model, certain, listen, leave, all_ports});
  return more;
}

const std::vector<verb_case>& all_verbs() {
  static const std::vector<verb_case> all{
      {"dump", {"-n", "1"}, device_options({sample_rate}), "ptsrb-"},
      {"scan", {"-n", "1"}, device_options({sample_rate}), "ptsrb-"},
      {"record", {"-n", "1", "--force", "-o", "OUT"}, device_options({sample_rate}), "ptsrb-"},
      {"stats", {"-n", "1"}, device_options(), "ptsrb"},
      {"packets", {"-n", "1"}, device_options(), "ptsrb-"},
      {"view", {"--once"}, device_options({sample_rate, loop}), "ptsrb"},
      {"info", {}, device_options(), "ptsr"},
      {"health", {}, device_options(), "pts"},
      {"start", {}, device_options(), "pts"},
      {"stop", {}, device_options(), "pts"},
      {"restart", {}, device_options(), "pts"},
      {"set", {"frequency=7"}, device_options(), "pts"},
      {"doctor", {"-d", "1s"}, {baud, model, all_ports}, "ptsrb"},
      {"acceptance", {"--alone", "--force", "--file", "OUT"}, {baud, model, all_ports}, "pts"},
      {"decode", {"-n", "1"}, {model, sample_rate}, "rb-"},
      {"replay", {"-n", "1"}, {model, loop, speed}, "r"},
  };
  return all;
}

class SourceOptions : public cli::scratch {
 protected:
  SourceOptions() {
    cli::write_file(raw_, input_);
    EXPECT_EQ(run({"convert", raw_, recording_}).code, 0);
  }
  /// No lidar is needed: an option that is used is accepted before nothing is found.
  [[nodiscard]] std::string source_of(char kind) const {
    switch (kind) {
      case 'p':
        return path("nothing");
      case 't':
        return "tcp:127.0.0.1:9";
      case 's':
        return "sim:?world=" + path("nothing");
      case 'r':
        return recording_;
      case 'b':
        return raw_;
      default:
        return "-";
    }
  }
  [[nodiscard]] outcome done(const verb_case& verb, const words& given, char kind) const {
    words line{std::string(verb.name), source_of(kind)};
    line.insert(line.end(), verb.more.begin(), verb.more.end());
    line.insert(line.end(), given.begin(), given.end());
    std::ranges::replace(line, "OUT", path("out.mcap"));
    return run(line, kind == '-' ? input_ : "");
  }

  std::string recording_ = path("walk.mcap");
  std::string raw_ = path("walk.bin");
  std::string input_ = run({"sim", "--seconds", "2"}).out;
};

class SourceOptionsOf : public SourceOptions, public testing::WithParamInterface<verb_case> {};

TEST_P(SourceOptionsOf, AreUsedOrRefused) {
  const verb_case& verb = GetParam();
  for (const char kind : verb.reads) {
    for (const option_case& each : verb.options) {
      const outcome found = done(verb, each.given, kind);
      const std::string what = std::string(1, kind) + " " + each.given.front();
      const bool is_used = each.users.find(kind) != std::string_view::npos;
      const std::string omit =
          each.given.front() == "--model" ? "--model MODEL!" : each.given.front();
      const bool is_refused =
          found.code == 2 && found.out.empty() &&
          found.err.find(omit + ", and ") != std::string::npos &&
          found.err.find("the source cannot use this option. Omit the option") != std::string::npos;
      EXPECT_EQ(is_refused, !is_used) << what << ": " << found.code << ' ' << found.err;
      const bool is_file = kind == 'r' || kind == 'b' || kind == '-';
      EXPECT_TRUE(!is_used || !is_file || found.code == 0) << what << ": " << found.err;
      EXPECT_TRUE(is_used || !std::filesystem::exists(path("out.mcap"))) << what;
      std::filesystem::remove(path("out.mcap"));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Verb, SourceOptionsOf, testing::ValuesIn(all_verbs()),
                         [](const auto& of) { return std::string(of.param.name); });

// Where a verb only prints what is in a file, an offset has no effect.
TEST_F(SourceOptions, AnOffsetOfZero_IsRefusedWhereNothingIsTurned) {
  const auto sample = [](unsigned, unsigned, unsigned) { return reference::wire_sample{0, 1000}; };
  const auto tg = reference::revolutions_of(reference::wire_format_of("tg15"), 6, 30, 1, sample);
  cli::write_file(raw_, std::string(tg.data.begin(), tg.data.end()));
  std::filesystem::remove(recording_);
  ASSERT_EQ(run({"convert", raw_, recording_, "--model", "tg15"}).code, 0);
  for (const words& line :
       {words{"packets", raw_, "--model", "tg15"}, {"packets", recording_}, {"info", recording_}}) {
    EXPECT_EQ(run(line).code, 0);
    words turned = line;
    turned.insert(turned.end(), {"--zero-angle", "90"});
    const outcome found = run(turned);
    EXPECT_EQ(found.code, 2) << line.front();
    EXPECT_THAT(found.err, HasSubstr("it is for g4-dump dump, scan and convert"));
  }
}

}  // namespace
