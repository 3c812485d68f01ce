// SPDX-License-Identifier: MIT
#include "service_watch.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstddef>
#include <cstdlib>

namespace g4_tool {
namespace {

/// A variable of the environment; empty if it is not set.
std::string_view variable(const char* name) {
  const char* const text = std::getenv(name);
  return text == nullptr ? std::string_view() : std::string_view(text);
}

/// The number that is all of `text`; 0 if it is not a number.
std::int64_t number_in(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  return problem == std::errc{} && end == text.data() + text.size() ? value : 0;
}

/// Half of the watchdog's timeout; 0 if it does not watch this process.
std::int64_t watchdog_interval_ns() {
  const std::string_view watched = variable("WATCHDOG_PID");
  if (!watched.empty() && number_in(watched) != ::getpid()) return 0;
  return std::clamp<std::int64_t>(number_in(variable("WATCHDOG_USEC")), 0, INT64_MAX / 1000) * 500;
}

/// A socket connected to `name`: a path, or `@` and an abstract name. -1 on failure.
int connect_to(std::string_view name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const bool is_abstract = name.starts_with('@');
  if ((!is_abstract && !name.starts_with('/')) || name.size() < 2) return -1;
  if (name.size() >= sizeof(address.sun_path)) return -1;
  std::copy(name.begin(), name.end(), std::begin(address.sun_path));
  if (is_abstract) address.sun_path[0] = '\0';
  // The size of the address includes the terminating zero of a path, but an abstract name has none.
  const std::size_t size = offsetof(sockaddr_un, sun_path) + name.size() + (is_abstract ? 0U : 1U);
  const int fd = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const auto* const at = reinterpret_cast<const sockaddr*>(&address);
  if (fd < 0 || ::connect(fd, at, static_cast<socklen_t>(size)) == 0) return fd;
  ::close(fd);
  return -1;
}

}  // namespace

service_watch::service_watch()
    : fd_(connect_to(variable("NOTIFY_SOCKET"))), interval_ns_(watchdog_interval_ns()) {}

service_watch::~service_watch() {
  if (fd_ >= 0) ::close(fd_);
}

void service_watch::ready() {
  // Without this message systemd assumes that the service did not start, so it may wait.
  if (!is_ready_) is_ready_ = send("READY=1", 0);
}

void service_watch::alive(std::int64_t now_ns) {
  if (interval_ns_ == 0 || now_ns < next_ns_) return;
  if (send("WATCHDOG=1", MSG_DONTWAIT)) next_ns_ = now_ns + interval_ns_;
}

void service_watch::alive() {
  alive(std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count());
}

void service_watch::status(std::string_view text) {
  std::string line = "STATUS=" + std::string(text);
  std::replace(line.begin(), line.end(), '\n', ' ');  // a line break would begin another variable
  if (line != status_ && send(line, MSG_DONTWAIT)) status_ = std::move(line);
}

void service_watch::stopping() {
  if (!is_stopping_) is_stopping_ = send("STOPPING=1", MSG_DONTWAIT);
}

bool service_watch::send(std::string_view text, int flags) const noexcept {
  while (fd_ >= 0) {
    if (::send(fd_, text.data(), text.size(), flags | MSG_NOSIGNAL) >= 0) return true;
    if (errno != EINTR) return false;
  }
  return false;
}

}  // namespace g4_tool
