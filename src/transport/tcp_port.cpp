// SPDX-License-Identifier: MIT
#include "transport/tcp_port.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "core/time_limit.hpp"
#include "fd_port.hpp"

namespace g4lidar {
namespace {

struct host_and_port {
  std::string host;
  std::string port;
};

/// 1 to 65535: names of services are not looked up.
bool is_port(std::string_view text) {
  std::uint16_t number = 0;
  const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), number);
  return wrong == std::errc() && end == text.data() + text.size() && number > 0;
}

std::optional<host_and_port> parse(std::string_view address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string_view::npos) return std::nullopt;
  std::string_view host = address.substr(0, colon);
  const std::string_view port = address.substr(colon + 1);
  if (host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string_view::npos) {
    return std::nullopt;  // an IPv6 address without brackets: the last colon is ambiguous
  }
  if (host.empty() || !is_port(port)) return std::nullopt;
  return host_and_port{std::string(host), std::string(port)};
}

struct free_addresses {
  void operator()(addrinfo* list) const noexcept { ::freeaddrinfo(list); }
};
using address_list = std::unique_ptr<addrinfo, free_addresses>;

/// All addresses of the host; none if it is not known.
address_list addresses_of(const host_and_port& wanted) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int failed = ::getaddrinfo(wanted.host.c_str(), wanted.port.c_str(), &hints, &list);
  return address_list(failed == 0 ? list : nullptr);
}

class tcp_connection final : public fd_port {
 public:
  tcp_connection(const system_calls& calls, owned_fd fd, std::unique_ptr<waker> waits,
                 std::string name, std::uint32_t baud) noexcept
      : fd_port(calls, std::move(fd), std::move(waits), std::move(name), baud,
                problem::end_of_input) {}

 private:
  [[nodiscard]] ssize_t write_some(bytes data) noexcept override {
    return calls().send(fd(), data.data(), data.size(), MSG_NOSIGNAL);
  }
};

/// 0, or the errno of the refusal; ETIMEDOUT at the deadline.
int connect(int fd, const addrinfo& to, std::int64_t deadline_ns, waker& waits,
            const system_calls& calls) {
  // After an interruption the system continues connect(): wait for it, and do not call it again.
  if (calls.connect(fd, to.ai_addr, to.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS && errno != EINTR) return errno;
  short polled = 0;
  switch (waits.wait(fd, POLLOUT, deadline_ns, &polled)) {
    case waker::ended::timed_out:
      return ETIMEDOUT;
    case waker::ended::failed:
      return errno;
    default:
      break;
  }
  int refused = 0;
  socklen_t size = sizeof refused;
  const int got =
      uninterrupted([&] { return calls.getsockopt(fd, SOL_SOCKET, SO_ERROR, &refused, &size); });
  return got == 0 ? refused : errno;
}

/// Sends small writes immediately, and detects a dead peer after about ten seconds. Best effort.
void tune(int fd, const system_calls& calls) {
  const auto set = [&](int level, int name, int value) {
    static_cast<void>(
        uninterrupted([&] { return calls.setsockopt(fd, level, name, &value, sizeof value); }));
  };
  set(IPPROTO_TCP, TCP_NODELAY, 1);
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 5);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 2);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
  set(IPPROTO_TCP, TCP_USER_TIMEOUT, 10'000);
}

/// Whether errno is an error of this program and not of the other end.
bool is_our_own(int system_errno) noexcept {
  return system_errno == EMFILE || system_errno == ENFILE || system_errno == ENOMEM ||
         system_errno == ENOBUFS;
}

}  // namespace

result<std::unique_ptr<transport>> open_connection(std::string_view address,
                                                   const tcp_options& options,
                                                   const system_calls& calls) {
  if (is_bridge(address)) address.remove_prefix(tcp_prefix.size());
  if (address.starts_with("//")) address.remove_prefix(2);
  const auto wanted = parse(address);
  if (!wanted) {
    return failure(task::opening, problem::bad_option,
                   "tcp:" + std::string(address) + ", not tcp:host:port with a port of 1 to 65535");
  }
  std::string name = "tcp:" + wanted->host + ":" + wanted->port;
  const address_list list = addresses_of(*wanted);
  const std::int64_t deadline_ns = steady_now_ns() + limited_ns(options.connect_timeout);
  auto waits = std::make_unique<waker>(calls);
  if (!waits->is_open()) return failure(task::opening, problem::system, "eventfd", errno);
  int refused = 0;
  for (const addrinfo* to = list.get(); to != nullptr; to = to->ai_next) {
    owned_fd fd(uninterrupted([&] {
                  return calls.socket(to->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC,
                                      to->ai_protocol);
                }),
                calls.close);
    refused = fd.get() < 0 ? errno : connect(fd.get(), *to, deadline_ns, *waits, calls);
    if (refused != 0) continue;
    tune(fd.get(), calls);
    return std::make_unique<tcp_connection>(calls, std::move(fd), std::move(waits), std::move(name),
                                            options.baud);
  }
  const problem code = is_our_own(refused) ? problem::system : problem::cannot_connect;
  return failure(task::opening, code, name, refused);
}

result<std::unique_ptr<transport>> tcp_port::open(std::string_view address,
                                                  const tcp_options& options) {
  return open_connection(address, options, real_system_calls());
}

}  // namespace g4lidar
