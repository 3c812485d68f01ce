// SPDX-License-Identifier: MIT
// What may lie in the directory of simulated lidars and is none: nothing of it is listed, waited for or
// written to. Runs with umockdev preloaded: the ports of this computer are none of these.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "escapes.hpp"
#include "program.hpp"
#include "pty.hpp"
#include "simulator.hpp"
#include "testbed.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::run;
using g4lidar::test::pty;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

class Registry : public cli::scratch {
 protected:
  Registry() {
    fs::create_directory(path("ports"));
    ::setenv("G4LIDAR_SIM_DIR", path("ports").c_str(), 1);
  }
  ~Registry() override { ::unsetenv("G4LIDAR_SIM_DIR"); }
  void SetUp() override {
    if (!g4lidar::test::is_preloaded())
      GTEST_SKIP() << "umockdev is not preloaded; use umockdev-wrapper";
  }

  [[nodiscard]] std::string in_registry(const std::string& name) const {
    return path("ports/" + name);
  }

  /// The paths that are listed in this directory.
  std::vector<std::string> listed(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"list", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<std::string> paths;
    for (const std::string& line : lines_of(run(words).out)) {
      const std::string port = json::parse(line).at("path");
      if (port.starts_with(path("ports"))) paths.push_back(port);
    }
    return paths;
  }

  /// Every verb that looks into the directory, to its end.
  void go_through_all_verbs() {
    using words = std::vector<std::string>;
    for (const words& each :
         {words{"list"}, words{"list", "--probe"}, words{"list", "--all"},
          words{"watch", "-d", "700ms"}, words{"info"}, words{"info", "serial:2021101000070099"},
          words{"doctor", "-d", "100ms"}, words{"dump", "-n", "1"}}) {
      const outcome done = run(each);
      EXPECT_EQ(done.signal, 0) << each[0];
      EXPECT_NE(done.code, 11) << each[0] << ": " << done.err;
    }
  }

  static bool is_untouched(const pty& port) {
    pollfd polled{port.master(), POLLIN, 0};
    return ::poll(&polled, 1, 0) == 0;
  }

 private:
  g4lidar::test::testbed bed_;
};

TEST_F(Registry, TerminalOfAnotherProgram_IsNotWrittenTo) {
  const pty terminal;
  const pty second;
  fs::create_symlink(terminal.path(), in_registry("g4-2021101000070099"));
  fs::create_symlink("/dev/pts/../pts/" + second.path().substr(9), in_registry("g4-2"));
  EXPECT_EQ(listed(), std::vector<std::string>());
  go_through_all_verbs();
  EXPECT_TRUE(is_untouched(terminal));
  EXPECT_TRUE(is_untouched(second));
}

TEST_F(Registry, StaleLink_IsIgnored) {
  const pty terminal;
  const std::string link = in_registry("g4-2021101000070073");
  const cli::simulator simulator(link);
  EXPECT_EQ(listed(), std::vector<std::string>{link});
  fs::remove(link);
  fs::create_symlink(terminal.path(), link);
  EXPECT_EQ(listed(), std::vector<std::string>());
  go_through_all_verbs();
  EXPECT_TRUE(is_untouched(terminal));
}

TEST_F(Registry, OtherFilesAreIgnored) {
  cli::write_file(in_registry("a_file"), "\xA5\x5A");
  cli::write_file(path("elsewhere"), "dear");
  fs::create_symlink(path("elsewhere"), in_registry("link_to_a_file"));
  fs::create_directory(in_registry("a_directory"));
  fs::create_symlink(in_registry("a_directory"), in_registry("link_to_a_directory"));
  ASSERT_EQ(::mkfifo(in_registry("a_fifo").c_str(), 0600), 0);
  fs::create_symlink(in_registry("a_fifo"), in_registry("link_to_a_fifo"));
  fs::create_symlink("/dev/pts/4294967295", in_registry("dangling"));
  fs::create_symlink(in_registry("round"), in_registry("round"));
  fs::create_symlink("/dev/null", in_registry("null"));
  fs::create_symlink("/dev/pts/" + std::string(300, '7'), in_registry("long"));
  cli::write_file(in_registry("\x1B[2J\x9B\n"), "");
  EXPECT_EQ(listed(), std::vector<std::string>());
  go_through_all_verbs();
  EXPECT_EQ(cli::read_file(path("elsewhere")), "dear");
  EXPECT_EQ(cli::read_file(in_registry("a_file")), "\xA5\x5A");
}

TEST_F(Registry, TenThousandFiles_AreExamined) {
  for (int i = 0; i < 5'000; ++i) {
    cli::write_file(in_registry("file-" + std::to_string(i)), "");
    fs::create_symlink("/dev/pts/4294967295", in_registry("link-" + std::to_string(i)));
  }
  const std::string link = in_registry("g4-2021101000070073");
  const cli::simulator simulator(link);
  EXPECT_EQ(listed({"--probe"}), std::vector<std::string>{link});
  const outcome info = run({"info", "serial:2021101000070073"});
  EXPECT_EQ(info.code, 0) << info.err;
}

TEST_F(Registry, InvalidDirectory_HasNoDevices) {
  cli::write_file(path("letter"), "dear");
  ASSERT_EQ(::mkfifo(path("fifo").c_str(), 0600), 0);
  for (const std::string name : {"letter", "fifo", "none", "\x1B[2J"}) {
    ::setenv("G4LIDAR_SIM_DIR", path(name).c_str(), 1);
    const outcome done = run({"list"});
    EXPECT_THAT(done.out, Not(HasSubstr(path(name)))) << name;
    EXPECT_NE(done.code, 11) << done.err;
    if (name == "none" || name == "\x1B[2J") continue;
    const outcome served = run({"sim", "--register"});  // its place cannot be made
    EXPECT_EQ(served.code, 10) << served.err;
    EXPECT_THAT(served.err, HasSubstr("g4-dump: "));
  }
  EXPECT_EQ(cli::read_file(path("letter")), "dear");
}

TEST_F(Registry, NameWithEscapes_IsShownWithoutThem) {
  const std::string link = in_registry("g4-\x1B[31m\x9Bq\n\xC2\x9B \xFF");
  const cli::simulator simulator(link);
  for (const std::vector<std::string>& words : {std::vector<std::string>{"list", "--probe"},
                                                {"list", "--json"},
                                                {"info"},
                                                {"info", link},
                                                {"info", "--json"},
                                                {"health", "-v"},
                                                {"doctor", "--json", "-d", "100ms"}}) {
    const outcome done = run(words);
    EXPECT_EQ(cli::unescaped_in(done.out), "") << words[0] << ": " << done.out;
    EXPECT_EQ(cli::unescaped_in(done.err), "") << words[0] << ": " << done.err;
    EXPECT_THAT(done.out + done.err, HasSubstr("g4-")) << words[0];
  }
}

TEST_F(Registry, Watch_ReportsDevicesThatAppearAndDisappear) {
  cli::program watch({"watch"});
  watch.read_until("BY-ID\n");
  {
    const cli::simulator simulator(in_registry("g4-\x1B[31m"));
    watch.read_until("g4-\\x1B[31m");
  }
  watch.read_until("unplugged");
  watch.send(SIGINT);
  const outcome done = watch.wait();
  EXPECT_EQ(done.code, 130);
  EXPECT_EQ(lines_of(done.out).size(), 3U) << done.out;
  EXPECT_EQ(cli::unescaped_in(done.out), "");
}

TEST_F(Registry, TheDoctorNamesSeveralPorts) {
  const cli::simulator first(in_registry("g4-2021101000070073"));
  const cli::simulator second(in_registry("g4-2021101000070074"), {"--serial", "2021101000070074"});
  const outcome done = run({"doctor", "--json", "-d", "500ms"});
  EXPECT_EQ(done.code, 3) << done.out << done.err;
  std::vector<std::string> found;
  for (const std::string& line : lines_of(done.out)) {
    const json stage = json::parse(line);
    for (const json& each : stage.at("diagnoses")) found.push_back(each.at("name"));
  }
  EXPECT_EQ(found, std::vector<std::string>{"several_ports"}) << done.out;
}

}  // namespace
