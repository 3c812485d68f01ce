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

#include "byte_survey.hpp"
#include "g4lidar/core/model_choice.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/recording/recorded_event.hpp"
#include "g4lidar/transport/transport.hpp"
#include "played_file.hpp"
#include "recording/mcap/format.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar {
namespace {

/// The time of the first bytes of a file; 0 would mean that it is not known.
constexpr std::int64_t file_begin_ns = second_ns;
/// Of bytes that belong to no packet; of those of a pipe, whose points a ring can hold.
constexpr std::size_t longest_piece = 16'384;

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
    out = out.first(std::min(out.size(), longest_piece));
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

/// The bytes of a file: their times are counted from samples.
class counted_items final : public item_source {
 public:
  /// Of the file behind `fd` from `offset` on, whose first sample was measured at `wall_ns`.
  counted_items(std::shared_ptr<const owned_fd> fd, off_t offset, std::string name,
                std::uint32_t sample_rate_hz, std::int64_t wall_ns, std::int64_t to_ns,
                std::function<bool()> is_cancelled, const g4lidar::model& model)
      : fd_(std::move(fd)),
        file_begin_(offset),
        name_(std::move(name)),
        rate_hz_(sample_rate_hz),
        wall_ahead_ns_(wall_ns - file_begin_ns),
        to_ns_(detail::saturating_add(file_begin_ns, to_ns)),
        is_cancelled_(std::move(is_cancelled)),
        model_(&model) {}

  [[nodiscard]] std::uint32_t counted_hz() const noexcept override {
    return static_cast<std::uint32_t>(rate_hz_);
  }
  [[nodiscard]] result<std::optional<recorded_item>> next() noexcept override {
    while (true) {
      auto piece = find_piece();
      if (!piece) return tl::unexpected(piece.error());
      if (piece->empty() || now_ns_ >= to_ns_) return std::nullopt;
      if (now_ns_ < from_ns_) continue;
      return recorded_item{recorded_item::kind::from_device,
                           now_ns_,
                           detail::saturating_add(now_ns_, wall_ahead_ns_),
                           *piece,
                           {}};
    }
  }
  [[nodiscard]] result<void> seek(std::int64_t from_ns) noexcept override {
    from_ns_ = detail::saturating_add(file_begin_ns, from_ns);
    now_ns_ = file_begin_ns;
    read_ = 0;
    begin_ = parsed_ = end_ = 0;
    samples_ = 0;
    parser_ = stream_parser(model_->samples);
    return {};
  }
  [[nodiscard]] std::int64_t first_ns() const noexcept override { return file_begin_ns; }
  [[nodiscard]] std::int64_t last_ns() noexcept override {
    if (!last_ns_) {
      counted_items all(fd_, file_begin_, name_, static_cast<std::uint32_t>(rate_hz_), 0, never_ns,
                        is_cancelled_, *model_);
      for (auto piece = all.find_piece(); piece && !piece->empty();) piece = all.find_piece();
      last_ns_ = all.now_ns_;
    }
    return *last_ns_;
  }
  [[nodiscard]] const g4lidar::model& model() const noexcept override { return *model_; }

 private:
  /// Up to the end of the next packet, whose samples have been measured by then: no part of it arrives
  /// before. Empty at the end. Valid until the next call.
  [[nodiscard]] result<bytes> find_piece() noexcept {
    while (!parse() && end_ - begin_ < longest_piece) {
      std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
      end_ = parsed_ = end_ - begin_;
      begin_ = 0;
      if (is_cancelled_ && is_cancelled_())
        return failure(task::reading, problem::cancelled, name_);
      const ssize_t count = uninterrupted([&] {
        return ::pread(fd_->get(), buffer_.data() + end_, buffer_.size() - end_,
                       file_begin_ + read_);
      });
      if (count < 0) return failure(task::reading, problem::system, name_, errno);
      if (count == 0) break;
      end_ += static_cast<std::size_t>(count);
      read_ += count;
    }
    const std::size_t from = std::exchange(begin_, parsed_);
    return bytes(buffer_).subspan(from, parsed_ - from);
  }
  /// Whether there was a packet; then everything up to its end is parsed.
  [[nodiscard]] bool parse() noexcept {
    bytes rest = bytes(buffer_).subspan(parsed_, end_ - parsed_);
    while (const auto found = parser_.next(rest)) {
      const auto* const packet = std::get_if<packet_view>(&*found);
      if (packet == nullptr) continue;
      if (samples_ > 0 || !packet->is_suspect()) count(packet->sample_count());  // from a point on
      parsed_ = end_ - rest.size();
      return true;
    }
    parsed_ = end_;
    return false;
  }
  void count(std::size_t samples) noexcept {
    samples_ += static_cast<std::int64_t>(samples);
    now_ns_ = file_begin_ns + samples_ / rate_hz_ * second_ns +
              samples_ % rate_hz_ * second_ns / rate_hz_;
  }

  std::shared_ptr<const owned_fd> fd_;
  off_t file_begin_;
  std::string name_;
  std::int64_t rate_hz_;
  std::int64_t wall_ahead_ns_;
  std::int64_t from_ns_ = 0;
  std::int64_t to_ns_;
  std::function<bool()> is_cancelled_;
  std::int64_t now_ns_ = file_begin_ns;
  std::optional<std::int64_t> last_ns_;
  std::int64_t samples_ = 0;
  const g4lidar::model* model_;
  stream_parser parser_{model_->samples};
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(65'536);
  off_t read_ = 0;          // of the file
  std::size_t begin_ = 0;   // of the bytes that were not returned yet
  std::size_t parsed_ = 0;  // up to here
  std::size_t end_ = 0;
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
    return may_measure(row, found.rate_hz, found.frequency_dhz);
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
