// SPDX-License-Identifier: MIT
#include "listener.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "cli/logger.hpp"
#include "cli/verbs.hpp"

namespace g4_tool {

socket_fd::~socket_fd() {
  if (fd_ >= 0) ::close(fd_);
}

failure refused_by_system(std::string_view what, int why) {
  std::string text = fmt::format("{}: {}.", what, std::generic_category().message(why));
  if (why == EMFILE) text += " This process may open too few files: see ulimit -n.";
  if (why == ENFILE) text += " The whole system has too many open files.";
  return failure(exit_code::internal, text);
}

socket_fd listen_at(const std::string& address, std::uint16_t port) {
  const bool is_ipv6 = address.find(':') != std::string::npos;
  sockaddr_in6 long_place{};
  sockaddr_in place{};
  long_place.sin6_family = AF_INET6;
  long_place.sin6_port = htons(port);
  place.sin_family = AF_INET;
  place.sin_port = htons(port);
  const int is_address = is_ipv6 ? ::inet_pton(AF_INET6, address.c_str(), &long_place.sin6_addr)
                                 : ::inet_pton(AF_INET, address.c_str(), &place.sin_addr);
  if (is_address != 1) {
    throw bad_value("--address: " + in_quotes(address) +
                    " is not an address in numbers such as 127.0.0.1, 0.0.0.0 or ::1");
  }
  socket_fd made(
      ::socket(is_ipv6 ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (made.get() < 0) throw refused_by_system("cannot create a socket", errno);
  const int on = 1;
  static_cast<void>(::setsockopt(made.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)));
  const auto* const where = is_ipv6 ? reinterpret_cast<const sockaddr*>(&long_place)
                                    : reinterpret_cast<const sockaddr*>(&place);
  const socklen_t size = is_ipv6 ? sizeof(long_place) : sizeof(place);
  if (::bind(made.get(), where, size) == 0 && ::listen(made.get(), SOMAXCONN) == 0) return made;
  const int why = errno;
  const std::string title = fmt::format("port {} of {}", port, address);
  if (why == EADDRINUSE) {
    throw failure(exit_code::busy, title +
                                       " is in use by another program. Give another --port, "
                                       "or 0 for any that is free.");
  }
  if (why == EACCES) {
    throw failure(exit_code::permission,
                  title + " is reserved for root. Give a --port above 1023.");
  }
  throw failure(exit_code::usage,
                fmt::format("cannot listen at {}: {}. Give an --address of this machine.", title,
                            std::generic_category().message(why)));
}

std::uint16_t port_of(const socket_fd& socket) {
  sockaddr_in6 place{};  // the port has the same offset as in sockaddr_in
  socklen_t size = sizeof(place);
  if (::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&place), &size) != 0) return 0;
  return ntohs(place.sin6_port);
}

}  // namespace g4_tool
