// SPDX-License-Identifier: MIT
#include "g4lidar/recording/raw_bytes.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "format.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/recording/recorded_event.hpp"
#include "g4lidar/transport/transport.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar {
namespace {

/// The time of the first bytes of a file; 0 would mean that it is not known.
constexpr std::int64_t file_begin_ns = second_ns;
/// Of bytes that belong to no packet.
constexpr std::size_t longest_piece = 16'384;

/// The common part of both kinds: a descriptor, and no device that answers.
class byte_transport : public transport {
 public:
  byte_transport(owned_fd fd, std::string name) : fd_(std::move(fd)), name_(std::move(name)) {}

  [[nodiscard]] result<void> write(bytes, std::int64_t) noexcept override { return {}; }
  void wake() noexcept override { woken_.store(true); }
  [[nodiscard]] std::string_view name() const noexcept override { return name_; }

 protected:
  [[nodiscard]] int fd() const noexcept { return fd_.get(); }
  [[nodiscard]] bool is_woken() noexcept { return woken_.exchange(false); }

  /// One call of read(), made only if it does not wait.
  [[nodiscard]] result<std::size_t> take(std::span<std::uint8_t> out) noexcept {
    while (true) {
      const ssize_t count = ::read(fd(), out.data(), out.size());
      if (count > 0) return static_cast<std::size_t>(count);
      const bool has_gone = count < 0 && errno == EIO && ::isatty(fd()) != 0;
      if (count == 0 || has_gone) return failure(task::reading, problem::end_of_input, name_);
      if (errno == EAGAIN) return std::size_t{0};
      if (errno != EINTR) return failure(task::reading, problem::system, name_, errno);
    }
  }

 private:
  owned_fd fd_;
  std::string name_;
  std::atomic<bool> woken_{false};
};

/// A pipe: bytes arrive when they can be read.
class pipe_transport final : public byte_transport {
 public:
  using byte_transport::byte_transport;

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    if (is_woken()) return failure(task::reading, problem::cancelled, name());
    if (!wait(POLLIN, deadline_ns)) return received{};
    const auto got = take(out);
    if (!got) return tl::unexpected(got.error());
    // A recording must be a file; in a pipe it would be parsed as noise.
    const bool is_recording =
        std::ranges::equal(out.first(std::min(*got, mcap::magic.size())), mcap::magic);
    if (!std::exchange(has_begun_, true) && is_recording) {
      return failure(task::reading, problem::bad_file, "a recording in a pipe");
    }
    return received{*got, steady_now_ns()};
  }
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override {
    static_cast<void>(wait(0, deadline_ns));
    return {};
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return steady_now_ns(); }
  [[nodiscard]] int native_handle() const noexcept override { return fd(); }

 private:
  /// Waits until something can be read, at most until the deadline; the end counts, too.
  [[nodiscard]] bool wait(short events, std::int64_t deadline_ns) noexcept {
    const std::int64_t left_ms = (deadline_ns - steady_now_ns() + 999'999) / 1'000'000;
    pollfd waiting{events != 0 ? fd() : -1, events, 0};
    return ::poll(&waiting, 1, static_cast<int>(std::clamp<std::int64_t>(left_ms, 0, 1000))) != 0;
  }

  bool has_begun_ = false;
};

/// A file: its times are counted from samples.
class counted_transport final : public byte_transport {
 public:
  counted_transport(owned_fd fd, std::string name, std::uint32_t rate_hz,
                    std::shared_ptr<std::int64_t> counted_ns, std::function<bool()> is_cancelled)
      : byte_transport(std::move(fd), std::move(name)),
        rate_hz_(rate_hz),
        counted_ns_(std::move(counted_ns)),
        is_cancelled_(std::move(is_cancelled)) {}

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out, std::int64_t) noexcept override {
    if (is_woken()) return failure(task::reading, problem::cancelled, name());
    if (piece_.empty()) {
      if (auto next = find_piece(); !next) return tl::unexpected(next.error());
    }
    const std::size_t count = std::min(out.size(), piece_.size());
    std::memcpy(out.data(), piece_.data(), count);
    piece_ = piece_.subspan(count);
    return received{count, now_ns()};
  }
  [[nodiscard]] result<void> pause(std::int64_t) noexcept override { return {}; }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return *counted_ns_; }

 private:
  /// Up to the end of the next packet, whose samples have been measured by then. No part of it
  /// arrives before.
  [[nodiscard]] result<void> find_piece() noexcept {
    while (!parse() && end_ - begin_ < longest_piece) {
      std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
      end_ = parsed_ = end_ - begin_;
      begin_ = 0;
      if (is_cancelled_ && is_cancelled_()) {
        return failure(task::reading, problem::cancelled, name());
      }
      const auto got = take(std::span(buffer_).subspan(end_));
      if (!got && end_ > 0 && got.error() == problem::end_of_input) break;
      if (!got) return tl::unexpected(got.error());
      end_ += *got;
    }
    piece_ = bytes(buffer_).subspan(begin_, parsed_ - begin_);
    begin_ = parsed_;
    return {};
  }
  /// Whether there was a packet; then everything up to its end is parsed.
  [[nodiscard]] bool parse() noexcept {
    bytes rest = bytes(buffer_).subspan(parsed_, end_ - parsed_);
    while (const auto found = parser_.next(rest)) {
      const auto* const packet = std::get_if<packet_view>(&*found);
      if (packet == nullptr) continue;
      count(packet->sample_count());
      parsed_ = end_ - rest.size();
      return true;
    }
    parsed_ = end_;
    return false;
  }
  void count(std::size_t samples) noexcept {
    samples_ += static_cast<std::int64_t>(samples);
    *counted_ns_ = file_begin_ns + samples_ / rate_hz_ * second_ns +
                   samples_ % rate_hz_ * second_ns / rate_hz_;
  }

  std::int64_t rate_hz_;
  std::shared_ptr<std::int64_t> counted_ns_;  // the connector has it, too
  std::function<bool()> is_cancelled_;
  std::int64_t samples_ = 0;
  stream_parser parser_;
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(65'536);
  std::size_t begin_ = 0;   // of the bytes that were not returned yet
  std::size_t parsed_ = 0;  // up to here
  std::size_t end_ = 0;
  bytes piece_;
};

/// Returns its transport once. The time is that of the transport, which may be destroyed before
/// this.
class byte_connector final : public connector {
 public:
  byte_connector(std::unique_ptr<byte_transport> port,
                 std::shared_ptr<const std::int64_t> counted_ns,
                 std::optional<std::int64_t> wall_ahead_ns)
      : port_(std::move(port)), counted_ns_(std::move(counted_ns)), wall_ahead_ns_(wall_ahead_ns) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    if (port_ == nullptr) return failure(task::opening, problem::end_of_input);
    return std::move(port_);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override {
    return counted_ns_ != nullptr ? *counted_ns_ : steady_now_ns();
  }
  [[nodiscard]] bool pause(std::int64_t) noexcept override { return true; }
  void wake() noexcept override {}
  [[nodiscard]] connector_traits traits() const noexcept override {
    return {
        .answers = false, .counts_time = counted_ns_ != nullptr, .wall_ahead_ns = wall_ahead_ns_};
  }

 private:
  std::unique_ptr<byte_transport> port_;
  std::shared_ptr<const std::int64_t> counted_ns_;  // null: a pipe
  std::optional<std::int64_t> wall_ahead_ns_;
};

}  // namespace

result<std::unique_ptr<connector>> open_raw_bytes(const std::string& name,
                                                  std::uint32_t sample_rate_hz,
                                                  std::function<bool()> is_cancelled) {
  const bool is_standard = name == "-";
  owned_fd fd(is_standard ? ::fcntl(0, F_DUPFD_CLOEXEC, 3)
                          : ::open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
  if (fd.get() < 0) return failure(task::opening, problem::system, name, errno);
  struct stat file{};
  const bool is_known = ::fstat(fd.get(), &file) == 0;
  if (is_known && S_ISDIR(file.st_mode)) {
    return failure(task::opening, problem::bad_file, name, EISDIR);
  }
  std::string title = is_standard ? "standard input" : name;
  std::unique_ptr<byte_transport> port;
  if (is_known && S_ISREG(file.st_mode)) {
    const std::int64_t wall_ns = file.st_mtim.tv_sec * second_ns + file.st_mtim.tv_nsec;
    auto counted_ns = std::make_shared<std::int64_t>(file_begin_ns);
    port = std::make_unique<counted_transport>(std::move(fd), std::move(title), sample_rate_hz,
                                               counted_ns, std::move(is_cancelled));
    return std::make_unique<byte_connector>(std::move(port), std::move(counted_ns),
                                            wall_ns - file_begin_ns);
  }
  port = std::make_unique<pipe_transport>(std::move(fd), std::move(title));
  return std::make_unique<byte_connector>(std::move(port), nullptr, std::nullopt);
}

}  // namespace g4lidar
