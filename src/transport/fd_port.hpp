// SPDX-License-Identifier: MIT
// The common part of serial ports and network connections: wait for a descriptor, read, write.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "g4lidar/transport/serial_port.hpp"
#include "g4lidar/transport/transport.hpp"
#include "owned_fd.hpp"
#include "system_calls.hpp"
#include "transport/tcp_port.hpp"

namespace g4lidar {

inline constexpr std::int64_t second_ns = 1'000'000'000;

/// A clock, and a wait that wake() ends early. *Single thread* except wake().
class waker {
 public:
  /// Creates an eventfd; see is_open().
  explicit waker(const system_calls& calls) noexcept;

  [[nodiscard]] bool is_open() const noexcept { return event_.get() >= 0; }

  /// *Any thread*, and a signal handler.
  void wake() noexcept;

  /// Whether there was a wake().
  [[nodiscard]] bool is_woken() const noexcept { return is_woken_.load(std::memory_order_relaxed); }
  /// The same; resets it.
  [[nodiscard]] bool take() noexcept;

  enum class ended : std::uint8_t { ready, timed_out, woken, failed };

  /// Waits until `fd` has one of `events`, or an error or a hang-up, which are always checked; -1
  /// to wait for the time only. Writes the result of poll to `found`. With `failed`, errno has the
  /// reason.
  [[nodiscard]] ended wait(int fd, short events, std::int64_t deadline_ns, short* found) noexcept;

 private:
  const system_calls* calls_;
  owned_fd event_;
  std::atomic<bool> is_woken_{false};
};

/// Nanoseconds of std::chrono::steady_clock.
[[nodiscard]] std::int64_t steady_now_ns() noexcept;

/// A transport over a non-blocking descriptor. Derived classes open it and restore its settings.
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
  /// What the line discipline of a tty keeps; a socket keeps more.
  [[nodiscard]] std::size_t kept_bytes() const noexcept override { return 4095; }

 protected:
  /// `at_end` is the meaning of reading 0 bytes.
  fd_port(const system_calls& calls, owned_fd fd, std::unique_ptr<waker> waits, std::string name,
          std::uint32_t baud, problem at_end) noexcept;

  [[nodiscard]] const system_calls& calls() const noexcept { return *calls_; }
  [[nodiscard]] waker& waits() noexcept { return *waker_; }
  [[nodiscard]] int fd() const noexcept { return fd_.get(); }
  [[nodiscard]] bool is_gone() const noexcept { return is_gone_; }
  /// The rate that was set; the bytes received before were discarded.
  void restart_at(std::uint32_t baud) noexcept {
    baud_ = baud;
    may_have_more_ = false;
  }
  /// The error for errno, or for a connection that does not exist any more.
  [[nodiscard]] tl::unexpected<error> failed(task doing, int system_errno) noexcept;

 private:
  /// Like write() and send().
  [[nodiscard]] virtual ssize_t write_some(bytes data) noexcept = 0;

  /// Reads the available bytes; `polled` is the result of poll, if it was called.
  [[nodiscard]] result<received> read_now(std::span<std::uint8_t> out, short polled) noexcept;
  /// The result of poll; 0 if the deadline has passed.
  [[nodiscard]] result<short> wait(task doing, short events, std::int64_t deadline_ns) noexcept;
  [[nodiscard]] tl::unexpected<error> ended(task doing, problem code, int system_errno) noexcept;

  const system_calls* calls_;
  owned_fd fd_;
  std::unique_ptr<waker> waker_;
  std::string name_;
  std::uint32_t baud_;
  problem at_end_;
  bool may_have_more_ = false;  // the last read() filled its buffer
  bool is_gone_ = false;
  int robbed_ = 0;  // consecutive times that poll() reported bytes and read() found none
};

/// serial_port::open() and tcp_port::open() with replaceable system calls, for tests.
[[nodiscard]] result<std::unique_ptr<transport>> open_serial_transport(
    std::string_view path, const serial_options& options, const system_calls& calls);
[[nodiscard]] result<std::unique_ptr<transport>> open_connection(std::string_view address,
                                                                 const tcp_options& options,
                                                                 const system_calls& calls);

}  // namespace g4lidar
