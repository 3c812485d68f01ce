// SPDX-License-Identifier: MIT
// g4-dump doctor as a person runs it, on pseudo-terminals: its words, its JSON, its exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <unistd.h>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "program.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::program;
using cli::run;
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
    while (::access(link.c_str(), F_OK) != 0) ::usleep(2'000);
    return link;
  }

  std::optional<program> served_;
};

// How evenly bytes come there depends on the computer, so the last stage is not looked at.
TEST_F(Doctor, GoesThroughAllStages) {
  const outcome done = examine("sim:");
  const std::vector<json> stages = stages_of(done);
  ASSERT_EQ(stages.size(), 12U) << done.out << done.err;
  const std::vector<std::string> names{"port",   "permission", "holder", "baud_rate",
                                       "answer", "identity",   "health", "motor",
                                       "stream", "rate",       "loss",   "usb_latency"};
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(stages[i].at("stage"), names[i]);
  EXPECT_EQ(stages[5].at("evidence").at("serial_number"), "2021101000070073");
  EXPECT_EQ(stages[6].at("evidence").at("status"), "ok");
}

TEST_F(Doctor, SaysWhatIsWrongAndWhatToTry) {
  const outcome done = run({"doctor", "-d", "500ms", "sim:?fault=health=error"});
  EXPECT_EQ(done.code, 8) << done.err;
  EXPECT_THAT(done.out, HasSubstr("health       FAIL health_error: "));
  EXPECT_THAT(done.out, HasSubstr("try: "));
  EXPECT_THAT(done.out, HasSubstr("found: health_error\n"));
}

TEST_F(Doctor, TellsDamage) {
  const outcome done = examine("sim:?fault=insert*0.01");
  EXPECT_EQ(done.code, 8);
  EXPECT_THAT(diagnoses_of(stages_of(done)), Contains("bytes_inserted")) << done.out;
}

TEST_F(Doctor, TellsAnUnplug) {
  const outcome done = examine("sim:?fault=unplug@1s");
  EXPECT_EQ(done.code, 9) << done.out;
  EXPECT_THAT(diagnoses_of(stages_of(done)), Contains("unplugged")) << done.out;
}

TEST_F(Doctor, TellsAPortThatIsNone) {
  const outcome missing = examine(path("nothing"));
  EXPECT_EQ(missing.code, 3);
  EXPECT_THAT(diagnoses_of(stages_of(missing)), Contains("no_port")) << missing.out;
  cli::write_file(path("a_file"), "no port");
  const outcome file = examine(path("a_file"));
  EXPECT_EQ(file.code, 3);
  EXPECT_THAT(diagnoses_of(stages_of(file)), Contains("not_serial")) << file.out;
  EXPECT_EQ(run({"doctor", "-"}).code, 2);
}

TEST_F(Doctor, TellsAPortThatMayNotBeOpened) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may open everything";
  cli::write_file(path("locked"), "");
  std::filesystem::permissions(path("locked"), std::filesystem::perms::none);
  const outcome done = examine(path("locked"));
  EXPECT_EQ(done.code, 4) << done.out;
}

TEST_F(Doctor, NamesWhoHoldsThePort) {
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
