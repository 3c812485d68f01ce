// SPDX-License-Identifier: MIT
// The rate of a serial port. Replaced system calls stand for bridges that make another rate than the one
// that was set, and for the line DTR.
#include <sys/ioctl.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "faulty_calls.hpp"
#include "port_io.hpp"
#include "pty.hpp"
#include "support/patience.hpp"
#include "transport/custom_baud.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

std::uint32_t rate_of(const pty& device) {
  return custom_baud(real_system_calls().ioctl, device.keep());
}

TEST(SerialPort, OtherRates_AreSet) {
  for (const std::uint32_t baud : {9600U, 115200U, 128000U, 153600U, 512000U, 921600U}) {
    const pty device;
    const auto port = opened(device, {.baud = baud});
    EXPECT_EQ(rate_of(device), baud);
    EXPECT_EQ(port->baud(), baud);
  }
}

TEST(SerialPort, ChangedRate_IsSetWithoutReopeningAndDiscardsTheInput) {
  const pty device;
  const auto port = opened(device);
  const int handle = port->native_handle();
  for (const std::uint32_t baud : {115200U, 128000U, 512000U, 230400U, 214285U}) {
    SCOPED_TRACE(baud);
    device.send("old");
    pollfd there{handle, POLLIN, 0};
    ASSERT_EQ(::poll(&there, 1, patience_ms), 1);
    EXPECT_EQ(port->set_baud(baud), true);
    EXPECT_EQ(rate_of(device), baud);
    EXPECT_EQ(port->baud(), baud);
    EXPECT_EQ(port->native_handle(), handle);
    device.send("new");
    EXPECT_EQ(read_text(*port, 3), "new");
    ASSERT_TRUE(write_text(*port, "out"));
    EXPECT_EQ(device.receive(3), "out");
  }
}

TEST(SerialPort, ChangedRate_CloseRestoresTheFirst) {
  const pty device;
  ASSERT_TRUE(set_custom_baud(real_system_calls().ioctl, device.keep(), 250'000));
  {
    const auto port = opened(device);
    ASSERT_TRUE(port->set_baud(128'000));
  }
  EXPECT_EQ(rate_of(device), 250'000U);
}

TEST(SerialPort, ChangedRate_ReadBufferThatWasFull_IsForgotten) {
  const pty device;
  const auto port = opened(device);
  device.send("12345678");
  pollfd there{port->native_handle(), POLLIN, 0};
  ASSERT_EQ(::poll(&there, 1, patience_ms), 1);
  std::array<std::uint8_t, 4> buffer{};
  ASSERT_EQ(port->read(buffer, in(*port, patience))->count, 4U);
  ASSERT_TRUE(port->set_baud(115'200));
  EXPECT_EQ(port->read(buffer, in(*port, 5ms))->count, 0U);
}

TEST(SerialPort, RateZero_IsRefused) {
  const pty device;
  const auto port = opened(device);
  const auto set = port->set_baud(0);
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().code(), problem::bad_baud_rate);
  EXPECT_EQ(port->baud(), 230400U);
}

TEST(SerialPort, PseudoTerminal_HasNoDtr) {
  const pty device;
  const auto port = opened(device);
  EXPECT_EQ(port->set_dtr(false), false);
  EXPECT_EQ(port->set_dtr(true), false);
}

TEST(SerialPort, Close_RestoresANonStandardRate) {
  const pty device;
  ASSERT_TRUE(set_custom_baud(real_system_calls().ioctl, device.keep(), 250'000));
  {
    const auto port = opened(device);
  }
  EXPECT_EQ(rate_of(device), 250'000U);
}

/// The size of the kernel's struct termios2, whose last member is the output rate.
constexpr std::size_t termios2_size = 44;
struct termios2_bytes {
  std::uint8_t all[termios2_size];
};
constexpr unsigned long get_termios2 = _IOR('T', 0x2A, termios2_bytes);

std::uint32_t rate_made = 0;       // that of the bridge; 0: as set
std::vector<unsigned long> lines;  // the requests about DTR
int line_errno = 0;                // how they fail
int line_interruptions = 0;        // how often they do before that

int bridge_ioctl(int fd, unsigned long request, void* argument) {
  if (request == TIOCMBIS || request == TIOCMBIC) {
    lines.push_back(request);
    EXPECT_EQ(*static_cast<int*>(argument), TIOCM_DTR);
    if (line_interruptions > 0) {
      --line_interruptions;
      errno = EINTR;
      return -1;
    }
    errno = line_errno;
    return line_errno == 0 ? 0 : -1;
  }
  const int got = real_system_calls().ioctl(fd, request, argument);
  if (request == get_termios2 && got == 0 && rate_made != 0) {
    std::memcpy(static_cast<termios2_bytes*>(argument)->all + termios2_size - sizeof rate_made,
                &rate_made, sizeof rate_made);
  }
  return got;
}

class Bridge : public testing::Test {
 public:
  Bridge() : calls_(real_system_calls()) {
    calls_.ioctl = bridge_ioctl;
    rate_made = 0;
    line_errno = 0;
    line_interruptions = 0;
    lines.clear();
  }

 protected:
  result<std::unique_ptr<transport>> open(std::uint32_t baud, bool leaves_dtr = false) {
    return open_serial_transport(device_.path(), {.baud = baud, .leave_dtr = leaves_dtr}, calls_);
  }
  [[nodiscard]] const pty& device() const noexcept { return device_; }

 private:
  system_calls calls_;
  pty device_;
};

struct made_rate {
  std::uint32_t asked;
  std::uint32_t made;
};

// AN205 of Silicon Labs, and the divisors of a CP2102N.
constexpr made_rate usable[] = {{512'000, 500'000}, {512'000, 510'638}, {128'000, 127'659},
                                {153'600, 153'846}, {230'400, 230'769}, {115'200, 115'384}};
constexpr made_rate unusable[] = {{512'000, 460'800}, {128'000, 115'200}, {153'600, 128'000}};

TEST_F(Bridge, RateNearTheOneThatWasSet_IsAcceptedAndKnown) {
  for (const auto& [asked, made] : usable) {
    rate_made = made;
    auto port = open(asked);
    ASSERT_TRUE(port) << port.error().message();
    EXPECT_EQ((*port)->baud(), made);
    port->reset();
    rate_made = 0;
    port = open(9600);
    ASSERT_TRUE(port);
    rate_made = made;
    EXPECT_EQ((*port)->set_baud(asked), true);
    EXPECT_EQ((*port)->baud(), made);
    rate_made = 0;
  }
}

TEST_F(Bridge, RateFarFromTheOneThatWasSet_IsRefused) {
  for (const auto& [asked, made] : unusable) {
    rate_made = made;
    const auto port = open(asked);
    ASSERT_FALSE(port) << asked;
    EXPECT_EQ(port.error().code(), problem::bad_baud_rate);
    rate_made = 0;
  }
}

TEST_F(Bridge, RefusedChange_LeavesAPortThatCanBeChanged) {
  auto port = open(230'400);
  ASSERT_TRUE(port);
  rate_made = 115'200;
  const auto changed = (*port)->set_baud(128'000);
  ASSERT_FALSE(changed);
  EXPECT_EQ(changed.error().code(), problem::bad_baud_rate);
  EXPECT_NE(changed.error().subject().find(" at 128000 baud"), std::string_view::npos);
  rate_made = 0;
  EXPECT_EQ((*port)->set_baud(115'200), true);
  EXPECT_EQ((*port)->baud(), 115'200U);
}

TEST_F(Bridge, Dtr_IsSetAndCleared) {
  const auto port = open(230'400);
  ASSERT_TRUE(port);
  line_interruptions = 3;
  EXPECT_EQ((*port)->set_dtr(true), true);
  EXPECT_EQ(lines, (std::vector<unsigned long>(4, TIOCMBIS)));
  lines.clear();
  EXPECT_EQ((*port)->set_dtr(false), true);
  EXPECT_EQ(lines, std::vector<unsigned long>{TIOCMBIC});
}

// ---- HUPCL: whether the system lowers DTR after the last close --------------------------------------

bool drops_dtr(const pty& device) {
  termios now{};
  EXPECT_EQ(::tcgetattr(device.keep(), &now), 0);
  return (now.c_cflag & HUPCL) != 0;
}

void set_dropping(const pty& device, bool wanted) {
  termios now{};
  ASSERT_EQ(::tcgetattr(device.keep(), &now), 0);
  now.c_cflag = wanted ? now.c_cflag | HUPCL : now.c_cflag & ~static_cast<tcflag_t>(HUPCL);
  ASSERT_EQ(::tcsetattr(device.keep(), TCSANOW, &now), 0);
}

TEST_F(Bridge, DtrThatWasRaised_StaysHighAfterTheClose_OnlyIfItIsKept) {
  for (const bool is_kept : {true, false}) {
    set_dropping(device(), true);
    {
      const auto port = open(230'400);
      ASSERT_TRUE(port);
      EXPECT_EQ((*port)->set_dtr(true), true);
      if (is_kept) (*port)->keep_dtr();
      EXPECT_TRUE(drops_dtr(device())) << "if the program is killed";
    }
    EXPECT_EQ(drops_dtr(device()), !is_kept);
  }
}

// An earlier program has kept the line, so the system would no longer lower it.
TEST_F(Bridge, DtrThatWasLoweredAgain_IsLoweredByTheSystem) {
  for (const bool is_dropped : {true, false}) {
    set_dropping(device(), is_dropped);
    {
      const auto port = open(230'400);
      ASSERT_TRUE(port);
      EXPECT_EQ((*port)->set_dtr(true), true);
      EXPECT_EQ((*port)->set_dtr(false), true);
      (*port)->keep_dtr();
    }
    EXPECT_TRUE(drops_dtr(device()));
  }
}

TEST_F(Bridge, OpenPort_LosesItsDtrWithTheProgram) {
  set_dropping(device(), false);
  {
    const auto port = open(230'400);
    ASSERT_TRUE(port);
    EXPECT_TRUE(drops_dtr(device()));
  }
  EXPECT_FALSE(drops_dtr(device())) << "as it was";
}

TEST_F(Bridge, DtrThatIsLeftAlone_KeepsTheRuleOfTheSystem) {
  for (const bool is_dropped : {true, false}) {
    set_dropping(device(), is_dropped);
    {
      const auto port = open(230'400, true);
      ASSERT_TRUE(port);
      EXPECT_EQ(drops_dtr(device()), is_dropped);
    }
    EXPECT_EQ(drops_dtr(device()), is_dropped);
  }
  EXPECT_TRUE(lines.empty());
}

TEST_F(Bridge, PortWithoutDtr_IsLeftAsItWas) {
  set_dropping(device(), true);
  line_errno = ENOTTY;
  {
    const auto port = open(230'400);
    ASSERT_TRUE(port);
    EXPECT_EQ((*port)->set_dtr(true), false);
    (*port)->keep_dtr();
  }
  EXPECT_TRUE(drops_dtr(device()));
}

TEST_F(Bridge, DtrThatIsMissing_IsNoError) {
  const auto port = open(230'400);
  ASSERT_TRUE(port);
  for (const int missing : {ENOTTY, EINVAL}) {
    line_errno = missing;
    EXPECT_EQ((*port)->set_dtr(true), false) << missing;
  }
}

TEST_F(Bridge, DtrOfAnUnpluggedPort_IsGone) {
  const auto port = open(230'400);
  ASSERT_TRUE(port);
  line_errno = EIO;
  const auto set = (*port)->set_dtr(true);
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().code(), problem::gone);
  EXPECT_EQ(set.error().doing(), task::configuring);
}

TEST(BaudDifference, IsInThousandths) {
  EXPECT_EQ(baud_difference(500'000, 512'000), 23U);  // 2.34 %
  EXPECT_EQ(baud_difference(512'000, 500'000), 24U);
  EXPECT_EQ(baud_difference(230'400, 230'400), 0U);
  EXPECT_TRUE(is_near(117'029, 115'200));
  EXPECT_FALSE(is_near(500'000, 512'000));
  EXPECT_TRUE(is_tolerable(500'000, 512'000));
  EXPECT_FALSE(is_tolerable(0, 512'000));
}

}  // namespace
}  // namespace g4lidar::test
