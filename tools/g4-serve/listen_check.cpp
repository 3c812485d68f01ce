// SPDX-License-Identifier: MIT
#include "listen_check.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/verbs.hpp"

namespace g4_tool {

void check_listening(const std::string& address, std::uint16_t port) {
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
  const int fd = ::socket(is_ipv6 ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  static_cast<void>(::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)));
  const auto* const where = is_ipv6 ? reinterpret_cast<const sockaddr*>(&long_place)
                                    : reinterpret_cast<const sockaddr*>(&place);
  const socklen_t size = is_ipv6 ? sizeof(long_place) : sizeof(place);
  const bool can = fd >= 0 && ::bind(fd, where, size) == 0 && ::listen(fd, 1) == 0;
  const int why = can ? 0 : errno;
  if (fd >= 0) ::close(fd);
  if (can) return;
  const std::string words = std::generic_category().message(why);
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
  throw failure(exit_code::usage, fmt::format("cannot listen at {}: {}. Give an --address of "
                                              "this machine.",
                                              title, words));
}

}  // namespace g4_tool
