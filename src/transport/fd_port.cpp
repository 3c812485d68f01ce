// SPDX-License-Identifier: MIT
#include "fd_port.hpp"

#include <sys/eventfd.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <utility>

#include "core/one_of.hpp"

namespace g4lidar {
namespace {

// Values of errno that mean that the other end does not exist any more. A USB bridge that is
// unplugged gives the first three, a network connection the others.
bool means_gone(int system_errno) noexcept {
  return is_one_of(system_errno, EIO, ENODEV, ENXIO, ECONNRESET, EPIPE, ETIMEDOUT, EHOSTUNREACH,
                   ENETUNREACH, ENETDOWN, ENOTCONN);
}

bool is_blocked(int system_errno) noexcept {
  return system_errno == EAGAIN;  // and EWOULDBLOCK, which is the same on Linux
}

// These conditions stay: if one of them is set and nothing can be read or written, a further wait
// is useless.
constexpr short hung_up = POLLHUP | POLLERR | POLLNVAL;

// Consecutive; another reader that takes half of the bursts causes this within a few of them.
constexpr int max_robbed = 3;

timespec time_until(std::int64_t deadline_ns) noexcept {
  const std::int64_t now = steady_now_ns();
  const std::int64_t left = deadline_ns > now ? deadline_ns - now : 0;
  return {static_cast<std::time_t>(left / 1'000'000'000), static_cast<long>(left % 1'000'000'000)};
}

}  // namespace

std::int64_t steady_now_ns() noexcept {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// ---- waker -------------------------------------------------------------------------------------

waker::waker(const system_calls& calls) noexcept
    : calls_(&calls),
      event_(uninterrupted([&] { return calls.eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK); }),
             calls.close) {}

void waker::wake() noexcept {
  static_assert(std::atomic<bool>::is_always_lock_free);  // for the signal handler
  const int kept = errno;
  is_woken_.store(true);
  const std::uint64_t one = 1;
  // It fails only if the counter is full: then the descriptor is readable anyway.
  static_cast<void>(uninterrupted([&] { return calls_->write(event_.get(), &one, sizeof one); }));
  errno = kept;
}

// The flag decides, so that a reader with waiting bytes sees it without a system call. The eventfd
// ends waits; if it is readable without the flag, it belongs to a wake() whose flag take() saw
// before its write().
bool waker::take() noexcept {
  if (!is_woken_.load(std::memory_order_relaxed) || !is_woken_.exchange(false)) return false;
  std::uint64_t count = 0;
  static_cast<void>(
      uninterrupted([&] { return calls_->read(event_.get(), &count, sizeof count); }));
  return true;
}

waker::ended waker::wait(int fd, short events, std::int64_t deadline_ns, short* found) noexcept {
  while (true) {
    std::array<pollfd, 2> polled{{{event_.get(), POLLIN, 0}, {fd, events, 0}}};
    const timespec left = time_until(deadline_ns);
    const int ready =
        calls_->ppoll(polled.data(), polled.size(), deadline_ns == never_ns ? nullptr : &left);
    if (ready < 0 && errno != EINTR) return ended::failed;
    if (ready < 0) continue;
    if (polled[0].revents != 0) {
      if (take()) return ended::woken;
      std::uint64_t stale = 0;
      static_cast<void>(calls_->read(event_.get(), &stale, sizeof stale));
    }
    *found = polled[1].revents;
    if (*found != 0) return ended::ready;
    if (ready == 0) return ended::timed_out;
  }
}

// ---- fd_port -----------------------------------------------------------------------------------

fd_port::fd_port(const system_calls& calls, owned_fd fd, std::unique_ptr<waker> waits,
                 std::string name, std::uint32_t baud, problem at_end) noexcept
    : calls_(&calls),
      fd_(std::move(fd)),
      waker_(std::move(waits)),
      name_(std::move(name)),
      baud_(baud),
      at_end_(at_end) {}

result<received> fd_port::read(std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept {
  assert(!out.empty());
  if (waker_->take()) return failure(task::reading, problem::cancelled, name_);
  // If bytes are known to wait, or there is no time to wait for them, one call is sufficient.
  const bool no_time = deadline_ns <= steady_now_ns();
  if (may_have_more_ || no_time) {
    const auto got = read_now(out, 0);
    if (!got || got->count > 0 || no_time) return got;
  }
  while (true) {
    const auto is_ready = wait(task::reading, POLLIN, deadline_ns);
    if (!is_ready) return tl::unexpected(is_ready.error());
    if (*is_ready == 0) return received{};
    const auto got = read_now(out, *is_ready);
    if (!got || got->count > 0) return got;
  }
}

result<received> fd_port::read_now(std::span<std::uint8_t> out, short polled) noexcept {
  const ssize_t got =
      uninterrupted([&] { return calls_->read(fd_.get(), out.data(), out.size()); });
  const int system_errno = errno;
  may_have_more_ = got == static_cast<ssize_t>(out.size());
  if (got > 0) {
    robbed_ = 0;
    return received{static_cast<std::size_t>(got), steady_now_ns()};
  }
  if (got == 0) return ended(task::reading, at_end_, 0);
  if (!is_blocked(system_errno)) return failed(task::reading, system_errno);
  if ((polled & hung_up) != 0) return ended(task::reading, problem::gone, 0);
  // poll() reported bytes, and there are none: another process has read them.
  if ((polled & POLLIN) != 0 && at_end_ == problem::gone && ++robbed_ >= max_robbed) {
    robbed_ = 0;
    return failure(task::reading, problem::interference, name_);
  }
  return received{};
}

result<void> fd_port::write(bytes data, std::int64_t deadline_ns) noexcept {
  if (waker_->take()) return failure(task::writing, problem::cancelled, name_);
  short polled = 0;
  while (!data.empty()) {
    const ssize_t put = uninterrupted([&] { return write_some(data); });
    if (put > 0) {
      data = data.subspan(static_cast<std::size_t>(put));
      continue;
    }
    if (put < 0 && !is_blocked(errno)) return failed(task::writing, errno);
    if ((polled & hung_up) != 0) return ended(task::writing, problem::gone, 0);
    const auto is_ready = wait(task::writing, POLLOUT, deadline_ns);
    if (!is_ready) return tl::unexpected(is_ready.error());
    if (*is_ready == 0) {
      return failure(task::writing, problem::timeout, name_, 0, error_detail::not_sent);
    }
    polled = *is_ready;
  }
  return {};
}

result<void> fd_port::pause(std::int64_t deadline_ns) noexcept {
  const auto is_ready = wait(task::reading, 0, deadline_ns);  // not for bytes
  if (!is_ready) return tl::unexpected(is_ready.error());
  if (*is_ready != 0) return ended(task::reading, problem::gone, 0);
  return {};
}

result<short> fd_port::wait(task doing, short events, std::int64_t deadline_ns) noexcept {
  short polled = 0;
  switch (waker_->wait(fd_.get(), events, deadline_ns, &polled)) {
    case waker::ended::ready:
    case waker::ended::timed_out:
      return polled;
    case waker::ended::woken:
      return failure(doing, problem::cancelled, name_);
    case waker::ended::failed:
      break;
  }
  return failed(doing, errno);
}

tl::unexpected<error> fd_port::failed(task doing, int system_errno) noexcept {
  return ended(doing, means_gone(system_errno) ? problem::gone : problem::system, system_errno);
}

tl::unexpected<error> fd_port::ended(task doing, problem code, int system_errno) noexcept {
  if (code == problem::gone) is_gone_ = true;
  return failure(doing, code, name_, system_errno);
}

}  // namespace g4lidar
