// SPDX-License-Identifier: MIT
#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <utility>

#include "served_port.hpp"
#include "transport/owned_fd.hpp"

namespace g4lidar::sim {
namespace {

class tcp_server final : public served_port {
 public:
  /// It is named by its address, "tcp:127.0.0.1:4000".
  tcp_server(owned_fd listener, std::string name)
      : listener_(std::move(listener)), name_(std::move(name)) {}

  [[nodiscard]] const std::string& name() const noexcept override { return name_; }
  [[nodiscard]] int handle() const noexcept override { return client_.get(); }
  [[nodiscard]] int watch() const noexcept override { return listener_.get(); }

  /// Accepts a client; further ones are refused.
  void look_for_clients() noexcept override {
    // At most so many at a time, even if programs connect continuously.
    for (int turn = 0; turn < 16; ++turn) {
      // The bytes of a program that has disconnected are read first: the next program waits for
      // that.
      pollfd present{handle(), POLLRDHUP, 0};
      if (client_ && ::poll(&present, 1, 0) > 0) return;
      owned_fd next(::accept4(watch(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
      if (!next) return;
      if (client_) continue;  // closed by this loop
      const int on = 1;
      ::setsockopt(next.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      client_ = std::move(next);
    }
  }

  [[nodiscard]] std::size_t read(std::span<std::uint8_t> out) noexcept override {
    if (!client_) return 0;
    const ssize_t count = ::recv(handle(), out.data(), out.size(), 0);
    if (count > 0) return static_cast<std::size_t>(count);
    if (count == 0 || (errno != EAGAIN && errno != EINTR)) client_.close();
    return 0;
  }

  std::size_t write(bytes data) noexcept override {
    if (!client_) return 0;
    return unwritten(
        data, [&](bytes rest) { return ::send(handle(), rest.data(), rest.size(), MSG_NOSIGNAL); });
  }

 private:
  owned_fd listener_;
  owned_fd client_;
  std::string name_;
};

}  // namespace

result<std::unique_ptr<served_port>> listen_at(const std::string& address, std::uint16_t port) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(port);
  if (::inet_pton(AF_INET, address.c_str(), &place.sin_addr) != 1) {
    return failure(task::opening, problem::bad_option, address);
  }
  owned_fd listener(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int on = 1;
  socklen_t size = sizeof place;
  auto* const generic = reinterpret_cast<sockaddr*>(&place);
  if (!listener || ::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) != 0 ||
      ::bind(listener.get(), generic, size) != 0 || ::listen(listener.get(), 64) != 0 ||
      ::getsockname(listener.get(), generic, &size) != 0) {
    return failure(task::opening, problem::system, "tcp:" + address + ":" + std::to_string(port),
                   errno);
  }
  return std::make_unique<tcp_server>(
      std::move(listener), "tcp:" + address + ":" + std::to_string(ntohs(place.sin_port)));
}

}  // namespace g4lidar::sim
