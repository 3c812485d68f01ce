// SPDX-License-Identifier: MIT
// The verbs list and watch, and the only lidar among several ports. Runs with umockdev preloaded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "g4lidar/sim/pty_port.hpp"
#include "program.hpp"
#include "pty.hpp"
#include "testbed.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::run;
using g4lidar::test::bridge;
using g4lidar::test::pty;
using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;

std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream stream(line);
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

class PortVerbs : public testing::Test {
 protected:
  void SetUp() override {
    if (!g4lidar::test::is_preloaded())
      GTEST_SKIP() << "umockdev is not preloaded; use umockdev-wrapper";
  }

  /// The other end of a port, where nobody answers.
  void connect(const bridge& what, const pty& device) const {
    std::filesystem::create_symlink(device.path(), bed.dev(what.name));
  }

  /// A G4 with this number behind a port.
  [[nodiscard]] g4lidar::sim::background_pty serve(const bridge& what, char last_digit,
                                                   std::uint8_t model = g4lidar::model_g4) const {
    g4lidar::sim::device_options options;
    options.info.serial_digits.back() = last_digit;
    options.info.model = model;
    auto served = g4lidar::sim::background_pty::open(
        g4lidar::sim::device(g4lidar::sim::built_in_world(), options), bed.dev(what.name));
    EXPECT_TRUE(served) << served.error().message();
    return *std::move(served);
  }

  g4lidar::test::testbed bed;
  const bridge first{};
  const bridge second{.name = "ttyUSB1", .place = "1-1.2"};
  const bridge other{
      .name = "ttyUSB2", .place = "2-1", .vendor = "067b", .product = "2303", .driver = "pl2303"};
};

// ---- list --------------------------------------------------------------------------------------

TEST_F(PortVerbs, List_NoPort) {
  const outcome done = run({"list"});
  EXPECT_EQ(done.code, 3);
  EXPECT_EQ(done.out, "");
  EXPECT_EQ(done.err, "no serial port found\n");
  EXPECT_EQ(run({"list", "--json"}).out, "");
}

TEST_F(PortVerbs, List_NoBridgeOfAG4) {
  bed.plug(other);
  bed.add_builtin("ttyS77", "4");
  const outcome done = run({"list"});
  EXPECT_EQ(done.code, 3);
  EXPECT_EQ(lines_of(done.out).size(), 3U);
  EXPECT_THAT(done.err, HasSubstr("no serial port has the USB bridge of a lidar"));
  EXPECT_EQ(run({"list", "-q"}).err, "");
}

TEST_F(PortVerbs, List_AllColumns) {
  bed.plug(second);
  bed.plug(other);
  bed.plug(first);
  bed.add_builtin("ttyS77", "4");
  const pty device;
  connect(first, device);
  std::filesystem::create_directories(bed.dev("serial/by-id"));
  std::filesystem::create_symlink("../../ttyUSB0", bed.dev("serial/by-id/usb-CP2102_0001-port0"));
  const outcome done = run({"list"});
  EXPECT_EQ(done.code, 0) << done.err;
  const std::vector<std::string> lines = lines_of(done.out);
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_THAT(words_of(lines[0]),
              ElementsAre("PATH", "USB", "ID", "DRIVER", "BRIDGE", "OPEN", "BY-ID", "HOLDER"));
  EXPECT_THAT(words_of(lines[1]),
              ElementsAre("/dev/ttyS77", "-", "-", "serial8250", "-", "no", "-", "-"));
  EXPECT_THAT(lines[2], HasSubstr("/dev/ttyUSB0  1-1.4  10c4:ea60  cp210x      g4      yes   "
                                  "/dev/serial/by-id/usb-CP2102_0001-port0  "));
  EXPECT_THAT(words_of(lines[3]),
              ElementsAre("/dev/ttyUSB1", "1-1.2", "10c4:ea60", "cp210x", "g4", "no", "-", "-"));
  EXPECT_THAT(words_of(lines[4]),
              ElementsAre("/dev/ttyUSB2", "2-1", "067b:2303", "pl2303", "other", "no", "-", "-"));
}

TEST_F(PortVerbs, List_Json) {
  bed.plug(first);
  bed.plug(other);
  const std::vector<std::string> lines = lines_of(run({"list", "--json"}).out);
  ASSERT_EQ(lines.size(), 2U);
  const json port = json::parse(lines[0]);
  EXPECT_EQ(port.at("path"), "/dev/ttyUSB0");
  EXPECT_EQ(port.at("usb"), "1-1.4");
  EXPECT_EQ(port.at("id"), "10c4:ea60");
  EXPECT_EQ(port.at("driver"), "cp210x");
  EXPECT_EQ(port.at("is_g4_bridge"), true);
  EXPECT_EQ(port.at("may_open"), false);
  EXPECT_EQ(port.at("by_id"), nullptr);
  EXPECT_EQ(port.at("holder"), nullptr);
  EXPECT_EQ(port.at("manufacturer"), "Silicon Labs");
  EXPECT_EQ(port.at("usb_serial"), "0001");
  EXPECT_EQ(port.at("device"), nullptr);
  EXPECT_EQ(port.at("problem"), nullptr);
  EXPECT_EQ(json::parse(lines[1]).at("is_g4_bridge"), false);
}

// ---- list --probe ------------------------------------------------------------------------------

TEST_F(PortVerbs, Probe_ReportsWhichLidarAnswersAndWhatFailed) {
  bed.plug(first);
  bed.plug(second);
  bed.plug(other);
  const auto lidar = serve(first, '1');
  const pty mute;
  connect(second, mute);
  const pty printer;
  connect(other, printer);
  const outcome done = run({"list", "--probe"});
  EXPECT_EQ(done.code, 0) << done.err;
  const std::vector<std::string> lines = lines_of(done.out);
  ASSERT_EQ(lines.size(), 4U);
  const auto answer = [&](std::size_t line) {
    const std::vector<std::string> words = words_of(lines[line]);
    return words.size() < 12 ? std::vector<std::string>()
                             : std::vector<std::string>(words.begin() + 7, words.begin() + 12);
  };
  EXPECT_THAT(answer(0), ElementsAre("ANSWER", "SERIAL", "FIRMWARE", "BAUD", "OR"));
  EXPECT_THAT(answer(1), ElementsAre("g4", "2021101000070071", "3.2", "230400", "-"));
  EXPECT_THAT(answer(2), ElementsAre("silence", "-", "-", "-", "-"));
  EXPECT_THAT(answer(3), ElementsAre("-", "-", "-", "-", "-"));
  EXPECT_THAT(done.err, HasSubstr("/dev/ttyUSB1"));
}

TEST_F(PortVerbs, Probe_Json) {
  bed.plug(first);
  bed.plug(second);
  const auto lidar = serve(first, '1');
  const auto other_model = serve(second, '2', 52);
  const std::vector<std::string> lines = lines_of(run({"list", "--probe", "--json"}).out);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(
      json::parse(lines[0]).at("device"),
      (json{{"model", 5}, {"serial", "2021101000070071"}, {"firmware", "3.2"}, {"hardware", 3}}));
  EXPECT_EQ(json::parse(lines[0]).at("lidar"),
            (json{{"model", "g4"}, {"baud", 230400}, {"candidates", {"g4"}}}));
  EXPECT_EQ(json::parse(lines[1]).at("problem").at("name"), "other_device");
  EXPECT_EQ(json::parse(lines[1]).at("lidar"), nullptr);
}

TEST_F(PortVerbs, Probe_ExitCodes) {
  EXPECT_EQ(run({"list", "--probe"}).code, 3);
  bed.plug(second);
  const auto other_model = serve(second, '2', 52);
  EXPECT_EQ(run({"list", "--probe"}).code, 7);
  bed.plug(first);  // whose node is missing
  EXPECT_EQ(run({"list", "--probe"}).code, 3);
}

TEST_F(PortVerbs, Probe_WritesToOtherPortsOnlyWhenAsked) {
  bed.plug(other);
  auto lidar = serve(other, '3');
  EXPECT_EQ(run({"list", "--probe"}).code, 3);
  bool is_untouched = false;
  lidar.with([&](g4lidar::sim::device& simulated, std::int64_t) {
    is_untouched = simulated.log().empty();
  });
  EXPECT_TRUE(is_untouched);
  const outcome all = run({"list", "--all"});
  EXPECT_EQ(all.code, 0) << all.err;
  EXPECT_THAT(all.out, HasSubstr("2021101000070073"));
}

TEST_F(PortVerbs, Probe_DisturbsNoOtherProgram) {
  bed.plug(first);
  const auto lidar = serve(first, '1');
  cli::program dump({"dump"});  // the only lidar
  dump.read_until("\n");
  const outcome done = run({"list", "--probe"});
  EXPECT_EQ(done.code, 5) << done.err;
  EXPECT_THAT(done.out, HasSubstr("  busy  "));
  EXPECT_THAT(done.err, HasSubstr("g4-dump ("));
  dump.send(SIGINT);
  EXPECT_EQ(dump.wait().code, 130);
}

// ---- watch -------------------------------------------------------------------------------------

TEST_F(PortVerbs, Watch_ReportsPortsThatAppearAndDisappear) {
  bed.plug(first);
  cli::program watch({"watch"});
  watch.read_until("BY-ID\n");
  bed.plug(second);
  watch.read_until("ttyUSB1");
  bed.unplug(first);
  watch.read_until("unplugged");
  watch.send(SIGINT);
  const outcome done = watch.wait();
  EXPECT_EQ(done.code, 130);
  const std::vector<std::string> lines = lines_of(done.out);
  ASSERT_EQ(lines.size(), 3U) << done.out;
  EXPECT_THAT(words_of(lines[0]), ElementsAre("TIME", "EVENT", "PATH", "USB", "ID", "DRIVER",
                                              "BRIDGE", "OPEN", "BY-ID"));
  const auto time = MatchesRegex("20[0-9-]+T[0-9:]+\\.[0-9][0-9][0-9]Z");
  EXPECT_THAT(words_of(lines[1]), ElementsAre(time, "plugged", "/dev/ttyUSB1", "1-1.2", "10c4:ea60",
                                              "cp210x", "g4", "no", "-"));
  EXPECT_THAT(words_of(lines[2]), ElementsAre(time, "unplugged", "/dev/ttyUSB0", "1-1.4",
                                              "10c4:ea60", "cp210x", "g4", "no", "-"));
}

TEST_F(PortVerbs, Watch_JsonEndsAfterTheCount) {
  cli::program watch({"watch", "-n", "2", "--json", "-q"});
  // Its first line cannot be waited for: plugged until it has seen one.
  std::string seen;
  for (int i = 0; i < 200 && seen.empty(); ++i) {
    bed.plug(first);
    ::usleep(50'000);
    bed.unplug(first);
    ::usleep(50'000);
    if (watch.input_is_dead()) break;
  }
  const outcome done = watch.wait();
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.err, "");
  const std::vector<std::string> lines = lines_of(done.out);
  ASSERT_EQ(lines.size(), 2U);
  for (const std::string& line : lines) {
    const json event = json::parse(line);
    EXPECT_EQ(event.at("path"), "/dev/ttyUSB0");
    EXPECT_EQ(event.at("is_g4_bridge"), true);
  }
  EXPECT_NE(json::parse(lines[0]).at("event"), json::parse(lines[1]).at("event"));
}

TEST_F(PortVerbs, Watch_EndsInTime) {
  const outcome done = run({"watch", "-d", "100ms"});
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(lines_of(done.out).size(), 1U);
}

TEST_F(PortVerbs, Watch_ClosedPipe) {
  cli::program watch({"watch", "--json"});
  watch.close_output();
  EXPECT_EQ(watch.wait().code, 0);
}

// ---- the others, without a word which ---------------------------------------------------------

TEST_F(PortVerbs, TheOnlyG4) {
  EXPECT_EQ(run({"info"}).code, 3);
  bed.plug(first);
  const auto one = serve(first, '1');
  EXPECT_THAT(run({"info"}).out, HasSubstr("source      /dev/ttyUSB0\n"));
  bed.plug(second);
  const auto two = serve(second, '2');
  const outcome several = run({"info"});
  EXPECT_EQ(several.code, 3);
  EXPECT_THAT(several.err, HasSubstr("/dev/ttyUSB0, /dev/ttyUSB1"));
  EXPECT_THAT(run({"info", "usb:1-1.2"}).out, HasSubstr("2021101000070072"));
  EXPECT_THAT(run({"info", "serial:2021101000070072"}).out, HasSubstr("/dev/ttyUSB1"));
}

TEST(PortVerbsHelp, NamesEveryColumn) {
  for (const char* const verb : {"list", "watch"}) {
    const std::string help = run({verb, "--help"}).out;
    for (const char* const column : {"PATH", "USB", "ID", "DRIVER", "BRIDGE", "OPEN", "BY-ID"}) {
      EXPECT_THAT(help, HasSubstr(column)) << verb;
    }
    for (const std::string& line : lines_of(help)) EXPECT_LE(line.size(), 100U) << line;
  }
  const std::string help = run({"list", "--help"}).out;
  for (const char* const column : {"ANSWER", "SERIAL", "FIRMWARE", "BAUD", "OR ", "HOLDER"}) {
    EXPECT_THAT(help, HasSubstr(column));
  }
}

}  // namespace
