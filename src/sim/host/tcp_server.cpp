// SPDX-License-Identifier: MIT
#include "tcp_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>

namespace g4lidar::sim {

result<std::unique_ptr<served_port>> tcp_server::open(const std::string& address,
                                                      std::uint16_t port) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(port);
  if (::inet_pton(AF_INET, address.c_str(), &place.sin_addr) != 1) {
    return failure(task::opening, problem::bad_option, address);
  }
  auto made = std::make_unique<tcp_server>();
  made->listener_ = owned_fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int listener = made->listener_.get();
  const int on = 1;
  socklen_t size = sizeof place;
  auto* const generic = reinterpret_cast<sockaddr*>(&place);
  if (listener < 0 || ::setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
      ::bind(listener, generic, size) != 0 || ::listen(listener, 64) != 0 ||
      ::getsockname(listener, generic, &size) != 0) {
    return failure(task::opening, problem::system, "tcp:" + address + ":" + std::to_string(port),
                   errno);
  }
  made->name_ = "tcp:" + address + ":" + std::to_string(ntohs(place.sin_port));
  return made;
}

void tcp_server::look_for_clients() noexcept {
  // At most so many at a time, even if programs connect continuously.
  for (int turn = 0; turn < 16; ++turn) {
    // The bytes of a program that has disconnected are read first: the next program waits for that.
    pollfd present{client_.get(), POLLRDHUP, 0};
    if (client_ && ::poll(&present, 1, 0) > 0) return;
    owned_fd next(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!next) return;
    if (client_) continue;  // closed by this loop
    const int on = 1;
    ::setsockopt(next.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    client_ = std::move(next);
  }
}

std::size_t tcp_server::read(std::span<std::uint8_t> out) noexcept {
  if (!client_) return 0;
  const ssize_t count = ::recv(client_.get(), out.data(), out.size(), 0);
  if (count > 0) return static_cast<std::size_t>(count);
  if (count == 0 || (errno != EAGAIN && errno != EINTR)) client_.close();
  return 0;
}

std::size_t tcp_server::write(bytes data) noexcept {
  if (!client_) return 0;
  while (!data.empty()) {
    const ssize_t count = ::send(client_.get(), data.data(), data.size(), MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    data = data.subspan(static_cast<std::size_t>(count));
  }
  return data.size();
}

}  // namespace g4lidar::sim
