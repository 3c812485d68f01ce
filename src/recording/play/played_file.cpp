// SPDX-License-Identifier: MIT
#include "played_file.hpp"

#include <sys/timerfd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <ctime>
#include <new>

#include "g4lidar/recording/reader.hpp"

namespace g4lidar {
namespace {

/// At this speed a nanosecond of the recording takes a millisecond.
constexpr double least_speed = 1e-6;
constexpr double largest_speed = 1000;
/// Between the end and the next beginning of a repeated recording.
constexpr std::int64_t loop_pause_ns = 10'000'000;

bool is_speed(double speed) noexcept {
  return speed == 0 || (speed >= least_speed && speed <= largest_speed);
}

error bad(std::string_view what) noexcept { return {task::configuring, problem::bad_option, what}; }

/// The time of the clock at the beginning of what is played.
std::int64_t begin_of(const item_source& items, std::int64_t from_ns) noexcept {
  return detail::saturating_add(items.first_ns(), std::max<std::int64_t>(from_ns, 0));
}

}  // namespace

std::optional<error> problem_with(const playback_options& options) noexcept {
  if (!is_speed(options.speed)) return bad("speed: 0, or 0.000001 to 1000");
  if (options.from_ns >= options.to_ns)
    return bad("the end of the range (--to) is not after its begin (--from)");
  return std::nullopt;
}

// ---- the items ----

recorded_item* item_rounds::peek() noexcept {
  while (recorded_item* const next = find_item()) {
    const bool is_nothing = next->data.empty() && next->what == recorded_item::kind::from_device;
    if (!is_nothing) return next;
    pop();
  }
  return nullptr;
}

recorded_item* item_rounds::find_item() noexcept {
  if (!item_ && !is_over_ && !is_cancelled_) {
    auto read = from_->next();
    if (read && !*read && options_.loop && has_read_) read = begin_again();
    if (!read) why_over_ = read.error();
    if (read && !*read) why_over_ = error(task::reading, problem::end_of_input, path_);
    is_cancelled_ = !read && why_over_ == problem::cancelled;
    if (is_cancelled_) static_cast<void>(waits_->take());
    if (read) item_ = *read;
    is_over_ = !item_ && !is_cancelled_;
    if (item_) item_->time_ns = detail::saturating_add(item_->time_ns, moved_ns_);
    if (item_) item_->wall_ns = detail::saturating_add(item_->wall_ns, moved_ns_);
  }
  if (!item_) return nullptr;
  if (item_->what != recorded_item::kind::odometry) last_ns_ = item_->time_ns;
  has_read_ = has_read_ || item_->what == recorded_item::kind::from_device;
  return &*item_;
}

/// Starts again from the front, later than the end; an event separates the first item from the last one.
result<std::optional<recorded_item>> item_rounds::begin_again() noexcept {
  if (auto moved = from_->seek(options_.from_ns); !moved) return tl::unexpected(moved.error());
  has_read_ = false;
  const std::int64_t begin = begin_of(*from_, options_.from_ns);
  moved_ns_ = detail::saturating_sub(detail::saturating_add(last_ns_, loop_pause_ns), begin);
  recorded_item seam{recorded_item::kind::other, begin, begin, {}, {}};
  seam.other.what = recorded_event::kind::gap;
  return seam;
}

result<void> item_rounds::seek(std::int64_t from_ns) noexcept {
  // A wake-up that an earlier call has served may be left here: it would end this one.
  static_cast<void>(waits_->take());
  if (auto moved = from_->seek(from_ns); !moved) return moved;
  item_.reset();
  moved_ns_ = 0;
  has_read_ = is_over_ = is_cancelled_ = false;
  return {};
}

// ---- the file ----

played_file::played_file(std::unique_ptr<item_source> items, std::string_view path,
                         const playback_options& options, const recorded_device& device,
                         std::shared_ptr<waker> waits)
    : items_(std::move(items), path, options, waits),
      clock_(options.speed, begin_of(items_.source(), options.from_ns)),
      waits_(std::move(waits)),
      due_(timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK)),
      device_(device) {
  follow_clock();
}

result<received> played_file::read(std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept {
  assert(!out.empty());
  if (take_wake()) return failure(task::reading, problem::cancelled, items_.path());
  if (clock_.is_paused()) {
    if (auto waited = wait(deadline_ns); !waited) return tl::unexpected(waited.error());
    return received{};
  }
  while (next_event()) continue;  // for callers that do not take events
  recorded_item* const next = items_.peek();
  if (next == nullptr) return tl::unexpected(items_.take_why_over());
  recorded_item& item = *next;
  if (!clock_.is_free() && clock_.now_ns() < item.time_ns) {
    set_handle(item.time_ns);
    auto waited = wait(std::min(item.time_ns, deadline_ns));
    if (!waited) return tl::unexpected(waited.error());
    if (clock_.now_ns() < item.time_ns) return received{};
  }
  clock_.advance_to(item.time_ns);
  follow_wall_clock(item);
  const received got{std::min(out.size(), item.data.size()), item.time_ns};
  std::ranges::copy(item.data.first(got.count), out.begin());
  item.data = item.data.subspan(got.count);
  if (item.data.empty()) items_.pop();
  set_handle_for_next();
  return got;
}

/// Waits until then by the clock of the recording, or until a wake-up.
result<void> played_file::wait(std::int64_t until_ns) noexcept {
  if (clock_.is_free()) {
    if (waits_->take()) return failure(task::reading, problem::cancelled, items_.path());
    if (until_ns != never_ns) clock_.advance_to(until_ns);
    return {};
  }
  short found = 0;
  const std::int64_t steady_ns = until_ns == never_ns ? never_ns : clock_.steady_ns(until_ns);
  switch (waits_->wait(-1, 0, steady_ns, &found)) {
    case waker::ended::woken:
      return failure(task::reading, problem::cancelled, items_.path());
    case waker::ended::failed:
      return failure(task::reading, problem::system, items_.path(), errno);
    default:
      return {};
  }
}

std::optional<recorded_event> played_file::next_event() noexcept {
  if (std::exchange(is_shown_, false)) items_.pop();
  const recorded_item* const next = items_.peek();
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

/// The time of raw bytes that are read as fast as possible passes by reading alone.
std::int64_t played_file::deadline_after_ns(std::int64_t timeout_ns) const noexcept {
  const bool is_counted = clock_.is_free() && items_.source().recording() == nullptr;
  return is_counted && timeout_ns > 0 ? never_ns : detail::saturating_add(caller_ns(), timeout_ns);
}

std::int64_t played_file::wait_for_next_ns() noexcept {
  if (clock_.is_free() || clock_.is_paused()) return 0;
  const recorded_item* const next = items_.peek();
  if (next == nullptr) return 0;
  return std::max<std::int64_t>(
      detail::saturating_sub(clock_.steady_ns(next->time_ns), steady_now_ns()), 0);
}

std::optional<std::int64_t> played_file::wall_ahead_ns() noexcept {
  const recorded_item* const next = wall_ahead_ns_ ? nullptr : items_.peek();
  if (next != nullptr) follow_wall_clock(*next);
  return wall_ahead_ns_;
}

void played_file::follow_clock() noexcept {
  set_for_ns_ = never_ns;
  itimerspec due{};  // of a paused clock: never
  if (clock_.is_free()) due.it_value.tv_nsec = 1;
  timerfd_settime(due_.get(), TFD_TIMER_ABSTIME, &due, nullptr);
  set_handle_for_next();
}

/// When the handle becomes readable.
void played_file::set_handle(std::int64_t at_ns) noexcept {
  if (std::exchange(set_for_ns_, at_ns) == at_ns) return;
  const std::int64_t due_ns = std::max<std::int64_t>(clock_.steady_ns(at_ns), 1);
  itimerspec due{};
  due.it_value = {static_cast<std::time_t>(due_ns / second_ns),
                  static_cast<long>(due_ns % second_ns)};
  timerfd_settime(due_.get(), TFD_TIMER_ABSTIME, &due, nullptr);
}

void played_file::set_handle_for_next() noexcept {
  if (clock_.is_free() || clock_.is_paused()) return;
  const recorded_item* const next = items_.peek();
  // Odometry is not waited for: its time may be any.
  if (next && next->what != recorded_item::kind::odometry) set_handle(next->time_ns);
}

result<void> played_file::move_to(std::int64_t position_ns) noexcept {
  if (auto moved = items_.seek(position_ns); !moved) return moved;
  clock_.seek(begin_of(items_.source(), position_ns));
  is_shown_ = false;
  may_connect_ = true;
  follow_clock();
  return {};
}

// ---- the player ----

void file_player::pause(bool pauses) noexcept {
  of_.clock().pause(pauses);
  of_.follow_clock();
}
bool file_player::is_paused() const noexcept { return of_.clock().is_paused(); }

result<void> file_player::set_speed(double speed) noexcept {
  if (const auto wrong = problem_with({.speed = speed})) return tl::unexpected(*wrong);
  of_.clock().set_speed(speed);
  of_.follow_clock();
  return {};
}
double file_player::speed() const noexcept { return of_.clock().speed(); }

void file_player::set_loop(bool loops) noexcept { of_.items().set_loop(loops); }

result<void> file_player::seek(std::int64_t position_ns) noexcept {
  if (!may_seek_) return tl::unexpected(bad("seek: of a lidar that is not recorded"));
  const std::int64_t to_ns = std::clamp<std::int64_t>(position_ns, 0, length_ns());
  if (auto moved = of_.move_to(to_ns); !moved) return moved;
  if (moved_) moved_();
  return {};
}

std::int64_t file_player::begin_ns() noexcept { return of_.items().first_ns(); }
std::int64_t file_player::position_ns() noexcept {
  const std::int64_t since_ns = detail::saturating_sub(of_.clock().now_ns(), begin_ns());
  return std::clamp<std::int64_t>(since_ns, 0, length_ns());
}

std::int64_t file_player::length_ns() noexcept {
  item_source& from = of_.items().source();
  return std::max<std::int64_t>(detail::saturating_sub(from.last_ns(), from.first_ns()), 0);
}

std::int64_t file_player::wall_ns(std::int64_t time_ns) noexcept {
  return detail::saturating_add(time_ns, of_.wall_ahead_ns().value_or(0));
}

}  // namespace g4lidar
