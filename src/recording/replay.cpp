// SPDX-License-Identifier: MIT
// A recording as a transport: the bytes of each read, and the events between the reads.
#include "g4lidar/recording/replay.hpp"

#include <sys/eventfd.h>
#include <sys/timerfd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <ctime>
#include <functional>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "core/saturating.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/recording/recorded_device.hpp"
#include "g4lidar/recording/recorded_event.hpp"
#include "replay_clock.hpp"
#include "transport/fd_port.hpp"

namespace g4lidar {
namespace {

/// At this rate a nanosecond of the recording takes a millisecond.
constexpr double least_rate = 1e-6;
constexpr double largest_rate = 1000;
/// Between the end and the next beginning of a repeated recording.
constexpr std::int64_t loop_pause_ns = 10'000'000;

/// The first device information in the bytes, if the recording has no metadata.
std::optional<recorded_device> device_in(std::string_view path,
                                         const std::function<bool()>& is_cancelled) {
  constexpr std::uint64_t far_enough = std::uint64_t{64} << 10U;
  auto reader = recording_reader::open(path, {.is_cancelled = is_cancelled});
  if (!reader) return std::nullopt;
  stream_parser parser;
  std::optional<recorded_device> found;
  std::uint64_t read = 0;
  static_cast<void>(reader->for_each([&](const recorded_item& item) {
    read += item.data.size() + 1;
    if (item.what != recorded_item::kind::from_device) return true;
    parser.feed(item.data, [&](const event& what) {
      const auto* const response = std::get_if<response_view>(&what);
      if (response == nullptr || found) return;
      if (const auto who = response->as_device_info()) found = recorded_device{.information = *who};
    });
    return !found && read < far_enough;
  }));
  return found;
}

/// The common part of the connector and its transport: the recording, its clock, and its events.
class player final : public recorded_event_source {
 public:
  /// A wake-up of `waits` also ends the reading of `opened`.
  player(recording_reader opened, std::string_view name, const replay_options& how,
         std::shared_ptr<waker> waits)
      : reader_(std::move(opened)),
        path_(name),
        options_(how),
        clock_(how.rate, begin_ns()),
        waits_(std::move(waits)),
        due_(make_handle()) {
    auto device = reader_.device();
    if (!device) device = device_in(name, options_.range.is_cancelled);
    if (device) device_ = *device;
  }

  [[nodiscard]] bool is_open() const noexcept { return waits_->is_open() && due_.get() >= 0; }
  [[nodiscard]] const recording_reader& reader() const noexcept { return reader_; }
  [[nodiscard]] replay_clock& clock() noexcept { return clock_; }
  [[nodiscard]] std::string_view path() const noexcept { return path_; }
  [[nodiscard]] int native_handle() const noexcept { return due_.get(); }
  [[nodiscard]] std::uint32_t baud() const noexcept { return baud_; }
  void wake() noexcept { waits_->wake(); }
  [[nodiscard]] bool take_wake() noexcept { return waits_->take() || take_cancelled(); }

  // ---- recorded_event_source ----

  [[nodiscard]] std::optional<recorded_event> next_event() noexcept override {
    if (std::exchange(is_shown_, false)) pop();
    const recorded_item* const next = peek();
    if (next == nullptr) return std::nullopt;  // read() returns the reason
    const recorded_item& item = *next;
    if (item.what == recorded_item::kind::from_device) {
      set_handle_for_next();
      return std::nullopt;
    }
    follow_wall_clock(item);
    is_shown_ = true;
    recorded_event what = item.other;
    what.time_ns = item.time_ns;
    if (item.what == recorded_item::kind::to_device) {
      what.what = recorded_event::kind::sent;
      what.data = item.data;
    }
    if (item.what == recorded_item::kind::odometry) {
      what.what = recorded_event::kind::odometry;
      what.odometry = item.odometry;
      what.odometry.time_ns = item.time_ns;  // in this round
    }
    if (what.what == recorded_event::kind::opened || what.what == recorded_event::kind::state) {
      baud_ = what.baud;
    }
    return what;
  }
  [[nodiscard]] const recorded_device& device() const noexcept override { return device_; }
  [[nodiscard]] std::int64_t deadline_after_ns(std::int64_t timeout_ns) const noexcept override {
    return clock_.after_ns(timeout_ns);
  }
  [[nodiscard]] std::int64_t wait_for_next_ns() noexcept override {
    if (clock_.is_free() || !item_) return 0;
    return std::max<std::int64_t>(clock_.steady_ns(item_->time_ns) - steady_now_ns(), 0);
  }
  [[nodiscard]] bool take_cancelled() noexcept override {
    return std::exchange(is_cancelled_, false);
  }

  // ---- for the transport ----

  /// The next item; null at the end, and after a failure. Valid until pop(). Reads without bytes
  /// are skipped.
  [[nodiscard]] recorded_item* peek() noexcept {
    while (recorded_item* const next = find_item()) {
      const bool is_nothing = next->data.empty() && next->what == recorded_item::kind::from_device;
      if (!is_nothing) return next;
      pop();
    }
    return nullptr;
  }
  /// Why there is no next item.
  [[nodiscard]] const error& take_why_over() noexcept {
    is_cancelled_ = false;
    return why_over_;
  }
  void pop() noexcept { item_.reset(); }
  /// When the handle becomes readable.
  void set_handle(std::int64_t at_ns) noexcept {
    if (std::exchange(set_for_ns_, at_ns) == at_ns) return;
    const std::int64_t due_ns = std::max<std::int64_t>(clock_.steady_ns(at_ns), 1);
    itimerspec due{};
    due.it_value = {static_cast<std::time_t>(due_ns / second_ns),
                    static_cast<long>(due_ns % second_ns)};
    timerfd_settime(due_.get(), TFD_TIMER_ABSTIME, &due, nullptr);
  }
  [[nodiscard]] std::optional<std::int64_t> wall_ahead_ns() const noexcept {
    return wall_ahead_ns_;
  }
  void set_handle_for_next() noexcept {
    if (clock_.is_free()) return;
    const recorded_item* const next = peek();
    // Odometry is not waited for: its time may be any.
    if (next && next->what != recorded_item::kind::odometry) set_handle(next->time_ns);
  }
  void follow_wall_clock(const recorded_item& item) noexcept {
    wall_ahead_ns_ = saturating_sub(item.wall_ns, item.time_ns);
  }

  /// Waits until then by the clock of the recording, or until a wake-up.
  [[nodiscard]] result<void> wait(std::int64_t until_ns) noexcept {
    if (clock_.is_free()) {
      if (waits_->take()) return failure(task::reading, problem::cancelled, path_);
      if (until_ns != never_ns) clock_.advance_to(until_ns);
      return {};
    }
    short found = 0;
    switch (
        waits_->wait(-1, 0, until_ns == never_ns ? never_ns : clock_.steady_ns(until_ns), &found)) {
      case waker::ended::woken:
        return failure(task::reading, problem::cancelled, path_);
      case waker::ended::failed:
        return failure(task::reading, problem::system, path_, errno);
      default:
        return {};
    }
  }

 private:
  [[nodiscard]] std::int64_t begin_ns() const noexcept {
    return saturating_add(reader_.first_ns(), std::max<std::int64_t>(options_.range.from_ns, 0));
  }
  /// The next item, with its time in the current round.
  [[nodiscard]] recorded_item* find_item() noexcept {
    if (!item_ && !is_over_ && !is_cancelled_) {
      auto read = reader_.next();
      if (read && !*read && options_.loop && has_read_) read = begin_again();
      why_over_ = read ? error(task::reading, problem::end_of_input, path_) : read.error();
      is_cancelled_ = !read && why_over_ == problem::cancelled;
      if (is_cancelled_) static_cast<void>(waits_->take());
      if (read) item_ = *read;
      is_over_ = !item_ && !is_cancelled_;
      if (item_) item_->time_ns = saturating_add(item_->time_ns, moved_ns_);
      if (item_) item_->wall_ns = saturating_add(item_->wall_ns, moved_ns_);
    }
    if (!item_) return nullptr;
    if (item_->what != recorded_item::kind::odometry) last_ns_ = item_->time_ns;
    has_read_ = has_read_ || item_->what == recorded_item::kind::from_device;
    return &*item_;
  }
  /// Always readable, or when the time has come.
  [[nodiscard]] int make_handle() const noexcept {
    return clock_.is_free() ? eventfd(1, EFD_CLOEXEC | EFD_NONBLOCK)
                            : timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
  }
  /// Starts again from the front, later than the end; an event separates the first item from the
  /// last one.
  [[nodiscard]] result<std::optional<recorded_item>> begin_again() noexcept {
    try {
      auto again = recording_reader::open(path_, options_.range);
      if (!again) return tl::unexpected(again.error());
      reader_ = std::move(*again);
    } catch (const std::bad_alloc&) {
      return failure(task::reading, problem::system, path_, ENOMEM);
    }
    has_read_ = false;
    const std::int64_t begin = begin_ns();
    moved_ns_ = saturating_sub(saturating_add(last_ns_, loop_pause_ns), begin);
    recorded_item seam{recorded_item::kind::other, begin, begin, {}, {}};
    seam.other.what = recorded_event::kind::gap;
    return seam;
  }

  recording_reader reader_;
  std::string path_;
  replay_options options_;
  replay_clock clock_;
  std::shared_ptr<waker> waits_;
  owned_fd due_;
  recorded_device device_{};
  std::uint32_t baud_ = 0;
  std::optional<std::int64_t> wall_ahead_ns_;
  std::optional<std::int64_t> set_for_ns_;  // the handle
  bool is_shown_ = false;                   // next_event() has returned the next item
  std::optional<recorded_item> item_;
  std::int64_t moved_ns_ = 0;  // by the previous rounds
  std::int64_t last_ns_ = 0;
  bool has_read_ = false;  // bytes were read from a device in this round
  bool is_over_ = false;
  bool is_cancelled_ = false;  // not reported yet
  error why_over_{task::reading, problem::end_of_input};
};

class replay_transport final : public transport {
 public:
  explicit replay_transport(std::shared_ptr<player> of) noexcept : of_(std::move(of)) {}

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    assert(!out.empty());
    if (of_->take_wake()) return failure(task::reading, problem::cancelled, name());
    while (of_->next_event()) continue;  // for callers that do not take events
    recorded_item* const next = of_->peek();
    if (next == nullptr) return tl::unexpected(of_->take_why_over());
    recorded_item& item = *next;
    if (!of_->clock().is_free() && of_->clock().now_ns() < item.time_ns) {
      of_->set_handle(item.time_ns);
      auto waited = of_->wait(std::min(item.time_ns, deadline_ns));
      if (!waited) return tl::unexpected(waited.error());
      if (of_->clock().now_ns() < item.time_ns) return received{};
    }
    of_->clock().advance_to(item.time_ns);
    of_->follow_wall_clock(item);
    const received got{std::min(out.size(), item.data.size()), item.time_ns};
    std::ranges::copy(item.data.first(got.count), out.begin());
    item.data = item.data.subspan(got.count);
    if (item.data.empty()) of_->pop();
    of_->set_handle_for_next();
    return got;
  }

  /// No device receives it.
  [[nodiscard]] result<void> write(bytes, std::int64_t) noexcept override {
    if (of_->take_wake()) return failure(task::writing, problem::cancelled, name());
    return {};
  }
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override {
    return of_->wait(deadline_ns);
  }

  [[nodiscard]] std::int64_t now_ns() const noexcept override { return of_->clock().now_ns(); }
  void wake() noexcept override { of_->wake(); }
  [[nodiscard]] int native_handle() const noexcept override { return of_->native_handle(); }
  [[nodiscard]] std::string_view name() const noexcept override { return of_->path(); }
  [[nodiscard]] std::uint32_t baud() const noexcept override { return of_->baud(); }

 private:
  std::shared_ptr<player> of_;
};

class replay_connector final : public connector, public recording_hook {
 public:
  explicit replay_connector(std::shared_ptr<player> of) noexcept : of_(std::move(of)) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    if (std::exchange(is_connected_, true)) {
      return failure(task::reading, problem::end_of_input, of_->path());
    }
    auto* const made = new (std::nothrow) replay_transport(of_);
    if (made == nullptr) return failure(task::opening, problem::system, of_->path(), ENOMEM);
    return std::unique_ptr<transport>(made);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return of_->clock().now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override {
    return of_->wait(deadline_ns).has_value();
  }
  void wake() noexcept override { of_->wake(); }
  [[nodiscard]] recorded_event_source* events() noexcept override { return of_.get(); }
  [[nodiscard]] connector_traits traits() const noexcept override {
    return {.answers = false, .wall_ahead_ns = of_->wall_ahead_ns()};
  }
  [[nodiscard]] const recording_reader& reader() const noexcept { return of_->reader(); }

 private:
  std::shared_ptr<player> of_;
  bool is_connected_ = false;
};

}  // namespace

const recording_reader* replay::reader_of(const connector& from) noexcept {
  const auto* const played = dynamic_cast<const replay_connector*>(&from);
  return played == nullptr ? nullptr : &played->reader();
}

result<std::unique_ptr<connector>> replay::open(std::string_view path,
                                                const replay_options& options) {
  const auto bad = [](std::string_view what) {
    return failure(task::configuring, problem::bad_option, what);
  };
  const bool is_rate = options.rate == 0 || options.rate >= least_rate;
  if (!is_rate || options.rate > largest_rate) return bad("rate: 0, or 0.000001 to 1000");
  if (options.range.from_ns >= options.range.to_ns) return bad("range: from before to");
  auto waits = std::make_shared<waker>(real_system_calls());
  replay_options how = options;
  how.range.is_cancelled = [waits, asked = options.range.is_cancelled] {
    return waits->is_woken() || (asked && asked());
  };
  auto reader = recording_reader::open(path, how.range);
  if (!reader) return tl::unexpected(reader.error());
  auto of = std::make_shared<player>(std::move(*reader), path, how, std::move(waits));
  if (!of->is_open()) return failure(task::opening, problem::system, "eventfd", errno);
  return std::make_unique<replay_connector>(std::move(of));
}

}  // namespace g4lidar
