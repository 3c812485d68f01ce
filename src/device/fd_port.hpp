// SPDX-License-Identifier: MIT
// What serial ports and connections have in common: a descriptor that is waited for, read, written.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "g4lidar/transport.hpp"
#include "owned_fd.hpp"
#include "system_calls.hpp"

namespace g4lidar {

/// A clock, and a wait that ends early by a wake(). *Single thread* but for wake().
class waker {
 public:
  /// Makes an eventfd; see is_open().
  explicit waker(const system_calls& calls) noexcept;

  [[nodiscard]] bool is_open() const noexcept { return event_.get() >= 0; }

  /// *Any thread*, and a signal handler.
  void wake() noexcept;

  /// Whether there was a wake(), which is over with that.
  [[nodiscard]] bool take() noexcept;

  enum class ended : std::uint8_t { ready, timed_out, woken, failed };

  /// Waits until `fd` has one of `events`, or an error or a hang-up, which are always looked for; -1
  /// to wait for nothing but the time. What was found goes to `found`. With `failed`, errno says why.
  [[nodiscard]] ended wait(int fd, short events, std::int64_t deadline_ns, short* found) noexcept;

 private:
  const system_calls* calls_;
  owned_fd event_;
  std::atomic<bool> is_woken_{false};
};

/// Nanoseconds of std::chrono::steady_clock.
[[nodiscard]] std::int64_t steady_now_ns() noexcept;

/// A transport over a descriptor that does not block. What derives from it opens and restores it.
class fd_port : public transport {
 public:
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept final;
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept final;
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept final;
  [[nodiscard]] std::int64_t now_ns() const noexcept final { return steady_now_ns(); }
  void wake() noexcept final { waker_->wake(); }
  [[nodiscard]] int native_handle() const noexcept final { return fd_.get(); }
  [[nodiscard]] std::string_view name() const noexcept final { return name_; }
  [[nodiscard]] std::uint32_t baud() const noexcept final { return baud_; }

 protected:
  /// `at_end` is what reading 0 bytes means.
  fd_port(const system_calls& calls, owned_fd fd, std::unique_ptr<waker> waits, std::string name,
          std::uint32_t baud, problem at_end) noexcept;

  [[nodiscard]] const system_calls& calls() const noexcept { return *calls_; }
  [[nodiscard]] waker& waits() noexcept { return *waker_; }
  [[nodiscard]] int fd() const noexcept { return fd_.get(); }
  [[nodiscard]] bool is_gone() const noexcept { return is_gone_; }

 private:
  /// As write() and send() do.
  [[nodiscard]] virtual ssize_t write_some(bytes data) noexcept = 0;

  /// Reads what is there; `polled` is what poll has found before, if it was asked.
  [[nodiscard]] result<received> read_now(std::span<std::uint8_t> out, short polled) noexcept;
  /// What poll found; 0 where the time was over before.
  [[nodiscard]] result<short> wait(task doing, short events, std::int64_t deadline_ns) noexcept;
  /// What errno means, or that there is no line any more.
  [[nodiscard]] tl::unexpected<error> failed(task doing, int system_errno) noexcept;
  [[nodiscard]] tl::unexpected<error> ended(task doing, problem what, int system_errno) noexcept;

  const system_calls* calls_;
  owned_fd fd_;
  std::unique_ptr<waker> waker_;
  std::string name_;
  std::uint32_t baud_;
  problem at_end_;
  bool may_have_more_ = false;  // the last read() filled its buffer
  bool is_gone_ = false;
  int robbed_ = 0;  // bytes that were there when poll() looked, and not for read(), in a row
};

}  // namespace g4lidar
