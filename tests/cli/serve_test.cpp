// SPDX-License-Identifier: MIT
// g4-dump sim --link: lidars on ptys until a signal comes, and what the command line refuses.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "program.hpp"
#include "simulator.hpp"
#include "support/patience.hpp"

namespace {

using cli::outcome;
using cli::run;
using g4lidar::test::comes_true;
using g4lidar::test::patience_ms;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;
namespace fs = std::filesystem;

class Serve : public cli::scratch {
 protected:
  static bool appears(const std::string& name) {
    return comes_true([&] { return fs::exists(name); });
  }
  static bool vanishes(const std::string& name) {
    return comes_true([&] { return !fs::is_symlink(name); });
  }
  // What comes within `patience`, `count` bytes at most, after a command.
  static std::string ask(const std::string& path, unsigned char code, std::size_t count) {
    const int fd = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    EXPECT_GE(fd, 0) << path;
    const std::array<unsigned char, 2> command{0xA5, code};
    EXPECT_EQ(::write(fd, command.data(), command.size()), 2);
    std::string all;
    while (all.size() < count) {
      pollfd waiting{fd, POLLIN, 0};
      std::array<char, 256> part{};
      if (::poll(&waiting, 1, patience_ms) <= 0) break;
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
    cli::program simulators({"sim", "--link", path("one"), "--link", path("two"), "--serial",
                             "1234567890123456", "--log", "--seed", "3"});
    ASSERT_TRUE(appears(path("one")));
    ASSERT_TRUE(appears(path("two")));
    EXPECT_EQ(serial_at(path("one")), "1234567890123456");
    EXPECT_EQ(serial_at(path("two")), "2021101000070073");
    EXPECT_EQ(ask(path("two"), 0x60, 8).substr(0, 3), "\xA5\x5A\x05");
    simulators.send(signal);
    const outcome done = simulators.wait();
    EXPECT_EQ(done.code, 128 + signal);
    EXPECT_EQ(listing(), "") << "the links are gone";
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.err, HasSubstr("G4 1234567890123456 at " + path("one") + "\n"));
    EXPECT_THAT(done.err, HasSubstr(" 1234567890123456 A5 90 device information?\n"));
    EXPECT_THAT(done.err, HasSubstr(" 2021101000070073 A5 60 start\n"));
  }
}

TEST_F(Serve, NoLog_PrintsNoCommands) {
  cli::program simulator({"sim", "--link", path("lidar")});
  ASSERT_TRUE(appears(path("lidar")));
  EXPECT_EQ(serial_at(path("lidar")), "2021101000070073");
  simulator.send(SIGTERM);
  EXPECT_EQ(simulator.wait().err, "G4 2021101000070073 at " + path("lidar") + "\n");
}

TEST_F(Serve, Faults_AreApplied) {
  cli::program simulator({"sim", "--link", path("lidar"), "--fault", "mute@0+60s", "--fault",
                          "scanning@100ms", "--fault", "unplug@2s+1s"});
  ASSERT_TRUE(appears(path("lidar")));
  EXPECT_GT(ask(path("lidar"), 0x0D, 100).size(), 50U) << "it scans";
  EXPECT_TRUE(vanishes(path("lidar")));
  EXPECT_TRUE(appears(path("lidar")));
  simulator.send(SIGTERM);
  EXPECT_EQ(simulator.wait().code, 128 + SIGTERM);
}

TEST_F(Serve, InvalidOptions_AreRefused) {
  const std::string link = path("lidar");
  refused({"sim", "--link", link, "--link", path("x/../lidar")}, "is given twice");
  refused({"sim", "--link", link, "--serial", "123"}, "a serial number has 16 decimal digits");
  refused({"sim", "--link", link, "--serial", "123456789012345x"}, "16 decimal digits");
  refused({"sim", "--link", link, "--serial", "1111222233334444", "--serial", "1111222233334445"},
          "there are more --serial than devices");
  refused({"sim", "--link", link, "--link", path("two"), "--serial", "1111222233334444", "--serial",
           "1111222233334444"},
          "is given twice");
  refused({"sim", "--link", link, "--fault", "unplugged"},
          "'unplugged' is not a fault; faults are");
  refused({"sim", "--link", link, "--fault", "unplug@5"}, "--fault: unplug@5: '5' is no time");
  refused({"sim", "--link", link, "-o", path("file")}, "--link");
  refused({"sim", "--link", link, "--truth", path("file")}, "--link");
  refused({"sim", "--link", link, "--seconds", "3"}, "--link");
  refused({"sim", "--fault", "unplug"}, "--link");
  refused({"sim", "--serial", "1111222233334444"}, "--link");
  refused({"sim", "--log"}, "--link");
  refused({"sim", "--link", link, "--samples", "81"}, "1 to 80");
  refused({"sim", "--tcp", "70000"}, "'70000' is not PORT or ADDRESS:PORT");
  EXPECT_EQ(listing(), "");
}

TEST_F(Serve, LinkOfARunningDevice_IsNotReplaced) {
  cli::program first({"sim", "--link", path("lidar"), "--fault", "unplug@2s+2s"});
  ASSERT_TRUE(appears(path("lidar")));
  // The same place by another name, too.
  for (const std::string& link : {path("lidar"), path("x/../lidar")}) {
    const outcome second = run({"sim", "--link", link, "--serial", "1234567890123456"});
    EXPECT_EQ(second.code, 5) << second.err;
    EXPECT_THAT(second.err, HasSubstr("leads to a device that another program simulates"));
  }
  EXPECT_TRUE(vanishes(path("lidar")));
  EXPECT_EQ(run({"sim", "--link", path("lidar")}).code, 5) << "unplugged, but still served";
  EXPECT_TRUE(appears(path("lidar"))) << "plugged in again";
  first.send(SIGKILL);
  EXPECT_EQ(first.wait().signal, SIGKILL);
  EXPECT_TRUE(fs::remove(path("lidar")))
      << "it leads to what may be the pseudo-terminal of another test";
  fs::create_symlink("/dev/pts/999999", path("lidar"));
  const cli::program next({"sim", "--link", path("lidar"), "--serial", "1234567890123456"});
  EXPECT_TRUE(appears(path("lidar")));
  EXPECT_THAT(run({"info", path("lidar")}).out, HasSubstr("1234567890123456"))
      << "a link that leads nowhere is replaced";
}

TEST_F(Serve, ARegisteredDeviceIsDiscovered) {
  refused({"sim", "--register"}, "G4LIDAR_SIM_DIR");
  EXPECT_EQ(run({"list"}).out.find("sim"), std::string::npos) << "off unless asked for";
  ::setenv("G4LIDAR_SIM_DIR", path("ports").c_str(), 1);
  cli::program simulator({"sim", "--register", "--serial", "1234567890123456"});
  EXPECT_TRUE(appears(path("ports/g4-1234567890123456")));
  const outcome list = run({"list", "--probe", "--json"});
  EXPECT_EQ(list.code, 0) << list.err;
  EXPECT_THAT(list.out, HasSubstr("\"serial\":\"1234567890123456\""));
  const outcome info = run({"info", "serial:1234567890123456"});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("serial      1234567890123456\n"));
  EXPECT_NE(run({"info", "serial:1234567890123457"}).code, 0);
  const outcome second = run({"sim", "--register", "--serial", "1234567890123456"});
  EXPECT_EQ(second.code, 5);
  EXPECT_THAT(second.err, EndsWith("Give another --serial, or another G4LIDAR_SIM_DIR.\n"));
  simulator.send(SIGTERM);
  EXPECT_EQ(simulator.wait().code, 128 + SIGTERM);
  EXPECT_FALSE(fs::exists(path("ports/g4-1234567890123456")));
  ::unsetenv("G4LIDAR_SIM_DIR");
}

TEST_F(Serve, ExistingFile_IsNotReplaced) {
  cli::write_file(path("letter"), "dear");
  const outcome done = run({"sim", "--link", path("letter")});
  EXPECT_EQ(done.code, 10);
  EXPECT_THAT(done.err, HasSubstr("exists and is not a link to a pseudo-terminal"));
  EXPECT_EQ(cli::read_file(path("letter")), "dear");
  EXPECT_EQ(run({"sim", "--link", path("none/lidar")}).code, 10);
}

}  // namespace
