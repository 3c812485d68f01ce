// SPDX-License-Identifier: MIT
// Lidars of owners that differ from the table: each is read, and a warning states what was seen.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "program.hpp"
#include "simulator.hpp"

namespace {

using cli::outcome;
using cli::run;
using cli::simulator;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class OwnersLidar : public cli::scratch {
 protected:
  void serve(const std::vector<std::string>& options) {
    served_.reset();
    served_ = std::make_unique<simulator>(port_, options);
  }
  const std::string port_ = path("lidar");
  std::unique_ptr<simulator> served_;
};

TEST_F(OwnersLidar, OfWhichOnlyTheDataWireIsConnected_IsRead) {
  serve({"--model", "t-mini-plus", "--fault", "scanning", "--fault", "deaf"});
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{}, {"--model", "t-mini-plus"}, {"--listen"}}) {
    std::vector<std::string> words{"scan", "-n", "2", port_};
    words.insert(words.end(), options.begin(), options.end());
    const outcome done = run(words);
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.out, HasSubstr("whole"));
    // What is only listened to was not asked.
    const bool is_asked = options != std::vector<std::string>{"--listen"};
    EXPECT_EQ(done.err.find("answers no command") != std::string::npos, is_asked) << done.err;
  }
}

TEST_F(OwnersLidar, ThatIsOnlyListenedTo_GetsNoCommandOfAnyVerb) {
  const std::string source = "sim:?model=g4&fault=scanning";
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"set", source, "frequency=8"},
                                             {"start", source},
                                             {"stop", source},
                                             {"restart", source}}) {
    std::vector<std::string> more = words;
    more.emplace_back("--listen");
    const outcome done = run(more);
    EXPECT_EQ(done.code, 2) << words.front() << done.err;
    EXPECT_THAT(done.err, HasSubstr("--listen: nothing is sent")) << words.front();
  }
  const outcome health = run({"health", source, "--listen"});
  EXPECT_EQ(health.code, 0) << health.err;
  EXPECT_THAT(health.out, HasSubstr("unknown"));
  const outcome info = run({"info", source, "--listen"});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("frequency   unknown (only listened to)"));
}

TEST_F(OwnersLidar, ThatAnswersNothing_HasNotStopped) {
  serve({"--model", "t-mini-plus", "--fault", "scanning", "--fault", "deaf"});
  const outcome stop = run({"stop", port_});
  EXPECT_THAT(stop.err, HasSubstr("cannot be stopped"));
  EXPECT_THAT(stop.err, testing::Not(HasSubstr("was not scanning")));
  const outcome set = run({"set", port_, "frequency=8"});
  EXPECT_THAT(set.err, HasSubstr("answers nothing"));
  EXPECT_THAT(set.err, testing::Not(HasSubstr("no such command")));
}

TEST_F(OwnersLidar, DoctorListens_AndWritesNothing) {
  serve({"--model", "t-mini-plus", "--fault", "scanning"});
  const outcome done = run({"doctor", "--listen", "-d", "500ms", port_});
  EXPECT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(done.out, HasSubstr("the lidar was only listened to"));
  EXPECT_THAT(done.out, Not(HasSubstr("answers_missing")));
  EXPECT_THAT(served_->log(), Not(HasSubstr(" A5 ")));  // as each command is logged
  serve({"--model", "g4"});
  const outcome waits = run({"doctor", "--listen", "-d", "500ms", port_});
  EXPECT_EQ(waits.code, 6) << waits.out;
  EXPECT_THAT(waits.out, HasSubstr("a lidar that waits for a command is silent"));
  EXPECT_THAT(served_->log(), Not(HasSubstr(" A5 ")));
}

TEST_F(OwnersLidar, WhatContradictsTheModelStandsInItsRecording) {
  const std::string walk = path("walk.mcap");
  const std::string again = path("again.mcap");
  const std::string cut = path("cut.mcap");
  struct owners_lidar {
    std::vector<std::string> served;
    std::vector<std::string> options;
    std::string text;
    std::string model;
  };
  const std::vector<owners_lidar> all{
      {{"--model", "t-mini-plus-sh", "--device", "model_id=151"},
       {},
       "reports the number 151, that of a T-mini Plus. It is read as a T-mini Plus SH",
       "T-mini Plus SH"},
      {{"--model", "t-mini-plus", "--device", "model_id=153"},
       {},
       "153, which no known model has",
       "T-mini Pro"},  // the usual one with such samples
      {{"--model", "g4"}, {"--model", "g5!"}, "reports the number 5, that of a G4", "G5"},
      {{"--model", "s2-intensity", "--device", "baud=153600"},
       {"--model", "s2-intensity"},
       "runs at 153600 baud",
       "S2 with intensity"},
      {{"--model", "x4", "--device", "baud=115200"}, {}, "runs at 115200 baud", "X4"},
      {{"--model", "t-mini-plus", "--fault", "scanning", "--fault", "deaf"},
       {},
       "answers no command",
       ""}};
  for (const owners_lidar& each : all) {
    serve(each.served);
    std::vector<std::string> words{"record", "-n", "8", "--force", "-o", walk, port_};
    words.insert(words.end(), each.options.begin(), each.options.end());
    const outcome recorded = run(words);
    ASSERT_EQ(recorded.code, 0) << each.text << recorded.err;
    ASSERT_EQ(run({"record", walk, "--force", "-o", again}).code, 0) << each.text;
    // As after a power failure: without its end.
    std::filesystem::copy_file(walk, cut, std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(cut, std::filesystem::file_size(walk) * 9 / 10);
    for (const std::string& file : {walk, again, cut}) {
      const outcome info = run({"info", file});
      EXPECT_THAT(info.err, HasSubstr(each.text)) << file;
      EXPECT_THAT(info.out, HasSubstr("model       " + each.model)) << file;
      EXPECT_THAT(run({"info", "--json", file}).out, HasSubstr(each.text)) << file;
    }
    for (const char* const verb : {"scan", "decode", "replay"}) {
      const outcome played = run({verb, walk});
      EXPECT_EQ(played.code, 0) << played.err;
      EXPECT_THAT(played.err, HasSubstr(each.text)) << verb;
      EXPECT_THAT(played.err, Not(HasSubstr("until its packets"))) << verb;
      EXPECT_EQ(run({verb, cut}).code, 0) << verb;
    }
    for (const std::string& file : {walk, again}) {
      EXPECT_EQ(run({"replay", "--verify", file}).code, 0) << each.text;
    }
    const outcome examined = run({"doctor", "--json", walk});
    EXPECT_THAT(examined.out, Not(HasSubstr("other_device")));
    EXPECT_THAT(examined.out, HasSubstr(each.text));
  }
  ASSERT_EQ(run({"record", "-n", "3", "sim:", "--force", "-o", walk}).code, 0);
  EXPECT_THAT(run({"info", "--json", walk}).out, HasSubstr(R"("contradictions":"")"));
  // The number is in the raw bytes.
  const std::string raw = path("raw.bin");
  ASSERT_EQ(run({"sim", "--model", "g4", "--seconds", "3", "-o", path("g4.bin")}).code, 0);
  std::ofstream(raw, std::ios::binary)
      << std::string("\xA5\x5A\x14\0\0\0\x04\x96\x02\x03\x03", 11) + std::string(16, '\1')
      << std::ifstream(path("g4.bin"), std::ios::binary).rdbuf();
  ASSERT_EQ(run({"convert", "--model", "g4", raw, again, "--force"}).code, 0);
  EXPECT_THAT(run({"info", "--json", again}).out, HasSubstr("reports the number 150"));
}

/// Its bytes did not name its model: who knows it names it when the recording is read.
TEST_F(OwnersLidar, AGuessedModelOfARecordingMayBeNamedLater) {
  struct guessed {
    std::vector<std::string> served;
    const char* usual;
    const char* right;
    const char* wrong;  // another size of samples
    const char* name;
    const char* not_read_as;
  };
  const std::vector<guessed> all{{{"--model", "x3"}, "x2", "x3", "t-mini!", "X3", "read as X2"},
                                 {{"--model", "t-mini-plus", "--device", "model_id=153"},
                                  "t-mini-pro",
                                  "t-mini-plus",
                                  "g4!",
                                  "T-mini Plus",
                                  "read as a T-mini Pro"}};
  const std::string walk = path("walk.mcap");
  for (const guessed& each : all) {
    SCOPED_TRACE(each.right);
    serve(each.served);
    ASSERT_EQ(run({"record", "-n", "8", "--force", "-o", walk, port_}).code, 0);
    EXPECT_THAT(run({"info", "--json", walk}).out,
                AllOf(HasSubstr(std::string(R"("model":")") + each.usual),
                      HasSubstr(std::string("\"") + each.right + "\"")));
    const outcome info = run({"info", "--model", each.right, walk});
    EXPECT_EQ(info.code, 0) << info.err;
    EXPECT_THAT(info.out, HasSubstr(std::string("model       ") + each.name + "\n"));
    EXPECT_THAT(run({"doctor", "--json", "--model", each.right, walk}).out,
                Not(HasSubstr(each.not_read_as)));
    for (const char* const verb : {"scan", "decode", "replay"}) {
      const outcome done = run({verb, "--model", each.right, walk});
      EXPECT_EQ(done.code, 0) << verb << done.err;
      EXPECT_THAT(done.out + done.err, Not(HasSubstr(each.not_read_as))) << verb;
      const outcome wrong = run({verb, "--model", each.wrong, walk});
      EXPECT_EQ(wrong.code, 7) << verb << wrong.err;
      EXPECT_THAT(wrong.err, HasSubstr("bytes, not of")) << verb;
    }
    const std::string again = path("again.mcap");
    ASSERT_EQ(run({"record", walk, "--model", each.right, "--force", "-o", again}).code, 0);
    EXPECT_THAT(run({"info", again}).out, HasSubstr(std::string("model       ") + each.name));
    for (const std::string& file : {walk, again}) {
      EXPECT_EQ(run({"replay", "--verify", file}).code, 0) << file;
    }
  }
  ASSERT_EQ(run({"record", "-n", "3", "sim:", "--force", "-o", walk}).code, 0);
  const outcome refused = run({"scan", "--model", "g5", walk});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("g5!, or insist_on_model, reads it all the same"));
  const outcome insists = run({"scan", "--model", "g5!", walk});
  EXPECT_EQ(insists.code, 0);
  EXPECT_THAT(insists.err, HasSubstr("the number 5, that of a G4. It is read as a G5"));
}

TEST_F(OwnersLidar, BytesOfAFileThatAreNoPackets_AreNamedByEachVerb) {
  cli::write_file(path("x4.hex"), "AA 55 00 28 01 02 03 04 05 06 07 08\nAA 55 00 28 05 06 07 08\n");
  using words = std::vector<std::string>;
  for (const words& line : {words{"decode"},
                            {"dump"},
                            {"scan"},
                            {"record", "-o", path("a.mcap")},
                            {"convert", path("x4.hex"), path("b.mcap")}}) {
    words all = line;
    if (line[0] != "convert") all.push_back(path("x4.hex"));
    const outcome done = run(all);
    EXPECT_NE(done.code, 0) << line[0];
    EXPECT_THAT(done.err, HasSubstr("xxd -r -p")) << line[0];
  }
}

}  // namespace
