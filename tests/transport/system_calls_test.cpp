// SPDX-License-Identifier: MIT
// Each system call of a port fails in turn, and the port handles it.
#include <cerrno>
#include <vector>

#include "faulty_calls.hpp"
#include "listener.hpp"
#include "port_io.hpp"
#include "pty.hpp"
#include "support/patience.hpp"
#include "temporary_file.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

/// A command, an answer, another rate, DTR and a pause, with the device at the other end.
template <class Device>
result<void> talk(transport& port, const Device& device) {
  if (auto sent = write_text(port, "question"); !sent) return sent;
  EXPECT_EQ(device.receive(8), "question");
  device.send("answer");
  const auto got = read_text(port, 6);
  if (!got) return tl::unexpected(got.error());
  EXPECT_EQ(*got, "answer");
  if (const auto set = port.set_baud(115'200); !set) return tl::unexpected(set.error());
  if (const auto set = port.set_dtr(true); !set) return tl::unexpected(set.error());
  return port.pause(in(port, 1ms));
}

struct serial_use {
  pty device;
  static constexpr std::array uses{call::open,    call::close,   call::stat,      call::fstat,
                                   call::flock,   call::ioctl,   call::tcgetattr, call::tcsetattr,
                                   call::tcflush, call::eventfd, call::ppoll,     call::read,
                                   call::write};

  result<void> use(const serial_options& options = {}) const {
    auto port = open_serial_transport(device.path(), options, faulty_calls());
    if (!port) return tl::unexpected(port.error());
    return talk(**port, device);
  }
};

struct tcp_use {
  listener device;
  static constexpr std::array uses{call::close,  call::eventfd, call::ppoll,      call::read,
                                   call::socket, call::connect, call::setsockopt, call::send};

  result<void> use() {
    auto port = open_connection(device.address(), {}, faulty_calls());
    if (!port) return tl::unexpected(port.error());
    device.accept();
    auto used = talk(**port, device);
    device.hang_up();
    return used;
  }
};

template <class Use>
class SystemCalls : public testing::Test {
 public:
  ~SystemCalls() override { set_fault({}); }
};

using uses = testing::Types<serial_use, tcp_use>;
TYPED_TEST_SUITE(SystemCalls, uses);

/// Uses the port with the fault; no descriptor is left open in any case.
template <class Use>
result<void> use_with(const fault& wrong) {
  Use port;
  const std::size_t before = open_descriptors();
  set_fault(wrong);
  auto used = port.use();
  EXPECT_EQ(open_descriptors(), before);
  return used;
}

TYPED_TEST(SystemCalls, AllAreUsed) {
  const auto used = use_with<TypeParam>({});
  ASSERT_TRUE(used) << used.error().message();
  for (const call which : TypeParam::uses) EXPECT_GT(made(which), 0) << name_of(which);
}

TYPED_TEST(SystemCalls, InterruptedThreeTimes_Continues) {
  for (const call which : TypeParam::uses) {
    SCOPED_TRACE(name_of(which));
    const auto used = use_with<TypeParam>({.which = which, .system_errno = EINTR, .times = 3});
    EXPECT_TRUE(used) << used.error().message();
    // These two have completed despite the signal, and must not be called again.
    if (which != call::close && which != call::connect) {
      EXPECT_GT(made(which), 3);
    }
  }
}

TYPED_TEST(SystemCalls, OneByteAtATime_Everything) {
  for (const call which : {call::read, call::write, call::send}) {
    SCOPED_TRACE(name_of(which));
    const auto used = use_with<TypeParam>({.which = which, .at_most = 1});
    EXPECT_TRUE(used) << used.error().message();
  }
}

TYPED_TEST(SystemCalls, CloseFails_IsNotCalledAgain) {
  set_fault({});
  ASSERT_TRUE(use_with<TypeParam>({}));
  const int closed = made(call::close);
  EXPECT_TRUE(use_with<TypeParam>({.which = call::close, .system_errno = EIO, .times = 9}));
  EXPECT_EQ(made(call::close), closed);
}

// ---- hard errors ---------------------------------------------------------------------------------

struct reported {
  call which;
  int system_errno;
  task doing;
  problem what;
};

template <class Use>
void expect_reported(const std::vector<reported>& cases) {
  for (const reported& one : cases) {
    SCOPED_TRACE(std::string(name_of(one.which)) + " " + strerrorname_np(one.system_errno));
    const auto used =
        use_with<Use>({.which = one.which, .system_errno = one.system_errno, .times = 1});
    ASSERT_FALSE(used);
    EXPECT_EQ(used.error().code(), one.what) << used.error().message();
    EXPECT_EQ(used.error().doing(), one.doing) << used.error().message();
    // The library's own decisions have no error number.
    if (used.error() == problem::system) {
      EXPECT_EQ(used.error().system_errno(), one.system_errno);
    }
    EXPECT_FALSE(used.error().subject().empty());
  }
}

TEST(SerialCalls, Failing_IsReported) {
  expect_reported<serial_use>({
      {call::stat, ENOENT, task::opening, problem::no_port},
      {call::stat, EACCES, task::opening, problem::permission},
      {call::open, EACCES, task::opening, problem::permission},
      {call::open, EPERM, task::opening, problem::permission},
      {call::open, EBUSY, task::opening, problem::busy},
      {call::open, ENXIO, task::opening, problem::no_port},
      {call::open, EIO, task::opening, problem::no_port},
      {call::open, EMFILE, task::opening, problem::system},
      {call::eventfd, EMFILE, task::opening, problem::system},
      {call::tcgetattr, ENOTTY, task::opening, problem::not_serial},
      {call::tcgetattr, EIO, task::opening, problem::no_port},
      {call::flock, EWOULDBLOCK, task::opening, problem::busy},
      {call::flock, ENOLCK, task::opening, problem::system},
      {call::tcgetattr, EINVAL, task::opening, problem::not_serial},
      {call::tcsetattr, EINVAL, task::opening, problem::system},
      {call::tcsetattr, EIO, task::opening, problem::no_port},
      {call::tcflush, EIO, task::opening, problem::no_port},
      {call::ppoll, ENOMEM, task::reading, problem::system},
      {call::read, EIO, task::reading, problem::gone},
      {call::read, ENODEV, task::reading, problem::gone},
      {call::read, ENXIO, task::reading, problem::gone},
      {call::read, EINVAL, task::reading, problem::system},
      {call::write, EIO, task::writing, problem::gone},
      {call::write, EINVAL, task::writing, problem::system},
  });
}

TEST(SerialCalls, OptionalCallsFail_StillOpens) {
  for (const call which : {call::fstat, call::ioctl}) {
    const auto used = use_with<serial_use>({.which = which, .system_errno = ENOTTY, .times = 1000});
    EXPECT_TRUE(used) << used.error().message();
  }
  set_fault({});
}

TEST(SerialCalls, NotACharacterDevice_IsNotOpened) {
  const temporary_file file("bytes");
  set_fault({});
  EXPECT_EQ(open_serial_transport(file.path(), {}, faulty_calls()).error().code(),
            problem::not_serial);
  EXPECT_EQ(made(call::stat), 1);
  EXPECT_EQ(made(call::open), 0);
}

TEST(SerialCalls, NonStandardRate_NeedsIoctl) {
  const serial_use port;
  set_fault({});
  EXPECT_TRUE(port.use({.baud = 250'000}));
  set_fault({.which = call::ioctl, .system_errno = ENOTTY, .times = 1000});
  const auto used = port.use({.baud = 250'000});
  ASSERT_FALSE(used);
  EXPECT_EQ(used.error().code(), problem::bad_baud_rate);
  EXPECT_EQ(used.error().subject(), port.device.path() + " at 250000 baud");
  set_fault({});
}

TEST(SerialCalls, NonStandardRate_InterruptedThreeTimes_IsSet) {
  const pty device;
  auto port = open_serial_transport(device.path(), {}, faulty_calls());
  ASSERT_TRUE(port);
  for (const call which : {call::ioctl, call::tcsetattr, call::tcgetattr, call::tcflush}) {
    SCOPED_TRACE(name_of(which));
    ASSERT_TRUE((*port)->set_baud(230'400));
    set_fault({.which = which, .system_errno = EINTR, .times = 3});
    EXPECT_EQ((*port)->set_baud(128'000), true);
    EXPECT_EQ((*port)->baud(), 128'000U);
    set_fault({});
  }
}

TEST(SerialCalls, OpenFailsLate_RestoresTheSettings) {
  const serial_use port;
  set_fault({.which = call::tcflush, .system_errno = ENOMEM, .times = 1});
  ASSERT_FALSE(port.use());
  set_fault({});
  termios now{};
  ASSERT_EQ(::tcgetattr(port.device.keep(), &now), 0);
  EXPECT_EQ(::cfgetospeed(&now), B38400);
  EXPECT_NE(now.c_lflag & static_cast<tcflag_t>(ICANON), 0U);
}

TEST(SerialCalls, FullOutput_TimesOut) {
  const pty device;
  auto port = open_serial_transport(device.path(), {}, faulty_calls());
  ASSERT_TRUE(port);
  ASSERT_EQ(::tcflow(device.keep(), TCOOFF), 0);  // the output of the slave is suspended
  const auto sent = (*port)->write(std::array<std::uint8_t, 2>{0xA5, 0x65}, in(**port, 20ms));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code(), problem::timeout);
  EXPECT_EQ(sent.error().detail(), error_detail::not_sent);
  EXPECT_FALSE(sent.error().is_fatal());
  ASSERT_EQ(::tcflow(device.keep(), TCOON), 0);
  EXPECT_TRUE((*port)->write(std::array<std::uint8_t, 2>{0xA5, 0x65}, in(**port, patience)));
}

TEST(TcpCalls, Failing_IsReported) {
  expect_reported<tcp_use>({
      {call::eventfd, EMFILE, task::opening, problem::system},
      {call::socket, EMFILE, task::opening, problem::system},
      {call::socket, EAFNOSUPPORT, task::opening, problem::cannot_connect},
      {call::connect, ECONNREFUSED, task::opening, problem::cannot_connect},
      {call::connect, ENETUNREACH, task::opening, problem::cannot_connect},
      {call::ppoll, ENOMEM, task::opening, problem::system},  // it waits for the connection first
      {call::read, ECONNRESET, task::reading, problem::gone},
      {call::read, ETIMEDOUT, task::reading, problem::gone},
      {call::send, EPIPE, task::writing, problem::gone},
  });
}

// ---- the number of calls -----------------------------------------------------------------------

TEST(SerialCalls, Burst_TakesTwo) {
  const pty device;
  auto port = open_serial_transport(device.path(), {}, faulty_calls());
  ASSERT_TRUE(port);
  std::array<std::uint8_t, 512> buffer{};
  for (int burst = 0; burst < 20; ++burst) {
    device.send("a burst of bytes");
    set_fault({});
    const auto got = (*port)->read(buffer, in(**port, patience));
    ASSERT_TRUE(got);
    EXPECT_GT(got->count, 0U);
    EXPECT_LE(made(call::ppoll) + made(call::read), 2);
  }
}

TEST(SerialCalls, NoTimeToWait_TakesOne) {
  const pty device;
  auto port = open_serial_transport(device.path(), {}, faulty_calls());
  ASSERT_TRUE(port);
  std::array<std::uint8_t, 512> buffer{};
  set_fault({});
  EXPECT_EQ((*port)->read(buffer, (*port)->now_ns())->count, 0U);
  EXPECT_EQ(made(call::ppoll), 0);
  EXPECT_EQ(made(call::read), 1);
}

TEST(SerialCalls, FilledBuffer_ReadsAgainWithoutPoll) {
  const pty device;
  auto port = open_serial_transport(device.path(), {}, faulty_calls());
  ASSERT_TRUE(port);
  device.send("0123456789");
  std::array<std::uint8_t, 4> buffer{};
  pollfd all_there{(*port)->native_handle(), POLLIN, 0};
  ASSERT_EQ(::poll(&all_there, 1, patience_ms), 1);
  set_fault({});
  EXPECT_EQ((*port)->read(buffer, in(**port, patience))->count, 4U);
  EXPECT_EQ((*port)->read(buffer, in(**port, patience))->count, 4U);
  EXPECT_EQ((*port)->read(buffer, in(**port, patience))->count, 2U);
  EXPECT_EQ(made(call::ppoll), 1);
  EXPECT_EQ(made(call::read), 3);
  EXPECT_EQ((*port)->read(buffer, in(**port, 1ms))->count, 0U);
  EXPECT_EQ(made(call::ppoll), 2);
}

TEST(SerialCalls, Waiting_IsOneCall) {
  const pty device;
  auto port = open_serial_transport(device.path(), {}, faulty_calls());
  ASSERT_TRUE(port);
  std::array<std::uint8_t, 512> buffer{};
  set_fault({});
  EXPECT_EQ((*port)->read(buffer, in(**port, 50ms))->count, 0U);
  EXPECT_TRUE((*port)->pause(in(**port, 50ms)));
  EXPECT_LE(made(call::ppoll) + made(call::read), 4);  // the kernel may wake a little early
}

}  // namespace
}  // namespace g4lidar::test
