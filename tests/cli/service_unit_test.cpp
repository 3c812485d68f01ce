// SPDX-License-Identifier: MIT
// The unit's own command line, run as systemd would run it, on a simulated lidar: it reports that it
// is ready and that it runs, and ends in good order with a recording that can be read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "manager.hpp"
#include "program.hpp"
#include "support/patience.hpp"

namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;

using settings = std::multimap<std::string, std::string>;

settings read_unit() {
  settings all;
  for (const std::string& text : cli::lines_of(cli::read_file(
           std::string(G4LIDAR_SOURCE_DIR) + "/packaging/systemd/g4lidar-record@.service.in"))) {
    const std::size_t equals = text.find('=');
    if (text.empty() || text.front() == '#' || equals == std::string::npos) continue;
    all.emplace(text.substr(0, equals), text.substr(equals + 1));
  }
  return all;
}

std::string only(const settings& unit, const std::string& key) {
  EXPECT_EQ(unit.count(key), 1U) << key;
  const auto found = unit.find(key);
  return found == unit.end() ? std::string() : found->second;
}

/// What the shell is given: the specifiers and the doubled signs, as systemd.unit(5) has them.
std::string shell_words(std::string line, const std::string& instance) {
  const std::string before = "/bin/sh -c '";
  EXPECT_TRUE(line.starts_with(before) && line.ends_with("'")) << line;
  line = line.substr(before.size(), line.size() - before.size() - 1);
  std::string words;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const std::string two = line.substr(i, 2);
    if (two == "%i") {
      words += instance;
    } else if (two == "%%" || two == "$$") {
      words += two[0];
    } else if (line.compare(i, 9, "@g4_dump@") == 0) {
      words += G4_DUMP;
      i += 7;
    } else {
      EXPECT_NE(line[i], '%') << "a specifier that this test does not know: " << two;
      words += line[i];
      continue;
    }
    ++i;
  }
  return words;
}

/// The service's one process.
class service {
 public:
  explicit service(const std::string& words) {
    std::vector<std::string> arguments{"sh", "-c", words};
    std::vector<char*> pointers;
    for (std::string& each : arguments) pointers.push_back(each.data());
    pointers.push_back(nullptr);
    EXPECT_EQ(::posix_spawn(&pid_, "/bin/sh", nullptr, nullptr, pointers.data(), environ), 0);
  }
  service(const service&) = delete;
  service& operator=(const service&) = delete;
  ~service() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    static_cast<void>(end());
  }

  /// Its exit code, after the signal with which systemd ends a service.
  [[nodiscard]] int stop() {
    ::kill(pid_, SIGTERM);
    return end();
  }

 private:
  int end() {
    int status = 0;
    EXPECT_EQ(::waitpid(pid_, &status, 0), pid_);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  pid_t pid_ = -1;
};

/// The path of the lidar has a space: a SOURCE is one word.
class ServiceUnit : public cli::scratch {
 protected:
  ServiceUnit() {
    fs::create_directory(path("state"));
    ::setenv("STATE_DIRECTORY", path("state").c_str(), 1);
    ::setenv("SOURCE", path("a lidar").c_str(), 1);
    ::setenv("WATCHDOG_USEC", "500000", 1);
  }
  ~ServiceUnit() override {
    for (const char* name : {"STATE_DIRECTORY", "SOURCE", "OPTIONS"}) ::unsetenv(name);
  }
};

TEST_F(ServiceUnit, Command_RecordsAndReportsThatItRuns) {
  const settings unit = read_unit();
  EXPECT_EQ(only(unit, "Type"), "notify");
  const auto [first, last] = unit.equal_range("Environment");
  EXPECT_THAT(unit, Contains(settings::value_type("Environment", "\"SOURCE=%i\"")));
  std::string options;
  for (auto each = first; each != last; ++each) {
    const std::string begin = "\"OPTIONS=";
    if (each->second.starts_with(begin)) {
      options = each->second.substr(begin.size(), each->second.size() - begin.size() - 1);
    }
  }
  EXPECT_NE(options, "");
  ::setenv("OPTIONS", (options + " -q").c_str(), 1);

  cli::program simulator({"sim", "--link", path("a lidar")});
  ASSERT_TRUE(g4lidar::test::comes_true([&] { return fs::exists(path("a lidar")); }));
  const cli::manager systemd(path("notify"));
  service recorder(shell_words(only(unit, "ExecStart"), "serial:2021101000070073"));
  std::vector<std::string> heard;
  const auto times = [&](const std::string& word) {
    return std::count(heard.begin(), heard.end(), word);
  };
  const auto recorded = [&] {
    std::uintmax_t size = 0;
    for (const auto& entry : fs::directory_iterator(path("state"))) size += entry.file_size();
    return size;
  };
  constexpr std::uintmax_t some_scans = 60'000;
  EXPECT_TRUE(g4lidar::test::comes_true([&] {
    for (std::string& word : systemd.heard()) heard.push_back(std::move(word));
    return times("READY=1") > 0 && times("WATCHDOG=1") >= 3 && recorded() > some_scans;
  }));
  EXPECT_THAT(heard, Contains("READY=1"));
  EXPECT_GE(times("WATCHDOG=1"), 3);
  const int code = recorder.stop();
  EXPECT_THAT(" " + only(unit, "SuccessExitStatus") + " ",
              HasSubstr(" " + std::to_string(code) + " "));
  EXPECT_THAT(systemd.heard(), Contains("STOPPING=1"));

  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(path("state"))) files.push_back(entry.path());
  ASSERT_EQ(files.size(), 1U);
  EXPECT_THAT(fs::path(files[0]).filename().string(),
              ::testing::MatchesRegex("serial:2021101000070073-[0-9]{8}T[0-9]{6}Z\\.mcap"));
  const cli::outcome read = cli::run({"dump", files[0], "-f", "csv"});
  EXPECT_EQ(read.code, 0) << read.err;
  EXPECT_GT(cli::lines_of(read.out).size(), 1000U) << "hardly a point in the recording";
}

}  // namespace
