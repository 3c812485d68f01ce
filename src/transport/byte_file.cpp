// SPDX-License-Identifier: MIT
#include "g4lidar/transport/byte_file.hpp"

#include <fcntl.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <string>
#include <utility>

#include "fd_port.hpp"

namespace g4lidar {
namespace {

/// The interval of bursts: a USB bridge delivers bytes in such bursts.
constexpr std::int64_t burst_ns = 1'000'000;

class file_transport final : public fd_port {
 public:
  file_transport(const system_calls& calls, owned_fd fd, std::unique_ptr<waker> waits,
                 std::string name, std::uint32_t bytes_per_second) noexcept
      : fd_port(calls, std::move(fd), std::move(waits), std::move(name), bytes_per_second * 10,
                problem::end_of_input),
        rate_(bytes_per_second) {}

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    assert(!out.empty());
    if (waits().take()) return failure(task::reading, problem::cancelled, name());
    if (rate_ == 0) return take(out);
    if (begun_ns_ == never_ns) begun_ns_ = steady_now_ns();
    const std::int64_t burst_due_ns = due_ns(taken_ + burst());
    if (steady_now_ns() < burst_due_ns) {
      const auto waited = pause(std::min(burst_due_ns, deadline_ns));
      if (!waited) return tl::unexpected(waited.error());
    }
    const std::int64_t come = come_by(steady_now_ns()) - taken_;
    if (come <= 0) return received{};
    return take(out.first(std::min(out.size(), static_cast<std::size_t>(come))));
  }

  // For poll() a file is always readable; with a rate, only the time decides.
  [[nodiscard]] int native_handle() const noexcept override { return rate_ == 0 ? fd() : -1; }
  [[nodiscard]] std::size_t kept_bytes() const noexcept override { return 0; }

 private:
  /// No device receives it.
  [[nodiscard]] ssize_t write_some(bytes data) noexcept override {
    return static_cast<ssize_t>(data.size());
  }
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

  [[nodiscard]] result<received> take(std::span<std::uint8_t> out) noexcept {
    const ssize_t got = uninterrupted([&] { return calls().read(fd(), out.data(), out.size()); });
    if (got < 0) return failure(task::reading, problem::system, name(), errno);
    if (got == 0) return failure(task::reading, problem::end_of_input, name());
    taken_ += got;
    const std::int64_t arrival_ns = rate_ == 0 ? steady_now_ns() : due_ns(taken_);
    return received{static_cast<std::size_t>(got), arrival_ns};
  }

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
  owned_fd fd(uninterrupted([&] { return calls.open(name.c_str(), flags); }), calls.close);
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
