// SPDX-License-Identifier: MIT
// g4-dump doctor as a person runs it, on pseudo-terminals: its words, its JSON, its exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "program.hpp"
#include "recorded.hpp"
#include "support/patience.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::program;
using cli::run;
using g4lidar::test::comes_true;
using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class Doctor : public cli::scratch {
 protected:
  /// The stages, as JSON, of a doctor that listens for half a second.
  static std::vector<json> stages_of(const outcome& done) {
    std::vector<json> stages;
    for (const std::string& line : lines_of(done.out)) stages.push_back(json::parse(line));
    return stages;
  }
  static std::vector<std::string> diagnoses_of(const std::vector<json>& stages) {
    std::vector<std::string> names;
    for (const json& stage : stages) {
      for (const json& each : stage.at("diagnoses")) names.push_back(each.at("name"));
    }
    return names;
  }
  static outcome examine(const std::string& source) {
    return run({"doctor", "--json", "-d", "500ms", source});
  }
  /// A simulated device for other processes.
  std::string serve() {
    const std::string link = path("g4");
    served_.emplace(std::vector<std::string>{"sim", "--link", link});
    EXPECT_TRUE(comes_true([&] { return std::filesystem::exists(link); }));
    return link;
  }

  std::optional<program> served_;
};

// A simulated lidar has no USB bridge. Stages that depend on times may report that the computer was busy.
TEST_F(Doctor, GoesThroughAllStages) {
  const outcome done = examine("sim:");
  const std::vector<json> stages = stages_of(done);
  ASSERT_EQ(stages.size(), 13U) << done.out << done.err;
  const std::vector<std::string> names{
      "port",  "permission", "holder", "baud_rate", "answers", "identity",   "health",
      "motor", "stream",     "rate",   "loss",      "returns", "usb_latency"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(stages[i].at("stage"), names[i]);
    if (names[i] == "usb_latency") {
      EXPECT_EQ(stages[i].at("verdict"), "skipped") << stages[i];
      EXPECT_THAT(stages[i].at("remark"), HasSubstr("no USB bridge"));
      continue;
    }
    const bool is_busy = stages[i].at("verdict") == "warn" &&
                         stages[i].at("diagnoses").size() == 1 &&
                         stages[i].at("diagnoses")[0].at("name") == "host_busy";
    EXPECT_TRUE(stages[i].at("verdict") == "ok" || is_busy) << stages[i];
  }
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(stages[5].at("evidence").at("serial_number"), "2021101000070073");
  EXPECT_EQ(stages[6].at("evidence").at("status"), "ok");
  EXPECT_EQ(stages[9].at("evidence").at("set_hz"), 7.0);
}

TEST_F(Doctor, ReportsAnotherModelThanTheNamedOne) {
  const auto named = [](const std::string& source, const std::string& word) {
    return run({"doctor", "-d", "500ms", source, "--model", word});
  };
  EXPECT_EQ(named("sim:?model=x4", "x4").code, 0);
  const outcome other = named("sim:", "x4");
  EXPECT_EQ(other.code, 7) << other.out;
  EXPECT_THAT(other.out, HasSubstr("The lidar is a G4 at 230400 baud, not an X4."));
  const outcome one_way = named("sim:?model=x4-pro", "x4");
  EXPECT_EQ(one_way.code, 7) << one_way.out;
  EXPECT_THAT(one_way.out, HasSubstr("found: one_way_lidar\n"));
  EXPECT_THAT(one_way.out, HasSubstr("x4-pro"));
  EXPECT_EQ(run({"doctor", "sim:", "--model", "x44"}).code, 2);
}

// A recording is examined without a device: what needs one is skipped.
TEST_F(Doctor, ExaminesARecording) {
  const std::string file = path("walk.mcap");
  cli::record_in_virtual_time(file, 20);
  const outcome done = examine(file);
  EXPECT_EQ(done.code, 0) << done.out << done.err;
  const std::vector<json> stages = stages_of(done);
  ASSERT_EQ(stages.size(), 13U) << done.out;
  const std::vector<std::string> verdicts{"ok",      "skipped", "skipped", "ok",
                                          "skipped", "ok",      "ok",      "ok"};
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    EXPECT_EQ(stages[i].at("verdict"), verdicts[i]) << stages[i];
  }
  EXPECT_EQ(stages[5].at("evidence").at("serial_number"), "2021101000070073");
  EXPECT_EQ(stages[10].at("verdict"), "ok") << stages[10];
  EXPECT_EQ(stages[10].at("evidence").at("samples_lost"), 0);
  EXPECT_THAT(stages[1].at("remark"), HasSubstr("needs a device"));
}

TEST_F(Doctor, ExaminesRawBytes) {
  using namespace std::string_literals;
  cli::write_file(path("one.bin"), "\xAA\x55\x01\x01\x53\xAE\x53\xAE\xAB\x54\x00\x00"s);
  const outcome one = examine(path("one.bin"));
  EXPECT_EQ(one.code, 0) << one.out << one.err;
  EXPECT_EQ(stages_of(one).at(3).at("evidence").at("packets"), 1);
  EXPECT_THAT(run({"doctor", path("one.bin")}).out,
              HasSubstr("no fault found, but these bytes do not name their model\n"));
  EXPECT_THAT(run({"doctor", "--model", "g5", path("one.bin")}).out,
              HasSubstr("no fault found; the bytes were read as G5\n"));
  cli::write_file(path("a_file"), "no bytes of a lidar");
  const outcome other = examine(path("a_file"));
  EXPECT_EQ(other.code, 7);
  EXPECT_THAT(diagnoses_of(stages_of(other)), Contains("no_lidar")) << other.out;
  EXPECT_THAT(other.out, HasSubstr("This is text, not the packets of a lidar."));
  const outcome none = examine("file:" + path("nothing"));
  EXPECT_EQ(none.code, 10);
  EXPECT_THAT(diagnoses_of(stages_of(none)), Contains("bad_file")) << none.out;
}

TEST_F(Doctor, PrintsWhatIsWrongAndWhatToTry) {
  const outcome done = run({"doctor", "-d", "500ms", "sim:?fault=health=error"});
  EXPECT_EQ(done.code, 8) << done.err;
  EXPECT_THAT(done.out, HasSubstr("health       FAIL health_error: "));
  EXPECT_THAT(done.out, HasSubstr("try: "));
  EXPECT_THAT(done.out, HasSubstr("found: health_error\n"));
}

TEST_F(Doctor, ReportsAnUnplug) {
  const outcome done = examine("sim:?fault=unplug@1s");
  EXPECT_EQ(done.code, 9) << done.out;
  EXPECT_THAT(diagnoses_of(stages_of(done)), Contains("unplugged")) << done.out;
}

TEST_F(Doctor, ReportsAPathThatIsNoPort) {
  const outcome missing = examine(path("nothing"));
  EXPECT_EQ(missing.code, 3);
  EXPECT_THAT(diagnoses_of(stages_of(missing)), Contains("no_port")) << missing.out;
  const std::string words = run({"doctor", path("nothing")}).out;
  EXPECT_EQ(words.find("Connect the lidar"), words.rfind("Connect the lidar")) << words;
  const outcome other = examine("/dev/null");
  EXPECT_EQ(other.code, 3);
  EXPECT_THAT(diagnoses_of(stages_of(other)), Contains("not_serial")) << other.out;
  EXPECT_EQ(run({"doctor", "-"}).code, 2);
}

/// The motor spins up while it is recorded, or there are only a few packets. No fault is found.
TEST_F(Doctor, AShortRecordingOfAHealthyLidar_HasNoFault) {
  for (const std::string word : {"g4", "x2", "x4", "t-mini-plus", "tg15"}) {
    for (const char* const scans : {"1", "3"}) {
      const std::string file = path(word + scans + ".mcap");
      const outcome done = run({"record", "-n", scans, "sim:?model=" + word, "-o", file});
      ASSERT_EQ(done.code, 0) << done.err;
      EXPECT_EQ(diagnoses_of(stages_of(run({"doctor", "--json", file}))),
                std::vector<std::string>{})
          << word << scans;
    }
  }
}

TEST_F(Doctor, ReportsMissingPermission) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may open everything";
  // A character device that only root may open is on every Linux.
  const outcome done = examine("/dev/mem");
  if (done.code == 3) GTEST_SKIP() << "there is no /dev/mem here";
  EXPECT_EQ(done.code, 4) << done.out;
}

TEST_F(Doctor, NamesTheProgramThatHasThePortOpen) {
  const std::string link = serve();
  program holder({"dump", link});
  holder.read_until("\n");
  const outcome done = examine(link);
  EXPECT_EQ(done.code, 5) << done.out;
  EXPECT_THAT(diagnoses_of(stages_of(done)), Contains("busy"));
  EXPECT_THAT(done.out, HasSubstr("g4-dump ("));
}

TEST_F(Doctor, EndsWhenInterrupted) {
  const std::string link = serve();
  program doctor({"doctor", "-d", "1h", link});
  doctor.read_until("motor ");
  doctor.send(SIGINT);
  EXPECT_EQ(doctor.wait().code, 130);
  const outcome again = examine(link);  // it was left idle
  EXPECT_THAT(diagnoses_of(stages_of(again)), Not(Contains("was_scanning"))) << again.out;
}

}  // namespace
