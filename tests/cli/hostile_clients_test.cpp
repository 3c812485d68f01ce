// SPDX-License-Identifier: MIT
// Clients of `g4-dump sim --tcp` that behave badly: the next one is served all the same.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "program.hpp"
#include "support/patience.hpp"

namespace {

using cli::outcome;
using cli::run;
using g4lidar::test::comes_true;
using ::testing::HasSubstr;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

/// A connection to the bridge.
class client {
 public:
  explicit client(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_connected_ =
        ::connect(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0;
    ::fcntl(socket_, F_SETFL, O_NONBLOCK);
  }
  client(const client&) = delete;
  client& operator=(const client&) = delete;
  ~client() { ::close(socket_); }

  [[nodiscard]] bool is_connected() const { return is_connected_; }
  /// As much of it as is taken at once.
  std::size_t send(std::string_view data) const {
    const ssize_t count = ::send(socket_, data.data(), data.size(), MSG_NOSIGNAL);
    return count > 0 ? static_cast<std::size_t>(count) : 0;
  }
  /// Waits for the first bytes; empty where there is none within `patience`.
  [[nodiscard]] std::string receive() const {
    pollfd waiting{socket_, POLLIN, 0};
    char part[256];
    if (::poll(&waiting, 1, g4lidar::test::patience_ms) <= 0) return {};
    const ssize_t count = ::recv(socket_, part, sizeof part, 0);
    return count > 0 ? std::string(part, static_cast<std::size_t>(count)) : std::string();
  }
  /// Breaks the connection at its end instead of closing it.
  void resets() const {
    const linger now{1, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
  }

 private:
  int socket_;
  bool is_connected_ = false;
};

class HostileClient : public cli::scratch {
 protected:
  void SetUp() override {
    bridge_.emplace(std::vector<std::string>{"sim", "--tcp", "0"},
                    cli::streams{{}, {}, cli::stream::of_file(path("err"))});
    std::string output;
    static_cast<void>(comes_true([&] {
      if (fs::exists(path("err"))) output = cli::read_file(path("err"));
      return output.ends_with('\n');
    }));
    const std::size_t colon = output.rfind(':');
    ASSERT_TRUE(output.starts_with("G4 2021101000070073 at tcp:127.0.0.1:")) << output;
    port_ = static_cast<std::uint16_t>(std::stoi(output.substr(colon + 1)));
  }

  [[nodiscard]] std::string source() const { return "tcp:127.0.0.1:" + std::to_string(port_); }

  /// The next client gets the device, and points of it.
  void expect_it_serves() {
    // It refuses others until it has read all that the last one has sent before its end.
    outcome info;
    static_cast<void>(comes_true([&] {
      info = run({"info", source()});
      return info.code != 9;
    }));
    EXPECT_EQ(info.code, 0) << info.err;
    EXPECT_THAT(info.out, HasSubstr("serial      2021101000070073\n"));
    const outcome points = run({"dump", source(), "-n", "2000", "-f", "csv"});
    EXPECT_EQ(points.code, 0) << points.err;
    EXPECT_EQ(cli::lines_of(points.out).size(), 2001U);
    bridge_->send(SIGTERM);
    EXPECT_EQ(bridge_->wait().code, 128 + SIGTERM);
  }

  std::optional<cli::program> bridge_;
  std::uint16_t port_ = 0;
};

TEST_F(HostileClient, FloodsItWithCommands) {
  std::string flood;
  for (int i = 0; i < 20'000; ++i) flood += "\xA5\x90\xA5\x91xxxxxxxx";
  {
    const client one(port_);
    ASSERT_TRUE(one.is_connected());
    std::size_t sent = 0;
    EXPECT_TRUE(comes_true([&] { return (sent += one.send(flood)) >= 4'000'000; }))
        << "it takes what it is sent: " << sent;
  }
  expect_it_serves();
}

TEST_F(HostileClient, NeverReads) {
  {
    const client one(port_);
    ASSERT_EQ(one.send("\xA5\x60"), 2U);
    std::this_thread::sleep_for(500ms);
    std::string questions;
    for (int i = 0; i < 5'000; ++i) questions += "\xA5\x65\xA5\x90";
    for (int i = 0; i < 100; ++i) {  // answers enough for every buffer
      static_cast<void>(one.send(questions));
      std::this_thread::sleep_for(2ms);
    }
  }
  expect_it_serves();
}

TEST_F(HostileClient, ConnectsAgainAndAgain) {
  cli::program dump({"dump", source(), "-n", "9000", "-f", "csv"});
  dump.read_until("\n");
  // One client at a time: all the others are turned away, and the one is not disturbed.
  for (int i = 0; i < 200; ++i) EXPECT_TRUE(client(port_).is_connected());
  const outcome done = dump.wait();
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(cli::lines_of(done.out).size(), 9001U);
  expect_it_serves();
}

TEST_F(HostileClient, DisconnectsDuringAnAnswer) {
  for (int i = 0; i < 50; ++i) {
    const client one(port_);
    one.resets();
    ASSERT_TRUE(one.is_connected());
    ASSERT_EQ(one.send(i % 2 == 0 ? "\xA5\x90" : "\xA5\x60"), 2U);
    if (i % 5 == 0) static_cast<void>(one.receive());
  }
  expect_it_serves();
}

}  // namespace
