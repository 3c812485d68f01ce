// SPDX-License-Identifier: MIT
#include "http_server.hpp"

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <exception>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace g4_tool {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t most_connections = 60;
/// A connection is not replaced earlier, because its request may be unread.
constexpr auto least_age = 200ms;
constexpr std::size_t longest_head = 4096;
/// The longest time for a request, and for progress of an answer.
constexpr auto progress_timeout = 5s;
/// The longest time in which the client reads the last answer before the connection is closed.
constexpr auto linger_timeout = 2s;

std::string_view reason_of(unsigned status) {
  static const std::map<unsigned, std::string_view> reasons{
      {200, "OK"},
      {400, "Bad Request"},
      {403, "Forbidden"},
      {404, "Not Found"},
      {405, "Method Not Allowed"},
      {426, "Upgrade Required"},
      {431, "Request Header Fields Too Large"},
      {503, "Service Unavailable"}};
  return reasons.at(status);
}

/// Allows scripts and styles of the page's own files only, so that texts of others cannot run as scripts.
std::string policy_for(std::string_view host) {
  return fmt::format(
      "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
      "connect-src 'self' ws://{}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
      host);
}

/// `host`: the header of the request; with the status 200 it was accepted by the host_guard.
std::string head_of(const http_answer& answer, std::size_t size, std::string_view host,
                    bool keeps_open) {
  const std::string policy = answer.status == 200 ? policy_for(host) : "default-src 'none'";
  return fmt::format(
      "HTTP/1.1 {} {}\r\ncontent-type: {}\r\ncontent-length: {}\r\nserver: g4-serve\r\n"
      "connection: {}\r\n{}{}cache-control: no-store\r\nx-content-type-options: nosniff\r\n"
      "x-frame-options: DENY\r\nreferrer-policy: no-referrer\r\n"
      "cross-origin-opener-policy: same-origin\r\ncross-origin-resource-policy: same-origin\r\n"
      "content-security-policy: {}\r\n\r\n",
      answer.status, reason_of(answer.status), answer.type, size,
      keeps_open ? "keep-alive" : "close", answer.status == 405 ? "allow: GET, HEAD\r\n" : "",
      answer.status == 426 ? "upgrade: websocket\r\nsec-websocket-version: 13\r\n" : "", policy);
}

}  // namespace

struct http_server::connection {
  enum class step { reading, writing, lingering };

  socket_fd socket;
  step now = step::reading;
  clock::time_point since = clock::now();  // of the last progress
  clock::time_point until = since + progress_timeout;
  std::string received{};
  // The unsent part of the answer.
  std::string head{};
  shared_bytes owned{};
  std::string_view rest{};
  bool keeps_open = false;

  void enter(step next, std::chrono::milliseconds time) {
    now = next;
    since = clock::now();
    until = since + time;
  }
};

http_server::http_server(socket_fd listening, http_actions actions)
    : listening_(std::move(listening)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      actions_(std::move(actions)) {
  if (wake_.get() < 0) throw refused_by_system("cannot create an event", errno);
  thread_ = std::thread([this] { run(); });
}

http_server::~http_server() {
  stops_ = true;
  static_cast<void>(::eventfd_write(wake_.get(), 1));
  thread_.join();
}

http_server::clock::time_point http_server::may_accept_at() const {
  const bool is_full = connections_.size() >= most_connections;
  return is_full ? std::max(accepts_at_, connections_.front().since + least_age) : accepts_at_;
}

void http_server::run() noexcept {
  std::vector<pollfd> waits;
  waits.reserve(most_connections + 2);
  while (!stops_) {
    const auto now = clock::now();
    const bool accepts = may_accept_at() <= now;
    clock::time_point until = accepts ? now + 1h : may_accept_at();
    waits.clear();
    waits.push_back({wake_.get(), POLLIN, 0});
    waits.push_back({accepts ? listening_.get() : -1, POLLIN, 0});
    for (const connection& each : connections_) {
      const bool writes = each.now == connection::step::writing;
      waits.push_back({each.socket.get(), static_cast<short>(writes ? POLLOUT : POLLIN), 0});
      until = std::min(until, each.until);
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - now);
    if (::poll(waits.data(), waits.size(), static_cast<int>(std::max(left, 0ms).count())) < 0) {
      continue;
    }
    auto each = connections_.begin();
    for (auto seen = waits.begin() + 2; seen != waits.end(); ++seen) {
      const auto current = each++;
      const auto progress = current->since;
      if (!serve(*current, seen->revents != 0)) {
        connections_.erase(current);
      } else if (current->since != progress) {
        connections_.splice(connections_.end(), connections_, current);
      }
    }
    if (waits[1].revents != 0) accept_all();
  }
}

void http_server::accept_all() noexcept {
  while (may_accept_at() <= clock::now()) {
    socket_fd socket(::accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (socket.get() < 0) {
      // No sockets are left: end one connection and try again later.
      if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
        accepts_at_ = clock::now() + least_age;
        if (!connections_.empty()) connections_.pop_front();
      }
      return;
    }
    const int on = 1;
    static_cast<void>(::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on)));
    if (connections_.size() >= most_connections) connections_.pop_front();
    try {
      connections_.push_back({.socket = std::move(socket)});
    } catch (const std::exception&) {
      return;  // no memory
    }
  }
}

bool http_server::serve(connection& each, bool is_ready) noexcept {
  try {
    if (!is_ready) return clock::now() < each.until;
    return each.now == connection::step::writing ? write(each) : read(each);
  } catch (const std::exception&) {
    return false;  // no memory
  }
}

bool http_server::read(connection& each) {
  std::array<char, longest_head> part;
  const bool lingers = each.now == connection::step::lingering;
  const std::size_t room = lingers ? part.size() : longest_head - each.received.size();
  const ssize_t count = ::recv(each.socket.get(), part.data(), room, 0);
  if (count < 0) return errno == EAGAIN || errno == EINTR;
  if (count == 0 || lingers) return count > 0 && clock::now() < each.until;
  each.received.append(part.data(), static_cast<std::size_t>(count));
  return start_answer(each);
}

bool http_server::start_answer(connection& each) {
  const std::size_t size = head_size(each.received);
  if (size == 0 && each.received.size() < longest_head) return clock::now() < each.until;
  const auto request =
      size == 0 ? std::nullopt : parse_head(std::string_view(each.received).substr(0, size));
  http_answer answer{.status = size == 0 ? 431U : 400U};
  if (request) {
    answer = actions_.answer(*request);
  } else {
    answer.content = size == 0 ? "The request is too long.\n" : "This is no request of HTTP/1.1.\n";
  }
  if (answer.status == http_answer::is_socket) {
    std::string first(answer.owned->begin(), answer.owned->end());
    actions_.hand_over(std::move(each.socket), first + each.received.substr(size));
    return false;
  }
  if (answer.owned) {
    answer.content = {reinterpret_cast<const char*>(answer.owned->data()), answer.owned->size()};
  }
  each.keeps_open = request && request->keeps_open();
  each.head = head_of(answer, answer.content.size(), request ? request->host.value_or("") : "",
                      each.keeps_open);
  each.owned = answer.owned;
  each.rest = request && request->method == "HEAD" ? std::string_view() : answer.content;
  each.received.erase(0, size);
  each.enter(connection::step::writing, progress_timeout);
  return write(each);
}

bool http_server::write(connection& each) {
  const bool is_head = !each.head.empty();
  const std::string_view piece = is_head ? std::string_view(each.head) : each.rest;
  const ssize_t sent = ::send(each.socket.get(), piece.data(), piece.size(), MSG_NOSIGNAL);
  if (sent < 0) return (errno == EAGAIN || errno == EINTR) && clock::now() < each.until;
  if (is_head) {
    each.head.erase(0, static_cast<std::size_t>(sent));
  } else {
    each.rest.remove_prefix(static_cast<std::size_t>(sent));
  }
  if (!each.head.empty() || !each.rest.empty()) {
    each.enter(connection::step::writing, progress_timeout);
    return true;
  }
  each.owned.reset();
  if (each.keeps_open) {
    each.enter(connection::step::reading, progress_timeout);
    return each.received.empty() || start_answer(each);
  }
  // If the socket were closed at once, with unread bytes, the client could lose the answer.
  ::shutdown(each.socket.get(), SHUT_WR);
  each.enter(connection::step::lingering, linger_timeout);
  return true;
}

}  // namespace g4_tool
