// SPDX-License-Identifier: MIT
// The verbs that query and command a device: info, health, set, start, stop, restart.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "program.hpp"
#include "recording.hpp"
#include "simulator.hpp"
#include "stubborn_device.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::run;
using nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class Talk : public cli::scratch {
 protected:
  [[nodiscard]] std::string port() const { return path("g4"); }
  /// What a verb with --json writes in its only line.
  [[nodiscard]] json ask(const std::string& verb) const {
    const outcome done = run({verb, port(), "--json"});
    EXPECT_EQ(done.code, 0) << done.err;
    return json::parse(done.out);
  }
};

// ---- info and health ---------------------------------------------------------------------------

TEST_F(Talk, Info_PrintsIdentityAndSettings) {
  const cli::simulator simulator(port(), {"--serial", "2023000000000017", "--sample-rate", "8000"});
  const outcome done = run({"info", port()});
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(done.err, "");
  EXPECT_THAT(lines_of(done.out),
              ElementsAre("source      " + port(), "model       G4", "serial      2023000000000017",
                          "firmware    3.2", "hardware    3", "sample_rate 8k", "frequency   7.0",
                          "direction   cw", "constant    unknown (a G4 cannot be asked for it)",
                          "idle        on", "protection  unknown (a G4 cannot be asked for it)"));
}

TEST_F(Talk, Info_AsJson) {
  const cli::simulator simulator(port());
  EXPECT_EQ(ask("info"), (json{{"source", port()},
                               {"model", 5},
                               {"serial", "2021101000070073"},
                               {"firmware", "3.2"},
                               {"hardware", 3},
                               {"lidar",
                                {{"model", "g4"},
                                 {"candidates", {"g4"}},
                                 {"known_by", "number"},
                                 {"contradictions", ""}}},
                               {"sample_rate", 9000},
                               {"frequency", 7.0},
                               {"direction", "cw"},
                               {"constant", nullptr},
                               {"idle", true},
                               {"protection", nullptr}}));
}

TEST_F(Talk, AskingVerbs_SetNothing) {
  cli::simulator simulator(port());
  for (const char* const verb : {"info", "health", "stop", "start", "stats"}) {
    std::vector<std::string> words{verb, port()};
    if (words[0] == "stats") words.insert(words.end(), {"-n", "1"});
    EXPECT_EQ(run(words).code, 0) << verb;
  }
  EXPECT_EQ(run({"dump", port(), "-n", "1"}).code, 0);
  EXPECT_EQ(run({"scan", port(), "-n", "1"}).code, 0);
  // Nothing but stop, start, and what only asks: 90, 91, 92, 05, 08, 0D, D1.
  const std::string log = simulator.log();
  EXPECT_THAT(log, HasSubstr(" A5 0D"));
  EXPECT_THAT(log, Not(ContainsRegex(" A5 (01|02|06|07|09|0A|0B|0C|0E|0F|40|80|D0|D9)")));
}

TEST_F(Talk, Health_PrintsTheStatus) {
  const outcome well = run({"health", "sim:"});
  EXPECT_EQ(well.code, 0);
  EXPECT_EQ(well.out, "status      ok\nerror_code  0\n");
  const outcome warned = run({"health", "sim:?fault=health=warning"});
  EXPECT_EQ(warned.code, 0);
  EXPECT_THAT(warned.out, HasSubstr("status      warning\n"));
  const outcome ill = run({"health", "sim:?fault=health=error", "--json"});
  EXPECT_EQ(ill.code, 8);
  EXPECT_EQ(json::parse(ill.out).at("status"), "error");
}

// ---- set ---------------------------------------------------------------------------------------

TEST_F(Talk, Set_RefusesWithTheLimitsOfTheModel) {
  const outcome g4 = run({"set", "sim:", "frequency=40"});
  EXPECT_EQ(g4.code, 2);
  EXPECT_THAT(g4.err, HasSubstr("frequency: '40' is not in the range 5 to 12 Hz of a G4"));
  const outcome tg = run({"set", "sim:?model=tg15", "frequency=2"});
  EXPECT_THAT(tg.err, HasSubstr("frequency: '2' is not in the range 3 to 16 Hz of a TG15"));
  for (const char* const change : {"frequency=40", "sample_rate=77k"})
    EXPECT_THAT(run({"set", "sim:?model=x4", change}).err,
                HasSubstr(": an X4 has no such setting"));
  const outcome named = run({"set", port(), "--model", "t-mini", "frequency=5"});
  EXPECT_THAT(named.err, HasSubstr("frequency: '5' is not in the range 6 to 12 Hz of a T-mini"));
}

TEST_F(Talk, Set_ShowsEachBeforeAndAfter) {
  const cli::simulator simulator(port());
  const outcome done = run({"set", port(), "sample_rate=4k", "frequency=9.5", "direction=ccw",
                            "constant=off", "idle=off", "protection=on"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(lines_of(done.out),
              ElementsAre("NAME        BEFORE   AFTER", "sample_rate 9k       4k",
                          "frequency   7.0      9.5", "direction   cw       ccw",
                          "constant    unknown  off", "idle        on       off",
                          "protection  unknown  on"));
  EXPECT_THAT(done.err, HasSubstr("may be lost when"));
  EXPECT_THAT(done.err, HasSubstr("stops 3 s after"));
  const json after = ask("info");
  EXPECT_EQ(after.at("sample_rate"), 4000);
  EXPECT_EQ(after.at("frequency"), 9.5);
  EXPECT_EQ(after.at("direction"), "ccw");
  EXPECT_EQ(after.at("idle"), false);
}

TEST_F(Talk, Set_AsJson) {
  const cli::simulator simulator(port());
  const outcome done = run({"set", port(), "--json", "-q", "sample_rate=8000", "protection=off"});
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(done.err, "");
  const std::vector<std::string> lines = lines_of(done.out);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(json::parse(lines[0]),
            (json{{"name", "sample_rate"}, {"before", 9000}, {"wanted", 8000}, {"after", 8000}}));
  EXPECT_EQ(
      json::parse(lines[1]),
      (json{{"name", "protection"}, {"before", nullptr}, {"wanted", false}, {"after", false}}));
}

TEST_F(Talk, Set_InvalidWord_SetsNothing) {
  cli::simulator simulator(port());
  for (const char* const word : {"sample_rate=10k", "frequency=4.9", "frequency=12.1",
                                 "frequency=nan", "frequency=7.55", "frequency=", "direction=left",
                                 "constant=1", "speed=3", "sample_rate=9k", "/dev/ttyUSB0"}) {
    const outcome done = run({"set", port(), "sample_rate=8k", word});
    EXPECT_EQ(done.code, 2) << word;
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.err, HasSubstr("See: g4-dump set --help"));
  }
  EXPECT_EQ(run({"set", port()}).code, 2);
  EXPECT_EQ(run({"set"}).code, 2);
  const std::string log = simulator.log();
  for (const char* const changing : {" A5 D0", " A5 09", " A5 0A", " A5 0B", " A5 0C"}) {
    EXPECT_THAT(log, Not(HasSubstr(changing)));
  }
}

TEST_F(Talk, Set_RefusedSetting_IsShownAndEndsIt) {
  const cli::stubborn_device device;
  const outcome done =
      run({"set", device.path(), "sample_rate=9k", "frequency=9", "sample_rate=9k"});
  EXPECT_EQ(done.code, 2) << "given twice";
  const outcome refused =
      run({"set", device.path(), "sample_rate=9k", "frequency=9", "direction=cw"});
  EXPECT_EQ(refused.code, 8) << refused.err;
  EXPECT_THAT(lines_of(refused.out),
              ElementsAre("NAME        BEFORE   AFTER", "sample_rate 9k       9k",
                          "frequency   7.0      7.0"));
  EXPECT_THAT(refused.err, HasSubstr("does not accept this value"));
  const outcome json_error = run({"set", device.path(), "frequency=9", "--json", "--json-errors"});
  EXPECT_EQ(json_error.code, 8);
  EXPECT_EQ(json::parse(json_error.out).at("after"), 7.0);
  EXPECT_EQ(json::parse(json_error.err).at("problem"), "not_reached");
  EXPECT_EQ(json::parse(json_error.err).at("exit_code"), 8);
}

TEST_F(Talk, Info_MissingAnswer_IsUnknown) {
  const cli::stubborn_device device;
  const outcome done = run({"info", device.path()});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("sample_rate 9k\n"));
  EXPECT_THAT(done.out, HasSubstr("direction   unknown (no answer)\n"));
  EXPECT_THAT(done.out, HasSubstr("idle        unknown (no answer)\n"));
}

// ---- start, stop, restart ----------------------------------------------------------------------

TEST_F(Talk, Start_LeavesItScanningAndStopStopsIt) {
  cli::simulator simulator(port());
  EXPECT_THAT(run({"start", port()}).err, HasSubstr(": scanning\n"));
  const outcome stopped = run({"stop", port()});
  EXPECT_EQ(stopped.code, 0);
  EXPECT_EQ(stopped.out, "");
  EXPECT_THAT(stopped.err, HasSubstr(": was scanning and has been stopped\n"));
  EXPECT_THAT(run({"stop", port()}).err, HasSubstr("it was not scanning"));
}

TEST_F(Talk, ScanningDevice_IsStoppedAndReported) {
  const cli::simulator simulator(port());
  for (const char* const verb : {"info", "health", "start", "restart"}) {
    EXPECT_EQ(run({"start", port()}).code, 0);
    const outcome done = run({verb, port()});
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.err, HasSubstr(": was scanning and has been stopped\n")) << verb;
  }
  EXPECT_EQ(run({"start", port()}).code, 0);
  EXPECT_THAT(run({"set", port(), "sample_rate=8k"}).err,
              HasSubstr(": was scanning and has been stopped\n"));
}

TEST_F(Talk, Start_OfADeviceThatCannot_IsAnError) {
  for (const auto& [fault, why] : {std::pair{"brown_out", "too little power"},
                                   {"health=error", "reports that it is defective"}}) {
    const outcome done = run({"start", std::string("sim:?fault=") + fault});
    EXPECT_EQ(done.code, 8);
    EXPECT_THAT(done.err, HasSubstr(why));
  }
}

TEST_F(Talk, Restart_WaitsUntilItAnswersAgain) {
  const cli::simulator simulator(port());
  EXPECT_EQ(run({"set", port(), "sample_rate=4k"}).code, 0);
  const outcome done = run({"restart", port()});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.err, HasSubstr("restarted; it answered after"));
  EXPECT_EQ(ask("info").at("sample_rate"), 9000) << "this one forgets";
}

// ---- what can go wrong with all of them ---------------------------------------------------------

TEST_F(Talk, ExitCodes) {
  cli::write_file(path("bytes.bin"), cli::zero(0) + cli::turn());
  for (const std::vector<std::string>& verb : {std::vector<std::string>{"info"},
                                               {"health"},
                                               {"set", "sample_rate=9k"},
                                               {"start"},
                                               {"stop"},
                                               {"restart"}}) {
    const auto code_for = [&verb](const std::string& source) {
      std::vector<std::string> words = verb;
      words.insert(words.begin() + 1, source);
      const outcome done = run(words);
      EXPECT_THAT(done.err, HasSubstr("g4-dump: ")) << verb[0];
      return done.code;
    };
    EXPECT_EQ(code_for(path("none")), 3) << verb[0];
    EXPECT_EQ(code_for(path("bytes.bin")), 10) << verb[0];
    EXPECT_EQ(code_for("-"), 10) << verb[0];
    EXPECT_EQ(code_for("sim:?fault=rust"), 2) << verb[0];
  }
  EXPECT_EQ(run({"info", "sim:?fault=mute"}).code, 6);
  EXPECT_EQ(run({"info", "sim:?fault=baud"}).code, 6);
  EXPECT_THAT(run({"stop", "sim:?fault=scanning&fault=deaf"}).err,  // as one at a port
              HasSubstr("it answers no command: its scan cannot be stopped"));
}

TEST_F(Talk, PortOfAnotherProgram_IsBusy) {
  const cli::simulator simulator(port());
  cli::program dump({"dump", port()});
  dump.read_until("\n");
  const outcome done = run({"info", port()});
  EXPECT_EQ(done.code, 5) << done.err;
  EXPECT_THAT(done.err, HasSubstr("g4-dump ("));
  dump.send(SIGINT);
  EXPECT_EQ(dump.wait().code, 130);
}

// ---- stats -------------------------------------------------------------------------------------

TEST_F(Talk, Stats_CountsReceivedData) {
  const outcome done = run({"stats", "sim:", "-n", "3", "--json"});
  EXPECT_EQ(done.code, 0) << done.err;
  const json counts = json::parse(done.out);
  EXPECT_EQ(counts.at("scans"), 3);
  EXPECT_GT(counts.at("points"), 3000);
  EXPECT_GT(counts.at("bytes"), 6000);
  EXPECT_EQ(counts.at("suspect"), 0);
  EXPECT_EQ(counts.at("skipped").at("bad_checksum"), 0);
  const outcome words = run({"stats", "sim:", "-n", "1"});
  EXPECT_EQ(words.code, 0);
  EXPECT_THAT(words.out, HasSubstr("scans                 1\n"));
  EXPECT_THAT(words.out, ContainsRegex("skipped_noise +[0-9]+\n"));
}

TEST_F(Talk, Stats_OfAFile) {
  cli::write_file(path("bytes.bin"), cli::zero(0) + cli::turn() + cli::zero(0) + "noise");
  const outcome done = run({"stats", path("bytes.bin"), "--json"});
  EXPECT_EQ(done.code, 0) << done.err;
  const json counts = json::parse(done.out);
  EXPECT_EQ(counts.at("packets"), 11);
  EXPECT_EQ(counts.at("points"), 362);
  EXPECT_EQ(counts.at("skipped").at("noise"), 5);
  EXPECT_EQ(run({"stats", "-"}).code, 2);
}

TEST_F(Talk, Stats_Watch_ALineEachInterval) {
  const outcome done = run({"stats", "sim:", "--watch", "200ms", "-n", "3", "--json"});
  EXPECT_EQ(done.code, 0) << done.err;
  const std::vector<std::string> lines = lines_of(done.out);
  ASSERT_EQ(lines.size(), 3U);
  std::uint64_t before = 0;
  for (const std::string& line : lines) {
    const json counts = json::parse(line);
    EXPECT_GT(counts.at("bytes"), before);
    before = counts.at("bytes");
  }
  const outcome table = run({"stats", "sim:", "--watch", "100ms", "-d", "350ms"});
  ASSERT_GE(lines_of(table.out).size(), 2U);
  EXPECT_THAT(lines_of(table.out)[0], HasSubstr("SECONDS POINTS/S  SCANS/S"));
}

TEST_F(Talk, Stats_Watch_EndsWithTheSignal) {
  cli::program watch({"stats", "sim:", "--watch", "50ms"});
  watch.read_until("RECONNECTS\n");
  watch.read_until("0\n");
  watch.send(SIGINT);
  EXPECT_EQ(watch.wait().code, 130);
}

// ---- help --------------------------------------------------------------------------------------

TEST(TalkHelp, FitsAndNamesWhatIsWritten) {
  for (const char* const verb : {"info", "health", "stats", "set", "start", "stop", "restart"}) {
    const outcome done = run({verb, "--help"});
    EXPECT_EQ(done.code, 0);
    EXPECT_THAT(done.out, HasSubstr(std::string("Examples:\n  g4-dump ") + verb));
    EXPECT_THAT(done.out, HasSubstr("Exit codes:"));
    for (const std::string& line : lines_of(done.out)) EXPECT_LE(line.size(), 100U) << line;
  }
  const std::string set = run({"set", "--help"}).out;
  for (const char* const name :
       {"sample_rate=", "frequency=", "direction=", "constant=", "idle=", "protection="}) {
    EXPECT_THAT(set, HasSubstr(name));
  }
  const std::string stats = run({"stats", "--help"}).out;
  const json keys = json::parse(run({"stats", "sim:", "-n", "1", "--json"}).out);
  for (const auto& [name, value] : keys.items()) EXPECT_THAT(stats, HasSubstr(name));
}

}  // namespace
