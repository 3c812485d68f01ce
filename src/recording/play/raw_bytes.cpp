// SPDX-License-Identifier: MIT
#include "g4lidar/recording/raw_bytes.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "byte_survey.hpp"
#include "counted_items.hpp"
#include "g4lidar/core/model_choice.hpp"
#include "g4lidar/recording/contents.hpp"
#include "g4lidar/transport/transport.hpp"
#include "played_file.hpp"
#include "recording/mcap/format.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar {
namespace {

/// A recording must be a file with a name; its bytes would be parsed as noise.
tl::unexpected<error> a_recording(task doing) noexcept {
  return failure(doing, problem::bad_file, "a recording in a pipe or in standard input");
}

/// A pipe, a terminal or a device: bytes arrive when they can be read. Nothing answers.
class pipe_transport final : public transport {
 public:
  pipe_transport(owned_fd fd, std::string name) : fd_(std::move(fd)), name_(std::move(name)) {}

  /// Reads ahead until it is known what sends the bytes.
  [[nodiscard]] result<recognised_model> recognise(const std::function<bool()>& is_cancelled) {
    constexpr std::int64_t step_ns = 50'000'000;  // between two calls of is_cancelled
    stream_head head(steady_now_ns());
    std::array<std::uint8_t, 4096> memory;
    while (!head.is_complete(steady_now_ns())) {
      const bool ends = is_cancelled && is_cancelled();
      if (ends && head.held().empty()) return failure(task::opening, problem::cancelled, name_);
      if (ends) break;
      if (!wait(POLLIN, std::min(steady_now_ns() + step_ns, head.due_ns()))) continue;
      const auto got = take(memory);
      if (got) {
        head.take(bytes(memory).first(*got), steady_now_ns());
      } else {
        end_ = got.error();
        head.finish();
      }
    }
    ahead_.assign(head.held().begin(), head.held().end());
    if (begins_recording(ahead_)) return a_recording(task::opening);
    stream_survey seen;
    seen.received(ahead_);
    seen.finish();
    if (const auto why = refusal_of(seen, name_)) return tl::unexpected(*why);
    return head.found();
  }

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    if (woken_.exchange(false)) return failure(task::reading, problem::cancelled, name_);
    if (!has_ahead() && !end_ && !wait(POLLIN, deadline_ns)) return received{};
    out = out.first(std::min(out.size(), counted_items::longest_piece));
    const auto got = has_ahead() ? take_ahead(out) : take(out);
    if (!got) return tl::unexpected(got.error());
    if (!std::exchange(has_begun_, true) && begins_recording(out.first(*got))) {
      return a_recording(task::reading);
    }
    return received{*got, steady_now_ns()};
  }
  [[nodiscard]] result<void> write(bytes, std::int64_t) noexcept override { return {}; }
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override {
    static_cast<void>(wait(0, deadline_ns));
    return {};
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return steady_now_ns(); }
  void wake() noexcept override { woken_.store(true); }
  [[nodiscard]] std::string_view name() const noexcept override { return name_; }
  [[nodiscard]] int native_handle() const noexcept override { return fd_.get(); }

 private:
  /// Waits until something can be read, at most until the deadline; the end counts, too.
  [[nodiscard]] bool wait(short events, std::int64_t deadline_ns) noexcept {
    const std::int64_t left_ms = (deadline_ns - steady_now_ns() + 999'999) / 1'000'000;
    pollfd waiting{events != 0 ? fd_.get() : -1, events, 0};
    return ::poll(&waiting, 1, static_cast<int>(std::clamp<std::int64_t>(left_ms, 0, 1000))) > 0;
  }
  [[nodiscard]] bool has_ahead() const noexcept { return given_ < ahead_.size(); }
  /// Of the bytes that were read while it was opened.
  [[nodiscard]] result<std::size_t> take_ahead(std::span<std::uint8_t> out) noexcept {
    const std::size_t count = std::min(out.size(), ahead_.size() - given_);
    std::copy_n(ahead_.begin() + static_cast<std::ptrdiff_t>(given_), count, out.begin());
    given_ += count;
    return count;
  }
  /// One call of read(), made only if it does not wait.
  [[nodiscard]] result<std::size_t> take(std::span<std::uint8_t> out) noexcept {
    if (end_) return tl::unexpected(*end_);
    while (true) {
      const ssize_t count = ::read(fd_.get(), out.data(), out.size());
      if (count > 0) return static_cast<std::size_t>(count);
      const bool has_gone = count < 0 && errno == EIO && ::isatty(fd_.get()) != 0;
      if (count == 0 || has_gone) return failure(task::reading, problem::end_of_input, name_);
      if (errno == EAGAIN) return std::size_t{0};
      if (errno != EINTR) return failure(task::reading, problem::system, name_, errno);
    }
  }

  owned_fd fd_;
  std::string name_;
  std::atomic<bool> woken_{false};
  bool has_begun_ = false;
  std::vector<std::uint8_t> ahead_;  // read while it was opened
  std::size_t given_ = 0;            // of them
  std::optional<error> end_;         // behind them
};

/// Returns its transport once.
class pipe_connector final : public connector {
 public:
  pipe_connector(std::unique_ptr<pipe_transport> port, const recorded_device& about)
      : port_(std::move(port)),
        recognised_(about.recognised.value_or(recognition{})),
        candidates_(candidates_of(about)) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    if (port_ == nullptr) return failure(task::opening, problem::end_of_input);
    return std::move(port_);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return steady_now_ns(); }
  [[nodiscard]] bool pause(std::int64_t) noexcept override { return true; }
  void wake() noexcept override {}
  [[nodiscard]] connector_traits traits() const noexcept override {
    connector_traits all{.answers = false, .recognised = recognised_};
    all.recognised.candidates = candidates_;
    return all;
  }

 private:
  std::unique_ptr<pipe_transport> port_;
  recognition recognised_;
  std::vector<const model*> candidates_;
};

recorded_device about(const recognised_model& found) {
  const model& which = *found.which;
  if (!found.is_usual()) {
    const bool is_stated = found.basis == recognised_by::number;
    return {.recognised = recognition{.model = &which,
                                      .by = is_stated ? known_by::number : known_by::nothing}};
  }
  const std::size_t size = sample_size(which.samples.layout);
  std::vector<const model*> all;
  const auto measures = [&](const model& row) {
    return may_measure(row, found.rate_hz, found.frequency_chz);
  };
  for (const model& row : models) {
    const bool fits = may_send(row, size, found.basis == recognised_by::flags) &&
                      (measures(row) || !measures(which));
    if (fits) all.push_back(&row);
  }
  return {.recognised = recognition{.model = &which, .by = known_by::samples},
          .candidates = set_of(all)};
}

recorded_device about(const model& named) {
  return {.recognised = recognition{.model = &named, .by = known_by::user}};
}

}  // namespace

result<std::unique_ptr<connector>> open_raw_bytes(const std::string& name,
                                                  std::optional<std::uint32_t> sample_rate_hz,
                                                  const playback_options& options,
                                                  std::function<bool()> is_cancelled,
                                                  const model* lidar_model) {
  if (const auto wrong = problem_with(options)) return tl::unexpected(*wrong);
  if (sample_rate_hz && (*sample_rate_hz < 1 || *sample_rate_hz > 1'000'000)) {
    return failure(task::configuring, problem::bad_option,
                   "raw_sample_rate_hz: 1 to 1000000, not " + std::to_string(*sample_rate_hz));
  }
  owned_fd fd = open_bytes(name);
  if (fd.get() < 0) return failure(task::opening, problem::system, name, errno);
  struct stat file{};
  const bool is_known = ::fstat(fd.get(), &file) == 0;
  if (is_known && S_ISDIR(file.st_mode)) {
    return failure(task::opening, problem::bad_file, name, EISDIR);
  }
  std::string title = name == "-" ? "standard input" : name;
  if (!is_known || !S_ISREG(file.st_mode)) {
    auto port = std::make_unique<pipe_transport>(std::move(fd), std::move(title));
    if (lidar_model != nullptr)
      return std::make_unique<pipe_connector>(std::move(port), about(*lidar_model));
    const auto found = port->recognise(is_cancelled);
    if (!found) return tl::unexpected(found.error());
    return std::make_unique<pipe_connector>(std::move(port), about(*found));
  }
  const off_t at = std::max<off_t>(::lseek(fd.get(), 0, SEEK_CUR), 0);
  std::array<std::uint8_t, 8> begin{};
  const ssize_t begun =
      uninterrupted([&] { return ::pread(fd.get(), begin.data(), begin.size(), at); });
  if (begun > 0 && begins_recording(bytes(begin))) return a_recording(task::opening);
  recognised_model found{lidar_model};
  if (lidar_model == nullptr) {
    const stream_survey seen = surveyed_at(fd, at);
    if (const auto why = refusal_of(seen, title)) return tl::unexpected(*why);
    found = model_of(seen);
  }
  const model& sent_by = *found.which;
  auto waits = std::make_shared<waker>(real_system_calls());
  auto items =
      std::make_unique<counted_items>(std::make_shared<const owned_fd>(std::move(fd)), at, title,
                                      sample_rate_hz.value_or(first_rate_hz(sent_by)),
                                      file.st_mtim.tv_sec * second_ns + file.st_mtim.tv_nsec,
                                      options.to_ns, std::move(is_cancelled), sent_by);
  if (auto moved = items->seek(options.from_ns); !moved) return tl::unexpected(moved.error());
  return connect_to(std::make_shared<played_file>(
      std::move(items), title, options, lidar_model != nullptr ? about(*lidar_model) : about(found),
      std::move(waits)));
}

}  // namespace g4lidar
