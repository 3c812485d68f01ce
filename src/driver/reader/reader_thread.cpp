// SPDX-License-Identifier: MIT
#include "reader_thread.hpp"

#include <algorithm>
#include <memory>
#include <system_error>
#include <utility>

#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;

constexpr auto retry_interval = 500ms;
constexpr std::chrono::milliseconds longest_wait = 100ms;
/// Before the end of a file, so that a seek gives something.
constexpr std::int64_t least_rest_ns = 1'000'000'000;

bool is_same(const std::optional<error>& a, const std::optional<error>& b) {
  return a && b ? a->message() == b->message() : a.has_value() == b.has_value();
}

/// What the current thread runs.
thread_local const void* in_thread_of = nullptr;

std::size_t depth_of(const reader_options& how) noexcept { return how.newest_only ? 1 : 4; }

}  // namespace

background_reader::thread::thread(const lidar_options& options, const reader_options& reading,
                                  reader_listener* listener)
    : options_(options),
      how_(reading),
      listener_(listener != nullptr
                    ? listener
                    : (queue = std::make_unique<reader_queue>(
                           depth_of(reading), options.model != nullptr ? *options.model : g4_model))
                          .get()),
      playback_{.speed = options.playback.speed} {
  options_.is_cancelled = [this, inner = options.is_cancelled] {
    return requests.has_to_stop() || (inner && inner());
  };
  requests.add([&](reader_request& all) { all.rests = reading.starts_rested; });
}

background_reader::thread::thread(lidar&& given, const reader_options& options)
    // A model with larger scans than a G4 makes it grow once.
    : queue(std::make_unique<reader_queue>(depth_of(options), g4_model)),
      how_(options),
      listener_(queue.get()),
      device_(std::make_unique<lidar>(std::move(given))),
      is_given_(true) {
  if (player* const file = played()) {
    playback_ = {.speed = file->speed(), .is_paused = file->is_paused()};
  }
  requests.add([&](reader_request& all) { all.rests = options.starts_rested; });
  show_device();
}

/// In its own thread, when nobody else holds it: there it cannot be joined.
background_reader::thread::~thread() {
  if (thread_.joinable()) thread_.detach();
}

bool background_reader::thread::is_own() const noexcept { return in_thread_of == this; }

result<void> background_reader::thread::start() {
  std::unique_lock lock(start_mutex_, std::defer_lock);
  if (!is_own()) lock.lock();  // a stop() may hold it, and wait for this thread
  if (requests.has_to_stop())
    return failure(task::starting, problem::gone, "this reader, which was stopped");
  if (is_own() || thread_.joinable()) return {};
  if (is_given_ && !how_.starts_rested) {
    if (auto started = device_->start(); !started) return started;
    is_started_ = true;
    set_state(reader_state::running);
  }
  try {
    // It is held as long as the thread runs: a reader may be destroyed there.
    thread_ = std::thread([self = shared_from_this()] { self->run(); });
  } catch (const std::system_error& refused) {
    return failure(task::starting, problem::system, "a thread", refused.code().value());
  }
  return {};
}

void background_reader::thread::stop() noexcept {
  requests.add([](reader_request& all) { all.stops = true; });
  if (is_own()) {
    if (!queue) listener_ = &nobody_;
    return;
  }
  const std::lock_guard lock(start_mutex_);
  if (thread_.joinable()) thread_.join();
  if (queue) queue->scans.end();
}

std::int64_t background_reader::thread::wall_ns(std::int64_t time_ns) noexcept {
  player* const file = played();
  return file != nullptr ? file->wall_ns(time_ns)
                         : detail::saturating_add(time_ns, wall_.ahead().count());
}

void background_reader::thread::run() noexcept {
  in_thread_of = this;
  while (serve()) {
    if (state() == reader_state::ended) {
      requests.wait();
    } else if (!device_) {
      clock::now() < retry_at_ ? requests.wait(retry_at_) : open();
    } else if (rests_) {
      rest();
    } else if (!is_started_) {
      start_scan();
    } else {
      read();
    }
  }
  close();
  if (queue) queue->scans.end();
}

bool background_reader::thread::serve() {
  const reader_request now = requests.take();
  if (now.stops) return false;
  if (now.speed) playback_.speed = *now.speed;
  if (now.pauses) playback_ = {.speed = playback_.speed, .is_paused = *now.pauses};
  if (std::exchange(rests_, now.rests) != rests_ || now.speed || now.pauses) follow_playback();
  const bool is_there = state() == reader_state::running || state() == reader_state::resting;
  for (const auto& question : now.questions) {
    if (!requests.has_to_stop()) question(is_there ? device_.get() : nullptr);
  }
  if (now.seek_ns) seek(*now.seek_ns);
  publish();
  return !requests.has_to_stop();  // a question may have stopped it
}

void background_reader::thread::open() {
  lidar_options used = options_;
  used.device_wait = 0ms;  // this thread waits
  auto opened = lidar::open(used);
  if (requests.has_to_stop()) return;  // before the listener hears of it
  if (!opened) return fail(opened.error());
  device_ = std::make_unique<lidar>(*std::move(opened));
  is_started_ = false;
  follow_playback();
  show_device();
  static_cast<void>(wall_.update());
  listener_->on_open(*device_);
}

void background_reader::thread::close() {
  if (!device_) return;
  static_cast<void>(device_->stop());
  while (const auto scan = device_->try_scan(0ms)) listener_->on_scan(*scan);  // measured before
  give_events(true);
  publish();
  if (!is_given_) device_.reset();
}

void background_reader::thread::start_scan() {
  const auto started = device_->start();
  give_events(false);
  is_started_ = started.has_value();
  if (is_started_ && state() != reader_state::lost) set_state(reader_state::running);
  if (is_started_) return;
  if (started.error() == problem::reconnecting) return look();
  // It goes on in the next call, if a program has woken the lidar.
  if (started.error() != problem::cancelled || is_cancelled()) fail(started.error());
}

void background_reader::thread::read() {
  if (state() == reader_state::resting) set_state(reader_state::running);
  if (!requests.begin_wait(*device_)) return;
  auto why = take(longest_wait);
  const bool is_woken = requests.end_wait();
  // A call that was woken too late returned something else; the next one returns cancelled.
  while (is_woken && !(why && (why->is_fatal() || *why == problem::cancelled))) why = take(0ms);
  const bool is_over = why && why->is_fatal();
  give_events(is_over);
  if (is_over) return fail(*why);
  if (!why || *why != problem::cancelled) {
    detail.store(why ? why->detail() : error_detail::usual, std::memory_order_relaxed);
  } else if (!is_woken && is_cancelled()) {
    end(*why);
  }
}

void background_reader::thread::rest() {
  if (played() != nullptr) {
    set_state(reader_state::resting);
    return requests.wait();
  }
  if (std::exchange(is_started_, false)) static_cast<void>(device_->stop());
  give_events(false);
  if (state() != reader_state::lost) set_state(reader_state::resting);
  look();
  if (state() == reader_state::resting) failing_since_.reset();
}

void background_reader::thread::look() {
  requests.wait(std::min(clock::now() + longest_wait, device_->event_loop().next_deadline()));
  const auto done = device_->event_loop().process();
  const bool is_over = !done && done.error().is_fatal();
  give_events(is_over);
  if (is_over) fail(done.error());
}

std::optional<error> background_reader::thread::take(lidar::milliseconds longest) {
  if (how_.wants_points) {
    const auto points = device_->next_points(longest);
    if (points) listener_->on_points(*points);
    if (!points && points.error() != problem::timeout) return points.error();
    longest = 0ms;
  }
  const auto scan = device_->try_scan(longest);
  if (!scan) return scan.error();
  listener_->on_scan(*scan);
  if (std::exchange(playback_.shows_one, false)) follow_playback();
  return std::nullopt;
}

void background_reader::thread::seek(std::int64_t position_ns) {
  player* const file = played();
  if (file == nullptr) return;
  const std::int64_t last_ns = std::max<std::int64_t>(file->length_ns() - least_rest_ns, 0);
  const auto moved = file->seek(std::clamp<std::int64_t>(position_ns, 0, last_ns));
  if (!moved) return end(moved.error());
  playback_.shows_one = playback_.is_paused;
  follow_playback();
  if (is_started_) set_state(rests_ ? reader_state::resting : reader_state::running);
}

void background_reader::thread::give_events(bool is_over) {
  while (const auto found = device_->next_event()) {
    const bool is_loss = found->what == lidar_event::kind::lost;
    const bool is_return = found->what == lidar_event::kind::reconnected;
    // A file is at its end, or begins again.
    const bool is_of_file = is_loss ? found->reason == problem::end_of_input
                                    : is_return && state() != reader_state::lost;
    if (is_of_file && played() != nullptr) continue;
    if (is_loss && !is_over) {
      set_state(reader_state::lost, error(task::reading, found->reason, device_->name()));
    }
    if (is_return) set_state(rests_ ? reader_state::resting : reader_state::running);
    listener_->on_event(*found);
  }
}

void background_reader::thread::fail(const error& why) {
  if (is_given_ || !why.may_pass()) return end(why);
  publish();
  const auto now = clock::now();
  if (!failing_since_) failing_since_ = now;
  const auto since = std::chrono::duration_cast<lidar::milliseconds>(now - *failing_since_);
  if (since >= options_.device_wait) return end(why);
  device_.reset();
  retry_at_ = now + retry_interval;
  set_state(reader_state::opening, why);
}

void background_reader::thread::end(const error& why) {
  publish();
  if (std::exchange(playback_.shows_one, false)) follow_playback();
  if (!is_given_ && played() == nullptr) device_.reset();
  set_state(reader_state::ended, why);
}

void background_reader::thread::set_state(reader_state state, const std::optional<error>& why) {
  if (view.own().state == state && is_same(view.own().why, why)) return;
  view.change([&](reader_status& now, lidar_counts&) {
    now.state = state;
    now.why = why;
  });
  listener_->on_state(state, why);
}

void background_reader::thread::follow_playback() {
  player* const file = played();
  if (file == nullptr) return;
  static_cast<void>(file->set_speed(playback_.shows_one ? 0 : playback_.speed));
  file->pause(rests_ || (playback_.is_paused && !playback_.shows_one));
}

void background_reader::thread::show_device() {
  view.change([&](reader_status& now, lidar_counts&) { now.name = device_->name(); });
  publish();
}

void background_reader::thread::publish() {
  if (const auto now = clock::now(); now >= wall_due_) {
    static_cast<void>(wall_.update());
    wall_due_ = now + 1s;
  }
  if (!device_) return;
  std::optional<playback_status> where;
  if (player* const file = played()) {
    where = {file->length_ns(), file->position_ns(), playback_.speed, playback_.is_paused};
  }
  const lidar_counts counts = device_->counts();
  if (counts.stream.points > 0) failing_since_.reset();
  view.show(device_->recognition());
  view.change([&](reader_status& now, lidar_counts& all) {
    if (device_->information().model != 0) now.information = device_->information();
    now.playback = where;
    all = counts;
  });
}

}  // namespace g4lidar
