// SPDX-License-Identifier: MIT
#include "transport/tcp_port.hpp"

#include <thread>

#include "listener.hpp"
#include "port_io.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

problem why_not(std::string_view address, const tcp_options& options = {}) {
  const auto port = tcp_port::open(address, options);
  EXPECT_FALSE(port);
  return port.error().code();
}

TEST(TcpPort, BytesGoBothWays) {
  listener bridge;
  auto port = tcp_port::open("tcp:" + bridge.address());
  ASSERT_TRUE(port) << port.error().message();
  bridge.accept();
  EXPECT_EQ((*port)->name(), "tcp:" + bridge.address());
  EXPECT_EQ((*port)->baud(), 230400U);
  ASSERT_TRUE(write_text(**port, "there"));
  EXPECT_EQ(bridge.receive(5), "there");
  bridge.send("and back");
  EXPECT_EQ(read_text(**port, 8), "and back");
}

TEST(TcpPort, Addresses_OfOtherForms) {
  listener bridge;
  const std::string address = bridge.address();
  const std::string number = address.substr(address.find(':'));
  EXPECT_TRUE(tcp_port::open("[127.0.0.1]" + number));
  EXPECT_TRUE(tcp_port::open("localhost" + number));
  for (const std::string_view wrong :
       {"", "tcp:", "host", "host:", ":3000", "tcp::3000", "fe80::1:3000", "[]:1"}) {
    EXPECT_EQ(why_not(wrong), problem::bad_option) << wrong;
  }
}

TEST(TcpPort, PortsThatDoNotExist_AreBadOptions) {
  for (const std::string_view wrong :
       {"99999", "65536", "0", "-1", "+1", " 1", "1 ", "1x", "0x10", "http", "tcpmux"}) {
    const std::string address = "tcp:127.0.0.1:" + std::string(wrong);
    const auto refused = tcp_port::open(address);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error(), problem::bad_option) << wrong;
    EXPECT_NE(
        refused.error().message().find(address + ", not tcp:host:port with a port of 1 to 65535"),
        std::string::npos)
        << refused.error().message();
  }
}

TEST(TcpPort, NoListener_CannotConnect) {
  listener bridge;
  bridge.close();
  const auto port = tcp_port::open(bridge.address());
  ASSERT_FALSE(port);
  EXPECT_EQ(port.error().code(), problem::cannot_connect);
  EXPECT_EQ(port.error().system_errno(), ECONNREFUSED);
  EXPECT_EQ(why_not("no-such-host.invalid:3000"), problem::cannot_connect);
}

TEST(TcpPort, NoAccept_EndsAtTheDeadline) {
  // A queue of one, without accept(): further connections get no answer.
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof here;
  auto* address = reinterpret_cast<sockaddr*>(&here);
  ASSERT_EQ(::bind(socket, address, size), 0);
  ASSERT_EQ(::listen(socket, 0), 0);
  ASSERT_EQ(::getsockname(socket, address, &size), 0);
  const std::string name = "127.0.0.1:" + std::to_string(ntohs(here.sin_port));
  const auto first = tcp_port::open(name);
  const auto began = std::chrono::steady_clock::now();
  const auto second = tcp_port::open(name, {.connect_timeout = 50ms});
  const auto third = tcp_port::open(name, {.connect_timeout = 50ms});
  EXPECT_LT(std::chrono::steady_clock::now() - began, patience);
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().code(), problem::cannot_connect);
  EXPECT_EQ(third.error().system_errno(), ETIMEDOUT);
  ::close(socket);
}

TEST(TcpPort, ClosedByTheOtherEnd_IsEndOfInputBehindTheLastByte) {
  listener bridge;
  auto port = tcp_port::open(bridge.address());
  ASSERT_TRUE(port);
  bridge.accept();
  bridge.send("last words");
  bridge.hang_up();
  EXPECT_EQ(read_text(**port, 10), "last words");
  EXPECT_EQ(read_text(**port, 1).error().code(), problem::end_of_input);
}

TEST(TcpPort, Broken_IsGoneAndNoSignal) {
  listener bridge;
  auto port = tcp_port::open(bridge.address());
  ASSERT_TRUE(port);
  bridge.accept();
  bridge.reset();
  EXPECT_EQ((*port)->pause(in(**port, patience)).error().code(), problem::gone);
  EXPECT_EQ(read_text(**port, 1).error().code(), problem::gone);
  EXPECT_EQ(write_text(**port, "x").error().code(), problem::gone);
}

TEST(TcpPort, Wake_EndsWaiting) {
  listener bridge;
  auto port = tcp_port::open(bridge.address());
  ASSERT_TRUE(port);
  bridge.accept();
  std::thread other([&] { (*port)->wake(); });
  std::array<std::uint8_t, 16> buffer{};
  EXPECT_EQ((*port)->read(buffer, never_ns).error().code(), problem::cancelled);
  other.join();
}

TEST(TcpPort, OtherEndDoesNotRead_WriteTimesOut) {
  listener bridge;
  auto port = tcp_port::open(bridge.address());
  ASSERT_TRUE(port);
  bridge.accept();
  const std::vector<std::uint8_t> much(64'000'000);
  const auto sent = (*port)->write(much, in(**port, 200ms));
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().code(), problem::timeout);
  EXPECT_EQ(sent.error().detail(), error_detail::not_sent);
}

}  // namespace
}  // namespace g4lidar::test
