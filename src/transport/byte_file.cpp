// SPDX-License-Identifier: MIT
#include "g4lidar/transport/byte_file.hpp"

#include <fcntl.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <string>
#include <utility>

#include "fd_port.hpp"
#include "opening.hpp"

namespace g4lidar {
namespace {

/// The interval of bursts: a USB bridge delivers bytes in such bursts.
constexpr std::int64_t burst_ns = 1'000'000;

class file_transport final : public transport {
 public:
  file_transport(const system_calls& calls, owned_fd fd, std::unique_ptr<waker> waits,
                 std::string name, std::uint32_t bytes_per_second) noexcept
      : calls_(&calls),
        fd_(std::move(fd)),
        waker_(std::move(waits)),
        name_(std::move(name)),
        rate_(bytes_per_second) {}

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    assert(!out.empty());
    if (waker_->take()) return failure(task::reading, problem::cancelled, name_);
    if (rate_ == 0) return read_now(out);
    if (begun_ns_ == never_ns) begun_ns_ = steady_now_ns();
    const std::int64_t burst_due_ns = due_ns(taken_ + burst());
    if (steady_now_ns() < burst_due_ns) {
      const auto waited = wait(task::reading, std::min(burst_due_ns, deadline_ns));
      if (!waited) return tl::unexpected(waited.error());
    }
    const std::int64_t come = come_by(steady_now_ns()) - taken_;
    if (come <= 0) return received{};
    return read_now(out.first(std::min(out.size(), static_cast<std::size_t>(come))));
  }

  [[nodiscard]] result<void> write(bytes, std::int64_t) noexcept override {
    if (waker_->take()) return failure(task::writing, problem::cancelled, name_);
    return {};
  }

  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override {
    return wait(task::reading, deadline_ns);
  }

  [[nodiscard]] std::int64_t now_ns() const noexcept override { return steady_now_ns(); }
  void wake() noexcept override { waker_->wake(); }
  // For poll() a file is always readable; with a rate, only the time decides.
  [[nodiscard]] int native_handle() const noexcept override { return rate_ == 0 ? fd_.get() : -1; }
  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return rate_ * 10; }

 private:
  [[nodiscard]] std::int64_t burst() const noexcept {
    return std::max<std::int64_t>(rate_ * burst_ns / second_ns, 1);
  }
  /// When so many bytes are due, and how many are due by then.
  [[nodiscard]] std::int64_t due_ns(std::int64_t count) const noexcept {
    const std::int64_t rate = rate_;
    return begun_ns_ + count / rate * second_ns + (count % rate * second_ns + rate - 1) / rate;
  }
  [[nodiscard]] std::int64_t come_by(std::int64_t now_ns) const noexcept {
    const std::int64_t rate = rate_;
    const std::int64_t since_ns = now_ns - begun_ns_;
    return since_ns / second_ns * rate + since_ns % second_ns * rate / second_ns;
  }

  [[nodiscard]] result<received> read_now(std::span<std::uint8_t> out) noexcept {
    const ssize_t got =
        uninterrupted([&] { return calls_->read(fd_.get(), out.data(), out.size()); });
    if (got < 0) return failure(task::reading, problem::system, name_, errno);
    if (got == 0) return failure(task::reading, problem::end_of_input, name_);
    taken_ += got;
    const std::int64_t arrival_ns = rate_ == 0 ? steady_now_ns() : due_ns(taken_);
    return received{static_cast<std::size_t>(got), arrival_ns};
  }

  [[nodiscard]] result<void> wait(task doing, std::int64_t deadline_ns) noexcept {
    short polled = 0;
    switch (waker_->wait(-1, 0, deadline_ns, &polled)) {
      case waker::ended::woken:
        return failure(doing, problem::cancelled, name_);
      case waker::ended::failed:
        return failure(doing, problem::system, name_, errno);
      default:
        return {};
    }
  }

  const system_calls* calls_;
  owned_fd fd_;
  std::unique_ptr<waker> waker_;
  std::string name_;
  std::uint32_t rate_;
  std::int64_t begun_ns_ = never_ns;  // the time of the first read()
  std::int64_t taken_ = 0;
};

}  // namespace

result<std::unique_ptr<transport>> open_file_transport(std::string_view path,
                                                       const byte_file_options& options,
                                                       const system_calls& calls) {
  std::string name(path);
  constexpr int flags = O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC;  // it may be a pipe
  owned_fd fd(calls, uninterrupted([&] { return calls.open(name.c_str(), flags); }));
  if (fd.get() < 0) return failure(task::opening, problem::system, path, errno);
  struct stat file{};
  if (uninterrupted([&] { return calls.fstat(fd.get(), &file); }) != 0) {
    return failure(task::opening, problem::system, path, errno);
  }
  if (!S_ISREG(file.st_mode)) {
    return failure(task::opening, problem::bad_option, name + " is not a file");
  }
  auto waits = std::make_unique<waker>(calls);
  if (!waits->is_open()) return failure(task::opening, problem::system, "eventfd", errno);
  return std::make_unique<file_transport>(calls, std::move(fd), std::move(waits), std::move(name),
                                          options.bytes_per_second);
}

result<std::unique_ptr<transport>> byte_file::open(std::string_view path,
                                                   const byte_file_options& options) {
  return open_file_transport(path, options, real_system_calls());
}

}  // namespace g4lidar
