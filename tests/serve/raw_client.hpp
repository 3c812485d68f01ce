// SPDX-License-Identifier: MIT
// A client of a web server that sends what no library would, and reads what comes.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "support/patience.hpp"

namespace serve {

/// One connection to loopback. Nothing waits longer than `patience` for the server.
class raw_client {
 public:
  explicit raw_client(std::uint16_t port) : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_connected_ = ::connect(fd_, reinterpret_cast<const sockaddr*>(&place), sizeof(place)) == 0;
  }
  raw_client(raw_client&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)),
        is_connected_(other.is_connected_),
        got_(std::move(other.got_)) {}
  raw_client& operator=(raw_client&&) = delete;
  ~raw_client() {
    if (fd_ >= 0) ::close(fd_);
  }

  [[nodiscard]] bool is_connected() const { return is_connected_; }
  /// As much as the server takes.
  void send(std::string_view data) const {
    while (!data.empty()) {
      pollfd ready{fd_, POLLOUT, 0};
      if (::poll(&ready, 1, g4lidar::test::patience_ms) <= 0) return;
      const ssize_t sent = ::send(fd_, data.data(), data.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent <= 0) return;
      data.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
  /// Everything up to and with `end`; what came where it never does.
  std::string read_until(std::string_view end) {
    while (got_.find(end) == std::string::npos && read_some()) continue;
    const std::size_t at = got_.find(end);
    const std::size_t size = at == std::string::npos ? got_.size() : at + end.size();
    std::string text = got_.substr(0, size);
    got_.erase(0, size);
    return text;
  }
  /// Reads until the server closes it. Returns all that came; nothing if it does not.
  std::optional<std::string> read_to_end() {
    while (read_some()) continue;
    if (!is_closed_) return std::nullopt;
    return std::exchange(got_, {});
  }
  /// Whether the server has closed it. Does not wait.
  [[nodiscard]] bool has_ended() {
    pollfd ready{fd_, POLLIN, 0};
    while (!is_closed_ && ::poll(&ready, 1, 0) > 0) read_some();
    return is_closed_;
  }
  [[nodiscard]] std::string get(std::string_view path, std::string_view more = {}) {
    send("GET " + std::string(path) + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" +
         std::string(more) + "\r\n");
    return read_to_end().value_or("no end");
  }

  // ---- WebSockets ----

  /// Asks for one; the headers of the answer.
  std::string upgrade(std::string_view subprotocol, std::string_view more = "Host: localhost\r\n") {
    send(upgrade_request(subprotocol, more));
    return read_until("\r\n\r\n");
  }
  static std::string upgrade_request(std::string_view subprotocol,
                                     std::string_view more = "Host: localhost\r\n") {
    return "GET / HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
           "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
           "Sec-WebSocket-Protocol: " +
           std::string(subprotocol) + "\r\n" + std::string(more) + "\r\n";
  }
  /// A masked frame, with a mask of zeros; `length`: the length in its header.
  static std::string frame(std::uint8_t opcode, std::string_view payload,
                           std::optional<std::uint64_t> length = {}) {
    const std::uint64_t size = length.value_or(payload.size());
    std::string made(1, static_cast<char>(0x80U | opcode));
    // RFC 6455, 5.2: the length takes as few bytes as possible.
    const int wide = size < 126 ? 0 : size < 65'536 ? 2 : 8;
    made += static_cast<char>(0x80U | (wide == 0 ? size : wide == 2 ? 126U : 127U));
    for (int i = wide - 1; i >= 0; --i) made += static_cast<char>(size >> (8 * i));
    return made + std::string(4, '\0') + std::string(payload);
  }
  void send_text(std::string_view text) const { send(frame(1, text)); }
  /// The payload of the next frame of the server; nothing if it closes.
  std::optional<std::string> next_frame() {
    while (true) {
      if (const auto whole = take_frame()) return *whole;
      if (!read_some()) return std::nullopt;
    }
  }

 private:
  std::optional<std::string> take_frame() {
    const auto byte = [this](std::size_t at) { return static_cast<unsigned char>(got_[at]); };
    if (got_.size() < 2) return std::nullopt;
    std::size_t head = 2;
    std::size_t size = byte(1);
    if (size >= 126) {
      const std::size_t wide = size == 126 ? 2 : 8;
      if (got_.size() < 2 + wide) return std::nullopt;
      size = 0;
      for (std::size_t i = 0; i < wide; ++i) size = size << 8U | byte(2 + i);
      head += wide;
    }
    if (got_.size() < head + size) return std::nullopt;
    std::string payload = got_.substr(head, size);
    got_.erase(0, head + size);
    return payload;
  }

  bool read_some() {
    pollfd ready{fd_, POLLIN, 0};
    if (::poll(&ready, 1, g4lidar::test::patience_ms) <= 0) return false;
    char part[16'384];
    const ssize_t count = ::recv(fd_, part, sizeof(part), 0);
    is_closed_ = count <= 0;
    if (count > 0) got_.append(part, static_cast<std::size_t>(count));
    return count > 0;
  }

  int fd_;
  bool is_connected_ = false;
  bool is_closed_ = false;
  std::string got_;
};

}  // namespace serve
