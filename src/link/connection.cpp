// SPDX-License-Identifier: MIT
#include "connection.hpp"

#include <utility>

namespace g4lidar {

result<void> connection::open() {
  auto made = connector_->connect();
  if (!made) return tl::unexpected(made.error());
  static_cast<void>(exchange(std::move(*made)));
  ready_.follow(transport_->native_handle());
  return {};
}

void connection::close() noexcept {
  ready_.follow(-1);
  exchange(nullptr).reset();
}

result<void> connection::send(bytes command) noexcept {
  // A command of two bytes that is not sent within this time is never sent.
  constexpr std::int64_t write_time_ns = 100'000'000;
  while (true) {
    auto sent = transport_->write(command, now_ns() + write_time_ns);
    if (sent || sent.error() != problem::cancelled) return sent;
  }
}

std::unique_ptr<transport> connection::exchange(std::unique_ptr<transport> made) noexcept {
  while (changes_.test_and_set()) {
    // Only while another thread wakes it.
  }
  transport_.swap(made);
  changes_.clear();
  pass_on_wake();
  return made;
}

void connection::wake() noexcept {
  woken_.store(true);
  to_kick_.store(true);
  pass_on_wake();
}

/// Ends the wait of the waiting call. If the transport is held, the holder does this afterwards: a
/// signal handler must not wait.
void connection::pass_on_wake() noexcept {
  while (to_kick_.load() && !changes_.test_and_set()) {
    if (to_kick_.exchange(false)) is_open() ? transport_->wake() : connector_->wake();
    changes_.clear();
  }
}

}  // namespace g4lidar
