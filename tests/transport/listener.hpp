// SPDX-License-Identifier: MIT
// The other end of a connection: a bridge on this computer, at a port that the system chooses.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <string_view>

#include "support/patience.hpp"

namespace g4lidar::test {

class listener {
 public:
  listener() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof here;
    auto* address = reinterpret_cast<sockaddr*>(&here);
    EXPECT_EQ(::bind(socket_, address, size), 0);
    EXPECT_EQ(::listen(socket_, 4), 0);
    EXPECT_EQ(::getsockname(socket_, address, &size), 0);
    port_ = ntohs(here.sin_port);
  }
  listener(const listener&) = delete;
  listener& operator=(const listener&) = delete;
  ~listener() {
    hang_up();
    close();
  }

  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  void accept() { peer_ = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC); }
  /// Closes the listening port: further connections are refused.
  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }
  void hang_up() {
    if (peer_ >= 0) ::close(peer_);
    peer_ = -1;
  }
  /// Resets the connection.
  void reset() {
    const linger now{1, 0};
    ::setsockopt(peer_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    hang_up();
  }

  void send(std::string_view text) const {
    EXPECT_EQ(::send(peer_, text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }
  [[nodiscard]] std::string receive(std::size_t size) const {
    std::string all;
    char piece[4096];
    pollfd polled{peer_, POLLIN, 0};
    while (all.size() < size && ::poll(&polled, 1, patience_ms) > 0) {
      const ssize_t got = ::read(peer_, piece, sizeof piece);
      if (got <= 0) break;
      all.append(piece, static_cast<std::size_t>(got));
    }
    return all;
  }

 private:
  int socket_;
  int peer_ = -1;
  std::uint16_t port_ = 0;
};

}  // namespace g4lidar::test
