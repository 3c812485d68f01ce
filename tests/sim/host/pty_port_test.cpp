// SPDX-License-Identifier: MIT
// The simulated G4 on a pty, in real time: a path that any program can open, and its link.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "g4lidar/sim/pty_port.hpp"
#include "support/host_side.hpp"
#include "support/patience.hpp"

namespace {

using namespace g4lidar;
using namespace std::chrono_literals;
using test::byte_vector;
namespace fs = std::filesystem;

class SimPty : public testing::Test {
 protected:
  SimPty() {
    std::string name = fs::temp_directory_path() / "g4lidar-pty-XXXXXX";
    directory_ = ::mkdtemp(name.data());
  }
  ~SimPty() override { fs::remove_all(directory_); }

  [[nodiscard]] std::string link() const { return directory_ / "lidar"; }
  static sim::device simulated(const sim::device_options& options = {}) {
    return sim::device(sim::built_in_world(), options);
  }

  fs::path directory_;
};

// A program that opens the path as a serial port.
class visitor {
 public:
  explicit visitor(const std::string& path)
      : fd_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {}
  visitor(const visitor&) = delete;
  visitor& operator=(const visitor&) = delete;
  ~visitor() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int fd() const { return fd_; }

  bool send(std::uint8_t code) const {
    const std::array<std::uint8_t, 2> bytes{0xA5, code};
    return ::write(fd_, bytes.data(), bytes.size()) == 2;
  }
  // Until there are so many, the port is gone, or `patience` has passed.
  [[nodiscard]] byte_vector read(std::size_t count) const {
    byte_vector all;
    const auto end = std::chrono::steady_clock::now() + test::patience;
    while (all.size() < count && std::chrono::steady_clock::now() < end) {
      pollfd waiting{fd_, POLLIN, 0};
      if (::poll(&waiting, 1, 1000) <= 0) continue;
      std::array<std::uint8_t, 4096> part{};
      const ssize_t got = ::read(fd_, part.data(), std::min(part.size(), count - all.size()));
      if (got <= 0) break;
      all.insert(all.end(), part.begin(), part.begin() + got);
    }
    return all;
  }
  [[nodiscard]] bool hangs_up(std::chrono::milliseconds within) const {
    const auto end = std::chrono::steady_clock::now() + within;
    while (std::chrono::steady_clock::now() < end) {
      pollfd waiting{fd_, 0, 0};
      if (::poll(&waiting, 1, 20) > 0 && (waiting.revents & POLLHUP) != 0) return true;
    }
    return false;
  }

 private:
  int fd_;
};

TEST_F(SimPty, AnswersAndScansThroughItsLink) {
  const auto port = sim::background_pty::open(simulated(), link());
  ASSERT_TRUE(port) << port.error().message();
  EXPECT_EQ(port->path(), link());
  const visitor program(link());
  ASSERT_TRUE(program.send(0x90));
  const byte_vector info = program.read(27);
  ASSERT_EQ(info.size(), 27U);
  EXPECT_EQ(info[26], 3);
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_TRUE(program.send(0x60));
  const test::heard got = test::taken_apart(program.read(30'000));
  EXPECT_GT(got.packets, 300U);
  EXPECT_LT(got.skipped_bytes, 2 * max_packet_size);
  EXPECT_GT(std::chrono::steady_clock::now() - begin, 1200ms) << "at the true baud rate";
}

TEST_F(SimPty, Pty_IsRaw) {
  const auto port = sim::background_pty::open(simulated());
  ASSERT_TRUE(port);
  const visitor program(port->path());
  termios settings{};
  ASSERT_EQ(::tcgetattr(program.fd(), &settings), 0);
  EXPECT_EQ(settings.c_lflag & static_cast<tcflag_t>(ICANON | ECHO | ISIG), 0U);
  EXPECT_EQ(settings.c_oflag & static_cast<tcflag_t>(OPOST), 0U);
  EXPECT_EQ(::cfgetospeed(&settings), static_cast<speed_t>(B38400)) << "that of a new terminal";
}

// Returns the bytes that arrive within a time after a program has set the rate and asked for the device
// information.
byte_vector asked_at(const visitor& program, speed_t rate) {
  termios settings{};
  EXPECT_EQ(::tcgetattr(program.fd(), &settings), 0);
  ::cfsetspeed(&settings, rate);
  EXPECT_EQ(::tcsetattr(program.fd(), TCSANOW, &settings), 0);
  ::tcflush(program.fd(), TCIFLUSH);
  EXPECT_TRUE(program.send(0x90));
  byte_vector all;
  const auto end = std::chrono::steady_clock::now() + (rate == B230400 ? test::patience : 500ms);
  while (all.size() < 27 && std::chrono::steady_clock::now() < end) {
    pollfd waiting{program.fd(), POLLIN, 0};
    if (::poll(&waiting, 1, 50) <= 0) continue;
    std::array<std::uint8_t, 64> part{};
    const ssize_t got = ::read(program.fd(), part.data(), part.size());
    if (got > 0) all.insert(all.end(), part.begin(), part.begin() + got);
  }
  return all;
}

TEST_F(SimPty, HasTheRateThatAProgramSets) {
  const auto port = sim::background_pty::open(simulated());
  ASSERT_TRUE(port);
  {
    const visitor program(port->path());
    EXPECT_EQ(asked_at(program, B115200).size(), 0U);
    EXPECT_EQ(asked_at(program, B230400).size(), 27U);
    EXPECT_EQ(asked_at(program, B460800).size(), 0U);
  }
  EXPECT_TRUE(test::comes_true([&] {
    termios settings{};
    const visitor next(port->path());
    EXPECT_EQ(::tcgetattr(next.fd(), &settings), 0);
    return ::cfgetospeed(&settings) == static_cast<speed_t>(B38400);
  })) << "it is reset when the last program closes it";
  const visitor other(port->path());
  ASSERT_TRUE(other.send(0x90));
  EXPECT_EQ(other.read(27).size(), 27U) << "this program sets no rate";
}

TEST_F(SimPty, AnyRateWorks_WithTheOption) {
  sim::device_options options;
  options.any_baud = true;
  const auto port = sim::background_pty::open(simulated(options));
  ASSERT_TRUE(port);
  const visitor program(port->path());
  termios settings{};
  ASSERT_EQ(::tcgetattr(program.fd(), &settings), 0);
  ::cfsetspeed(&settings, B9600);
  ASSERT_EQ(::tcsetattr(program.fd(), TCSANOW, &settings), 0);
  ASSERT_TRUE(program.send(0x90));
  EXPECT_EQ(program.read(27).size(), 27U);
}

TEST_F(SimPty, AMotorThatDtrDrives_IsEnabled) {
  sim::device_options options;
  ASSERT_TRUE(sim::use_model(options, "x4"));
  const auto port = sim::background_pty::open(simulated(options));
  ASSERT_TRUE(port);
  const visitor program(port->path());
  ASSERT_TRUE(program.send(0x60));
  EXPECT_EQ(program.read(5000).size(), 5000U);
}

TEST_F(SimPty, Link_IsRemovedWithThePort) {
  {
    const auto port = sim::background_pty::open(simulated(), link());
    ASSERT_TRUE(port);
    EXPECT_TRUE(fs::is_symlink(link()));
  }
  EXPECT_FALSE(fs::exists(fs::symlink_status(link())));
  EXPECT_TRUE(fs::is_empty(directory_));
}

TEST_F(SimPty, StaleLink_IsReplacedAndNothingElse) {
  fs::create_symlink("/dev/pts/999999", link());  // of a simulator that was killed
  EXPECT_TRUE(sim::background_pty::open(simulated(), link()));
  EXPECT_FALSE(fs::exists(fs::symlink_status(link())));
  std::ofstream(link()) << "a letter";
  const auto refused = sim::background_pty::open(simulated(), link());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code(), problem::busy);
  EXPECT_TRUE(fs::is_regular_file(link()));
  fs::remove(link());
  const auto nowhere = sim::background_pty::open(simulated(), directory_ / "none" / "lidar");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code(), problem::system);
}

TEST_F(SimPty, Unplug_HangsUp_ReplugMovesTheLink) {
  auto made = sim::background_pty::open(simulated(), link());
  ASSERT_TRUE(made);
  sim::background_pty& port = *made;
  const visitor before(link());
  ASSERT_TRUE(before.send(0x60));
  EXPECT_EQ(before.read(1'000).size(), 1'000U);
  port.with([](sim::device& device, std::int64_t now_ns) { device.unplug(now_ns); });
  EXPECT_TRUE(before.hangs_up(test::patience));
  EXPECT_TRUE(test::comes_true([&] { return !fs::exists(fs::symlink_status(link())); }));
  port.with([](sim::device& device, std::int64_t now_ns) { device.replug(now_ns); });
  EXPECT_TRUE(test::comes_true([&] { return fs::exists(link()); }));
  const visitor after(link());
  EXPECT_FALSE(test::taken_apart(after.read(76)).responses.empty())
      << "it sends its device information";
  ASSERT_TRUE(after.send(0x90));
  EXPECT_EQ(after.read(27).size(), 27U);
}

TEST_F(SimPty, SlowReader_LosesBytesAndDelaysNothing) {
  auto made = sim::background_pty::open(simulated(), link());
  ASSERT_TRUE(made);
  sim::background_pty& port = *made;
  const visitor program(link());
  port.with([](sim::device& device, std::int64_t now_ns) {
    device.write(std::array<std::uint8_t, 2>{0xA5, 0x60}, now_ns);
  });
  EXPECT_TRUE(test::comes_true([&] { return port.bytes_lost() > 1'000; }));
  ASSERT_TRUE(program.send(0x65));
  EXPECT_TRUE(test::comes_true([&] {
    bool scanning = true;
    port.with([&](sim::device& device, std::int64_t) { scanning = device.is_scanning(); });
    return !scanning;
  })) << "it still listens";
}

// Like a serial port: the next program gets neither the exclusive access nor the bytes of the
// previous one.
TEST_F(SimPty, IsResetForEachProgram) {
  auto port = sim::background_pty::open(simulated());
  ASSERT_TRUE(port);
  {
    const visitor program(port->path());
    termios settings{};
    ASSERT_EQ(::tcgetattr(program.fd(), &settings), 0);
    settings.c_lflag |= ECHO | ICANON;
    ASSERT_EQ(::tcsetattr(program.fd(), TCSANOW, &settings), 0);
    ASSERT_EQ(::ioctl(program.fd(), TIOCEXCL), 0);
    ASSERT_TRUE(program.send(0x60));
    ASSERT_TRUE(test::comes_true([&] {
      bool scans = false;
      port->with([&](sim::device& device, std::int64_t now_ns) {
        static_cast<void>(device.available(now_ns));
        scans = device.is_scanning();
      });
      return scans;
    }));
    std::this_thread::sleep_for(300ms);  // it sends the header
  }
  std::this_thread::sleep_for(1s);  // it notices within 20 ms that the program has closed it
  EXPECT_EQ(port->bytes_lost(), 0U) << "no program had it open";
  const visitor program(port->path());
  int exclusive = 1;
  ASSERT_EQ(::ioctl(program.fd(), TIOCGEXCL, &exclusive), 0);
  EXPECT_EQ(exclusive, 0);
  termios settings{};
  ASSERT_EQ(::tcgetattr(program.fd(), &settings), 0);
  EXPECT_EQ(settings.c_lflag & static_cast<tcflag_t>(ICANON | ECHO), 0U);
  const test::heard got = test::taken_apart(program.read(2'000));
  EXPECT_TRUE(got.responses.empty()) << "the header was the last program's";
  EXPECT_GT(got.packets, 15U) << "it goes on scanning";
}

TEST_F(SimPty, FunctionOfAnotherThread_MayUseThePort) {
  auto port = sim::background_pty::open(simulated(), link());
  ASSERT_TRUE(port);
  bool is_plugged = false;
  port->with([&](sim::device&, std::int64_t) {
    EXPECT_EQ(port->bytes_lost(), 0U);
    EXPECT_EQ(port->path(), link());
    port->with(
        [&](sim::device& inner, std::int64_t now_ns) { is_plugged = inner.is_plugged(now_ns); });
  });
  EXPECT_TRUE(is_plugged);
}

TEST_F(SimPty, Idle_DoesNotSpin) {
  std::array<int, 2> wake_pipe{};
  ASSERT_EQ(::pipe2(wake_pipe.data(), O_CLOEXEC), 0);
  std::vector<sim::pty_port> ports;
  for (int i = 0; i < 2; ++i) ports.push_back(std::move(*sim::pty_port::open(simulated())));
  int steps = 0;
  std::thread stopper([&] {
    std::this_thread::sleep_for(500ms);
    EXPECT_EQ(::write(wake_pipe[1], "x", 1), 1);
  });
  EXPECT_TRUE(sim::serve(ports, wake_pipe[0], [&] { ++steps; }));
  stopper.join();
  EXPECT_LE(steps, 3) << "idle devices need no looking at";
  ::close(wake_pipe[0]);
  ::close(wake_pipe[1]);
}

}  // namespace
