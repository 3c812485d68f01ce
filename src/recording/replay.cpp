// SPDX-License-Identifier: MIT
// A recording as a line: each reading as it was read, and what happened between the readings.
#include "g4lidar/replay.hpp"

#include <sys/eventfd.h>
#include <sys/timerfd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <ctime>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "../device/fd_port.hpp"
#include "g4lidar/recorded_device.hpp"
#include "g4lidar/stream_parser.hpp"

namespace g4lidar {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr double largest_rate = 1000;
/// Between the end and the beginning of a recording that is played again.
constexpr std::int64_t loop_pause_ns = 10'000'000;

/// The clock of the line that was recorded. At rate 0 it is moved on by what is read.
class replay_clock {
 public:
  replay_clock(double rate, std::int64_t begin_ns) noexcept
      : rate_(rate), begin_ns_(begin_ns), now_ns_(begin_ns), begun_ns_(steady_now_ns()) {}

  [[nodiscard]] bool is_free() const noexcept { return rate_ == 0; }
  [[nodiscard]] std::int64_t now_ns() const noexcept {
    if (is_free()) return now_ns_;
    const auto since = static_cast<double>(steady_now_ns() - begun_ns_) * rate_;
    return std::max(now_ns_, begin_ns_ + static_cast<std::int64_t>(since));
  }
  /// When it will be `at_ns` here, by the steady clock.
  [[nodiscard]] std::int64_t steady_ns(std::int64_t at_ns) const noexcept {
    const double left = static_cast<double>(at_ns - begin_ns_) / rate_;
    constexpr double never = 9e18;
    const double due = static_cast<double>(begun_ns_) + std::max(left, 0.0);
    return due > never ? never_ns : begun_ns_ + static_cast<std::int64_t>(std::max(left, 0.0));
  }
  /// It never goes back.
  void advance_to(std::int64_t at_ns) noexcept { now_ns_ = std::max(now_ns_, at_ns); }

 private:
  double rate_;
  std::int64_t begin_ns_;
  std::int64_t now_ns_;
  std::int64_t begun_ns_;
};

/// What a lidar says of itself first, where nobody has kept it.
std::optional<recorded_device> device_in(std::string_view path) {
  constexpr std::uint64_t far_enough = std::uint64_t{1} << 20U;
  auto reader = recording_reader::open(path);
  if (!reader) return std::nullopt;
  stream_parser parser;
  std::optional<recorded_device> found;
  std::uint64_t read = 0;
  while (!found && read < far_enough) {
    const auto next = reader->next();
    if (!next) break;
    const std::optional<recorded_item> item = *next;
    if (!item) break;
    read += item->data.size() + 1;
    if (item->what != recorded_item::kind::from_device) continue;
    parser.feed(item->data, [&](const event& what) {
      const auto* const response = std::get_if<response_view>(&what);
      if (response == nullptr || found) return;
      if (const auto who = response->as_device_info()) found = recorded_device{.information = *who};
    });
  }
  return found;
}

/// What the connector and its line have in common.
class player {
 public:
  player(recording_reader opened, std::string_view name, const replay_options& how)
      : reader_(std::move(opened)),
        path_(name),
        options_(how),
        clock_(how.rate, reader_.first_ns() + std::max<std::int64_t>(how.range.from_ns, 0)),
        waits_(real_system_calls()) {
    auto device = reader_.device();
    if (!device) device = device_in(name);
    if (device) device_ = *device;
  }

  [[nodiscard]] bool is_open() const noexcept { return waits_.is_open(); }
  [[nodiscard]] const recording_reader& reader() const noexcept { return reader_; }
  [[nodiscard]] replay_clock& clock() noexcept { return clock_; }
  [[nodiscard]] const replay_clock& clock() const noexcept { return clock_; }
  [[nodiscard]] const recorded_device& device() const noexcept { return device_; }
  [[nodiscard]] std::string_view path() const noexcept { return path_; }
  void wake() noexcept { waits_.wake(); }
  [[nodiscard]] bool take_wake() noexcept { return waits_.take(); }

  /// What comes next, with its time moved to where this round stands; nothing at the end. Good until
  /// pop().
  [[nodiscard]] result<recorded_item*> next() noexcept {
    if (!item_ && !is_over_) {
      auto read = reader_.next();
      if (read && !*read && options_.loop && has_read_) read = begin_again();
      if (!read) return tl::unexpected(read.error());
      item_ = *read;
      is_over_ = !item_;
      if (item_) item_->time_ns += moved_ns_;
      if (item_) item_->wall_ns += moved_ns_;
    }
    if (!item_) return nullptr;
    last_ns_ = item_->time_ns;
    has_read_ = has_read_ || item_->what == recorded_item::kind::from_device;
    return &*item_;
  }
  void pop() noexcept { item_.reset(); }

  /// Until then by the clock of the recording, or until a wake-up.
  [[nodiscard]] result<void> wait(std::int64_t until_ns) noexcept {
    if (clock_.is_free()) {
      if (waits_.take()) return failure(task::reading, problem::cancelled, path_);
      if (until_ns != never_ns) clock_.advance_to(until_ns);
      return {};
    }
    short found = 0;
    switch (
        waits_.wait(-1, 0, until_ns == never_ns ? never_ns : clock_.steady_ns(until_ns), &found)) {
      case waker::ended::woken:
        return failure(task::reading, problem::cancelled, path_);
      case waker::ended::failed:
        return failure(task::reading, problem::system, path_, errno);
      default:
        return {};
    }
  }

 private:
  /// From the front, later than the end; what comes first is told not to belong to what came last.
  [[nodiscard]] result<std::optional<recorded_item>> begin_again() noexcept {
    try {
      auto again = recording_reader::open(path_, options_.range);
      if (!again) return tl::unexpected(again.error());
      reader_ = std::move(*again);
    } catch (const std::bad_alloc&) {
      return failure(task::reading, problem::system, path_, ENOMEM);
    }
    has_read_ = false;
    const std::int64_t begin_ns =
        reader_.first_ns() + std::max<std::int64_t>(options_.range.from_ns, 0);
    moved_ns_ = last_ns_ + loop_pause_ns - begin_ns;
    recorded_item seam{recorded_item::kind::note, begin_ns, begin_ns, {}, {}};
    seam.note.what = line_note::kind::gap;
    return seam;
  }

  recording_reader reader_;
  std::string path_;
  replay_options options_;
  replay_clock clock_;
  waker waits_;
  recorded_device device_{};
  std::optional<recorded_item> item_;
  std::int64_t moved_ns_ = 0;  // by the rounds before
  std::int64_t last_ns_ = 0;
  bool has_read_ = false;  // anything from a device in this round
  bool is_over_ = false;
};

class replay_line final : public transport {
 public:
  explicit replay_line(std::shared_ptr<player> of) noexcept
      : of_(std::move(of)), due_(real_system_calls(), make_handle(of_->clock().is_free())) {}

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    assert(!out.empty());
    if (of_->take_wake()) return failure(task::reading, problem::cancelled, name());
    while (noted()) {
      // For who does not ask.
    }
    const auto next = peek();
    if (!next) return tl::unexpected(next.error());
    if (*next == nullptr) return failure(task::reading, problem::end_of_input, name());
    recorded_item& item = **next;
    if (!of_->clock().is_free() && of_->clock().now_ns() < item.time_ns) {
      set_handle(item.time_ns);
      auto waited = of_->wait(std::min(item.time_ns, deadline_ns));
      if (!waited) return tl::unexpected(waited.error());
      if (of_->clock().now_ns() < item.time_ns) return received{};
    }
    of_->clock().advance_to(item.time_ns);
    wall_ahead_ns_ = item.wall_ns - item.time_ns;
    const received got{std::min(out.size(), item.data.size()), item.time_ns};
    std::ranges::copy(item.data.first(got.count), out.begin());
    item.data = item.data.subspan(got.count);
    if (item.data.empty()) of_->pop();
    return got;
  }

  /// Nothing hears it.
  [[nodiscard]] result<void> write(bytes, std::int64_t) noexcept override {
    if (of_->take_wake()) return failure(task::writing, problem::cancelled, name());
    return {};
  }
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override {
    return of_->wait(deadline_ns);
  }

  [[nodiscard]] std::optional<line_note> noted() noexcept override {
    if (std::exchange(is_shown_, false)) of_->pop();
    const auto next = peek();
    if (!next || *next == nullptr) return std::nullopt;  // read() tells
    const recorded_item& item = **next;
    if (item.what == recorded_item::kind::from_device) {
      if (!of_->clock().is_free()) set_handle(item.time_ns);
      return std::nullopt;
    }
    wall_ahead_ns_ = item.wall_ns - item.time_ns;
    is_shown_ = true;
    line_note what = item.note;
    what.time_ns = item.time_ns;
    if (item.what == recorded_item::kind::to_device) {
      what.what = line_note::kind::sent;
      what.data = item.data;
    }
    if (what.what == line_note::kind::opened || what.what == line_note::kind::state) {
      baud_ = what.baud;
    }
    return what;
  }

  [[nodiscard]] std::int64_t now_ns() const noexcept override { return of_->clock().now_ns(); }
  void wake() noexcept override { of_->wake(); }
  [[nodiscard]] int native_handle() const noexcept override { return due_.get(); }
  [[nodiscard]] std::string_view name() const noexcept override { return of_->path(); }
  [[nodiscard]] bool answers() const noexcept override { return false; }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return baud_; }
  [[nodiscard]] const recorded_device* recorded() const noexcept override { return &of_->device(); }
  [[nodiscard]] std::optional<std::int64_t> wall_ahead_ns() const noexcept override {
    return wall_ahead_ns_;
  }

 private:
  /// Readable always, or by the time.
  [[nodiscard]] static int make_handle(bool is_free) noexcept {
    return is_free ? eventfd(1, EFD_CLOEXEC | EFD_NONBLOCK)
                   : timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
  }
  void set_handle(std::int64_t at_ns) const noexcept {
    const std::int64_t due_ns = std::max<std::int64_t>(of_->clock().steady_ns(at_ns), 1);
    itimerspec due{};
    due.it_value = {static_cast<std::time_t>(due_ns / second_ns),
                    static_cast<long>(due_ns % second_ns)};
    timerfd_settime(due_.get(), TFD_TIMER_ABSTIME, &due, nullptr);
  }
  /// Readings of nothing are nothing.
  [[nodiscard]] result<recorded_item*> peek() noexcept {
    while (true) {
      auto next = of_->next();
      const bool is_nothing = next && *next != nullptr && (*next)->data.empty() &&
                              (*next)->what == recorded_item::kind::from_device;
      if (!is_nothing) return next;
      of_->pop();
    }
  }

  std::shared_ptr<player> of_;
  owned_fd due_;
  std::uint32_t baud_ = 0;
  bool is_shown_ = false;  // the next thing has been given by noted()
  std::optional<std::int64_t> wall_ahead_ns_;
};

class replay_connector final : public connector {
 public:
  explicit replay_connector(std::shared_ptr<player> of) noexcept : of_(std::move(of)) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    if (std::exchange(is_connected_, true)) {
      return failure(task::reading, problem::end_of_input, of_->path());
    }
    auto* const made = new (std::nothrow) replay_line(of_);
    if (made == nullptr) return failure(task::opening, problem::system, of_->path(), ENOMEM);
    std::unique_ptr<transport> line(made);
    if (made->native_handle() < 0) {
      return failure(task::opening, problem::system, of_->path(), errno);
    }
    return line;
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return of_->clock().now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override {
    return of_->wait(deadline_ns).has_value();
  }
  void wake() noexcept override { of_->wake(); }
  [[nodiscard]] const recording_reader& reader() const noexcept { return of_->reader(); }

 private:
  std::shared_ptr<player> of_;
  bool is_connected_ = false;
};

}  // namespace

const recording_reader* replay::reader_of(const connector& line) noexcept {
  const auto* const played = dynamic_cast<const replay_connector*>(&line);
  return played == nullptr ? nullptr : &played->reader();
}

result<std::unique_ptr<connector>> replay::open(std::string_view path,
                                                const replay_options& options) {
  const auto bad = [](std::string_view what) {
    return failure(task::configuring, problem::bad_option, what);
  };
  if (!(options.rate >= 0 && options.rate <= largest_rate)) return bad("rate: 0 to 1000");
  if (options.range.from_ns >= options.range.to_ns) return bad("range: from before to");
  auto reader = recording_reader::open(path, options.range);
  if (!reader) return tl::unexpected(reader.error());
  auto of = std::make_shared<player>(std::move(*reader), path, options);
  if (!of->is_open()) return failure(task::opening, problem::system, "eventfd", errno);
  return std::make_unique<replay_connector>(std::move(of));
}

}  // namespace g4lidar
