// SPDX-License-Identifier: MIT
// Opens the socket of a server.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "cli/exit_code.hpp"

namespace g4_tool {

/// Owns a descriptor.
class socket_fd {
 public:
  explicit socket_fd(int fd = -1) noexcept : fd_(fd) {}
  socket_fd(socket_fd&& other) noexcept : fd_(other.release()) {}
  socket_fd& operator=(socket_fd&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~socket_fd();

  [[nodiscard]] int get() const noexcept { return fd_; }
  [[nodiscard]] int release() noexcept { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

/// Listens at a numeric `address`. `port` 0: any. Throws a bad_value for another form of address, and a failure if the
/// address and port cannot be used.
[[nodiscard]] socket_fd listen_at(const std::string& address, std::uint16_t port);
/// The port of a socket.
[[nodiscard]] std::uint16_t port_of(const socket_fd& socket);
/// The failure for a system call that failed with the error number `why`.
[[nodiscard]] failure refused_by_system(std::string_view what, int why);

}  // namespace g4_tool
