// SPDX-License-Identifier: MIT
// g4-dump sim --link: lidars on ptys until a signal comes, and what the command line refuses.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "program.hpp"

namespace {

using cli::outcome;
using cli::run;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

class Serve : public cli::scratch {
 protected:
  static bool appears(const std::string& name) {
    for (int i = 0; i < 2'000 && !fs::exists(name); ++i) std::this_thread::sleep_for(10ms);
    return fs::exists(name);
  }
  static bool vanishes(const std::string& name) {
    for (int i = 0; i < 2'000 && fs::is_symlink(name); ++i) std::this_thread::sleep_for(10ms);
    return !fs::is_symlink(name);
  }
  // What comes within 20 s, `count` bytes at most, after a command.
  static std::string ask(const std::string& path, unsigned char code, std::size_t count) {
    const int fd = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    EXPECT_GE(fd, 0) << path;
    const std::array<unsigned char, 2> command{0xA5, code};
    EXPECT_EQ(::write(fd, command.data(), command.size()), 2);
    std::string all;
    while (all.size() < count) {
      pollfd waiting{fd, POLLIN, 0};
      std::array<char, 256> part{};
      if (::poll(&waiting, 1, 20'000) <= 0) break;
      const ssize_t got = ::read(fd, part.data(), std::min(part.size(), count - all.size()));
      if (got <= 0) break;
      all.append(part.data(), static_cast<std::size_t>(got));
    }
    ::close(fd);
    return all;
  }
  static std::string serial_at(const std::string& path) {
    std::string serial = ask(path, 0x90, 27);
    if (serial.size() != 27) return "an answer of " + std::to_string(serial.size()) + " bytes";
    serial.erase(0, 11);
    for (char& digit : serial) digit = static_cast<char>(digit + '0');
    return serial;
  }
  static void refused(const std::vector<std::string>& arguments, const std::string& why) {
    const outcome done = run(arguments);
    EXPECT_EQ(done.code, 2) << done.err;
    EXPECT_THAT(done.err, StartsWith("g4-dump: "));
    EXPECT_THAT(done.err, HasSubstr(why));
  }
};

TEST_F(Serve, SeveralLidarsAtOnceUntilASignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    cli::program twins({"sim", "--link", path("one"), "--link", path("two"), "--serial",
                        "1234567890123456", "--log", "--seed", "3"});
    ASSERT_TRUE(appears(path("one")));
    ASSERT_TRUE(appears(path("two")));
    EXPECT_EQ(serial_at(path("one")), "1234567890123456");
    EXPECT_EQ(serial_at(path("two")), "2021101000070073");
    EXPECT_EQ(ask(path("two"), 0x60, 8).substr(0, 3), "\xA5\x5A\x05");
    twins.send(signal);
    const outcome done = twins.wait();
    EXPECT_EQ(done.code, 128 + signal);
    EXPECT_EQ(listing(), "") << "the links are gone";
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.err, HasSubstr("G4 1234567890123456 at " + path("one") + "\n"));
    EXPECT_THAT(done.err, HasSubstr(" 1234567890123456 A5 90 device information?\n"));
    EXPECT_THAT(done.err, HasSubstr(" 2021101000070073 A5 60 start\n"));
  }
}

TEST_F(Serve, ItIsSilentAboutCommandsWithoutLog) {
  cli::program twin({"sim", "--link", path("lidar")});
  ASSERT_TRUE(appears(path("lidar")));
  EXPECT_EQ(serial_at(path("lidar")), "2021101000070073");
  twin.send(SIGTERM);
  EXPECT_EQ(twin.wait().err, "G4 2021101000070073 at " + path("lidar") + "\n");
}

TEST_F(Serve, FaultsAreAtWork) {
  cli::program twin({"sim", "--link", path("lidar"), "--fault", "mute@0+60s", "--fault",
                     "scanning@100ms", "--fault", "unplug@2s+1s"});
  ASSERT_TRUE(appears(path("lidar")));
  EXPECT_GT(ask(path("lidar"), 0x0D, 100).size(), 50U) << "it scans";
  EXPECT_TRUE(vanishes(path("lidar")));
  EXPECT_TRUE(appears(path("lidar")));
  twin.send(SIGTERM);
  EXPECT_EQ(twin.wait().code, 128 + SIGTERM);
}

TEST_F(Serve, WhatMakesNoSenseIsRefused) {
  const std::string link = path("lidar");
  refused({"sim", "--link", link, "--link", path("x/../lidar")}, "is given twice");
  refused({"sim", "--link", link, "--serial", "123"}, "a serial number has 16 decimal digits");
  refused({"sim", "--link", link, "--serial", "123456789012345x"}, "16 decimal digits");
  refused({"sim", "--link", link, "--serial", "1111222233334444", "--serial", "1111222233334445"},
          "there are more --serial than --link");
  refused({"sim", "--link", link, "--link", path("two"), "--serial", "1111222233334444", "--serial",
           "1111222233334444"},
          "is given twice");
  refused({"sim", "--link", link, "--fault", "unplugged"}, "'unplugged' is no fault; there are");
  refused({"sim", "--link", link, "--fault", "unplug@5"}, "--fault unplug@5: '5' is no time");
  refused({"sim", "--link", link, "-o", path("file")}, "--link");
  refused({"sim", "--link", link, "--truth", path("file")}, "--link");
  refused({"sim", "--link", link, "--seconds", "3"}, "--link");
  refused({"sim", "--fault", "unplug"}, "--link");
  refused({"sim", "--serial", "1111222233334444"}, "--link");
  refused({"sim", "--log"}, "--link");
  refused({"sim", "--link", link, "--samples", "81"}, "1 to 80");
  EXPECT_EQ(listing(), "");
}

TEST_F(Serve, WhatStandsInTheWayIsLeftAlone) {
  cli::write_file(path("letter"), "dear");
  const outcome done = run({"sim", "--link", path("letter")});
  EXPECT_EQ(done.code, 10);
  EXPECT_THAT(done.err, HasSubstr("is there already, and no link to a pseudo-terminal"));
  EXPECT_EQ(cli::read_file(path("letter")), "dear");
  EXPECT_EQ(run({"sim", "--link", path("none/lidar")}).code, 10);
}

}  // namespace
