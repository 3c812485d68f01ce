// SPDX-License-Identifier: MIT
// A serial port, replaced by a pseudo-terminal.
#include "g4lidar/transport/serial_port.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/time.h>

#include <cstring>
#include <thread>

#include "port_io.hpp"
#include "pty.hpp"
#include "support/patience.hpp"
#include "temporary_file.hpp"
#include "transport/custom_baud.hpp"
#include "transport/system_calls.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

problem why_not(std::string_view path, const serial_options& options = {}) {
  const auto port = serial_port::open(path, options);
  EXPECT_FALSE(port);
  return port.error().code();
}

termios settings_of(const pty& device) {
  termios now{};
  EXPECT_EQ(::tcgetattr(device.keep(), &now), 0);
  return now;
}

std::uint32_t rate_of(const pty& device) {
  return custom_baud(real_system_calls().ioctl, device.keep());
}

bool are_equal(const termios& one, const termios& other) {
  return one.c_iflag == other.c_iflag && one.c_oflag == other.c_oflag &&
         one.c_cflag == other.c_cflag && one.c_lflag == other.c_lflag &&
         std::memcmp(one.c_cc, other.c_cc, sizeof one.c_cc) == 0;
}

// ---- opening -----------------------------------------------------------------------------------

TEST(SerialPort, Open_IsRaw8N1AtTheRateOfAG4) {
  const pty device;
  termios odd = settings_of(device);
  odd.c_cflag |= static_cast<tcflag_t>(CSTOPB | PARENB | CRTSCTS);
  odd.c_iflag |= static_cast<tcflag_t>(IXOFF | ISTRIP | PARMRK);
  ASSERT_EQ(::tcsetattr(device.keep(), TCSANOW, &odd), 0);
  const auto port = opened(device);
  const termios now = settings_of(device);
  EXPECT_EQ(::cfgetospeed(&now), B230400);
  EXPECT_EQ(now.c_cflag & static_cast<tcflag_t>(CSIZE | PARENB | CSTOPB | CRTSCTS), tcflag_t{CS8});
  EXPECT_EQ(now.c_cflag & static_cast<tcflag_t>(CREAD | CLOCAL), tcflag_t{CREAD | CLOCAL});
  EXPECT_EQ(now.c_lflag & static_cast<tcflag_t>(ICANON | ECHO | ISIG | IEXTEN), 0U);
  EXPECT_EQ(now.c_iflag & static_cast<tcflag_t>(IXON | IXOFF | ICRNL | ISTRIP | PARMRK), 0U);
  EXPECT_EQ(now.c_oflag & static_cast<tcflag_t>(OPOST), 0U);
  EXPECT_EQ(port->baud(), 230400U);
  EXPECT_EQ(port->name(), device.path());
  EXPECT_EQ(::fcntl(port->native_handle(), F_GETFD) & FD_CLOEXEC, FD_CLOEXEC);
}

TEST(SerialPort, AllBytes_PassUnchangedBothWays) {
  const pty device;
  const auto port = opened(device);
  std::string all;
  for (int byte = 0; byte < 256; ++byte) all.push_back(static_cast<char>(byte));
  device.send(all);
  EXPECT_EQ(read_text(*port, all.size()), all);
  ASSERT_TRUE(write_text(*port, all));
  EXPECT_EQ(device.receive(all.size()), all);
}

TEST(SerialPort, Close_RestoresTheSettings) {
  const pty device;
  termios odd = settings_of(device);
  odd.c_cflag |= static_cast<tcflag_t>(CSTOPB);
  odd.c_cc[VMIN] = 7;
  cfsetspeed(&odd, B19200);
  ASSERT_EQ(::tcsetattr(device.keep(), TCSANOW, &odd), 0);
  const termios found = settings_of(device);
  {
    const auto port = opened(device);
  }
  EXPECT_TRUE(are_equal(settings_of(device), found));
}

TEST(SerialPort, OpeningABusyPort_ChangesNothing) {
  const pty device;
  const auto port = opened(device);
  EXPECT_EQ(why_not(device.path(), {.baud = 9600}), problem::busy);
  EXPECT_EQ(rate_of(device), 230400U);  // set by the program that has it open
}

TEST(SerialPort, EarlierBytes_AreDiscarded) {
  const pty device;
  device.send("old\n");
  pollfd there{device.keep(), POLLIN, 0};
  ASSERT_EQ(::poll(&there, 1, patience_ms), 1);
  const auto port = opened(device);
  device.send("new");
  EXPECT_EQ(read_text(*port, 3), "new");
}

TEST(SerialPort, WrongOptions_AreRefused) {
  const pty device;
  EXPECT_EQ(why_not(""), problem::bad_option);
  EXPECT_EQ(why_not(device.path(), {.baud = 0}), problem::bad_option);
}

TEST(SerialPort, WrongKindsOfFile_AreRefused) {
  EXPECT_EQ(why_not("/dev/null"), problem::not_serial);
  EXPECT_EQ(why_not("/dev"), problem::not_serial);
  EXPECT_EQ(why_not("/dev/ptmx"), problem::not_serial) << "each opening makes a pseudo-terminal";
  const temporary_file file("bytes");
  EXPECT_EQ(why_not(file.path()), problem::not_serial);
  const std::string pipe = file.path() + ".pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(why_not(pipe), problem::not_serial);
  ::unlink(pipe.c_str());
  EXPECT_EQ(why_not("/dev/no-such-port"), problem::no_port);
  EXPECT_EQ(why_not(file.path() + "/port"), problem::no_port);
}

TEST(SerialPort, NoPermission_NamesTheGroup) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may open everything; see SerialCalls";
  const pty device;
  ASSERT_EQ(::chmod(device.path().c_str(), 0), 0);
  const auto port = serial_port::open(device.path());
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().code(), problem::permission);
  EXPECT_NE(port.error().subject().find(" of group "), std::string_view::npos);
}

TEST(SerialPort, LockedPort_IsBusyAndNamesTheProcess) {
  const pty device;
  auto first = opened(device);
  const auto second = serial_port::open(device.path());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code(), problem::busy);
  EXPECT_EQ(second.error().subject(),
            device.path() + ", held by port_tests (" + std::to_string(::getpid()) + ")");
  first.reset();
  EXPECT_TRUE(serial_port::open(device.path()));
}

TEST(SerialPort, ExclusivePort_IsBusyForRootToo) {
  const pty device;
  ASSERT_EQ(::ioctl(device.keep(), TIOCEXCL), 0);
  EXPECT_EQ(why_not(device.path()), problem::busy);
  ASSERT_EQ(::ioctl(device.keep(), TIOCNXCL), 0);
  EXPECT_TRUE(serial_port::open(device.path()));
}

TEST(SerialPort, NotExclusive_TwoMayOpen) {
  const pty device;
  const auto first = opened(device);
  EXPECT_TRUE(serial_port::open(device.path(), {.exclusive = false}));
}

TEST(SerialPort, OpenAndClose_LeavesNoDescriptor) {
  const pty device;
  const std::size_t before = open_descriptors();
  for (int i = 0; i < 100; ++i) {
    const auto port = opened(device);
    EXPECT_EQ(open_descriptors(), before + 2);
  }
  EXPECT_EQ(open_descriptors(), before);
}

// ---- waiting -----------------------------------------------------------------------------------

TEST(SerialPort, NoBytes_ReadEndsAtTheDeadline) {
  const pty device;
  const auto port = opened(device);
  std::array<std::uint8_t, 16> buffer{};
  const std::int64_t deadline_ns = in(*port, 30ms);
  const auto got = port->read(buffer, deadline_ns);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->count, 0U);
  EXPECT_GE(port->now_ns(), deadline_ns);
}

TEST(SerialPort, BytesArrive_ReadEndsAndPauseDoesNot) {
  const pty device;
  const auto port = opened(device);
  device.send("bytes");
  const std::int64_t until_ns = in(*port, 30ms);
  ASSERT_TRUE(port->pause(until_ns));
  EXPECT_GE(port->now_ns(), until_ns);
  EXPECT_EQ(read_text(*port, 5), "bytes");
}

TEST(SerialPort, Handle_IsReadableWhenBytesArrive) {
  const pty device;
  const auto port = opened(device);
  pollfd polled{port->native_handle(), POLLIN, 0};
  EXPECT_EQ(::poll(&polled, 1, 0), 0);
  device.send("x");
  EXPECT_EQ(::poll(&polled, 1, patience_ms), 1);
}

TEST(SerialPort, Wake_EndsTheNextCallOnce) {
  const pty device;
  const auto port = opened(device);
  std::array<std::uint8_t, 16> buffer{};
  port->wake();
  port->wake();
  EXPECT_EQ(port->read(buffer, in(*port, patience)).error().code(), problem::cancelled);
  EXPECT_EQ(port->read(buffer, in(*port, 1ms))->count, 0U);
  port->wake();
  EXPECT_EQ(write_text(*port, "x").error().code(), problem::cancelled);
  EXPECT_TRUE(write_text(*port, "x"));
  port->wake();
  const auto paused = port->pause(in(*port, patience));
  EXPECT_EQ(paused.error().code(), problem::cancelled);
  EXPECT_FALSE(paused.error().is_fatal());
  EXPECT_TRUE(port->pause(in(*port, 1ms)));
}

TEST(SerialPort, WakeWithBytesWaiting_IsSeenFirst) {
  const pty device;
  const auto port = opened(device);
  device.send("0123456789");
  std::array<std::uint8_t, 4> buffer{};
  ASSERT_EQ(port->read(buffer, in(*port, patience))->count, 4U);  // more is known to wait
  port->wake();
  EXPECT_EQ(port->read(buffer, in(*port, patience)).error().code(), problem::cancelled);
  ASSERT_EQ(port->read(buffer, in(*port, patience))->count, 4U);
  port->wake();
  EXPECT_EQ(port->read(buffer, port->now_ns()).error().code(), problem::cancelled);
  EXPECT_EQ(port->read(buffer, port->now_ns())->count, 2U);
}

TEST(SerialPort, WakeFromAnotherThread_EndsWaiting) {
  const pty device;
  const auto port = opened(device);
  std::array<std::uint8_t, 16> buffer{};
  for (int i = 0; i < 200; ++i) {
    std::thread other([&] { port->wake(); });
    const auto got = port->read(buffer, never_ns);
    other.join();
    ASSERT_FALSE(got);
    ASSERT_EQ(got.error().code(), problem::cancelled);
    ASSERT_EQ(port->read(buffer, in(*port, 100us))->count, 0U) << "only once";
  }
}

transport* woken_by_signal = nullptr;

TEST(SerialPort, WakeFromASignalHandler_EndsWaiting) {
  const pty device;
  const auto port = opened(device);
  woken_by_signal = port.get();
  struct sigaction action{};
  struct sigaction before{};
  action.sa_handler = [](int) { woken_by_signal->wake(); };
  ASSERT_EQ(::sigaction(SIGALRM, &action, &before), 0);
  const itimerval soon{{0, 0}, {0, 20'000}};
  ASSERT_EQ(::setitimer(ITIMER_REAL, &soon, nullptr), 0);
  std::array<std::uint8_t, 16> buffer{};
  EXPECT_EQ(port->read(buffer, never_ns).error().code(), problem::cancelled);
  ::sigaction(SIGALRM, &before, nullptr);
}

TEST(SerialPort, SignalsWithoutAWake_DoNotEndWaiting) {
  const pty device;
  const auto port = opened(device);
  struct sigaction action{};
  struct sigaction before{};
  action.sa_handler = [](int) {};  // without SA_RESTART
  ASSERT_EQ(::sigaction(SIGALRM, &action, &before), 0);
  const itimerval often{{0, 1000}, {0, 1000}};
  const itimerval never{};
  ASSERT_EQ(::setitimer(ITIMER_REAL, &often, nullptr), 0);
  const std::int64_t until_ns = in(*port, 50ms);
  EXPECT_TRUE(port->pause(until_ns));
  EXPECT_GE(port->now_ns(), until_ns);
  ::setitimer(ITIMER_REAL, &never, nullptr);
  ::sigaction(SIGALRM, &before, nullptr);
}

}  // namespace
}  // namespace g4lidar::test
