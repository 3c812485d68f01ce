// SPDX-License-Identifier: MIT
#include "g4lidar/background_reader.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "core/enumerators.hpp"
#include "reader_thread.hpp"
#include "recording/play/played_file.hpp"

namespace g4lidar {

using namespace std::chrono_literals;

namespace {

/// Of a reader in this state, whose last call of the lidar ended so.
error_detail why_no_scan(reader_state now, error_detail last) noexcept {
  if (now == reader_state::resting) return error_detail::resting;
  const bool is_away = now == reader_state::opening || now == reader_state::lost;
  return is_away ? error_detail::searching : last;
}

}  // namespace

std::string_view name_of(reader_state state) noexcept {
  constexpr std::array<std::string_view, 5> names{"opening", "running", "resting", "lost", "ended"};
  return detail::name_in(names, state);
}

reader_listener::~reader_listener() = default;

background_reader::background_reader(std::shared_ptr<thread> made) noexcept
    : thread_(std::move(made)) {}
background_reader::background_reader(const lidar_options& options, const reader_options& reading,
                                     reader_listener* listener)
    : thread_(std::make_shared<thread>(options, reading, listener)) {}
background_reader::background_reader(background_reader&&) noexcept = default;

background_reader& background_reader::operator=(background_reader&& other) noexcept {
  if (this != &other) {
    stop();
    thread_ = std::move(other.thread_);
  }
  return *this;
}

background_reader::~background_reader() { stop(); }

result<background_reader> background_reader::start(lidar&& device, const reader_options& options) {
  background_reader made(std::make_shared<thread>(std::move(device), options));
  if (auto started = made.start(); !started) return tl::unexpected(started.error());
  return made;
}

result<void> background_reader::start() { return thread_ ? thread_->start() : moved_from(); }

void background_reader::stop() noexcept {
  if (thread_) thread_->stop();
}

view_result<scan> background_reader::next_scan(lidar::milliseconds timeout) {
  if (!thread_) return moved_from();
  constexpr lidar::milliseconds longest = std::chrono::hours(24 * 365);
  const auto wait = std::clamp(timeout, lidar::milliseconds(0), longest);
  if (thread_->queue) {
    // In its own thread no scan would come.
    using clock = std::chrono::steady_clock;
    const auto until = clock::now() + (thread_->is_own() ? 0ms : wait);
    do {  // a seek may continue a file that has ended
      if (const auto found = thread_->queue->scans.take(until)) return *found;
    } while (clock::now() < until && !failed() && !thread_->requests.has_to_stop());
  }
  if (const auto why = failed()) return tl::unexpected(*why);
  const bool stopped = thread_->requests.has_to_stop();
  if (stopped) return g4lidar::failure(task::reading, problem::not_scanning);
  return g4lidar::failure(task::reading, problem::timeout, {}, 0,
                          why_no_scan(thread_->view.state(), thread_->detail.load()));
}

const lidar_ring& background_reader::points() const noexcept {
  return thread_ ? thread_->points() : empty_ring();
}

std::optional<error> background_reader::failed() const {
  return thread_ ? thread_->view.failed() : moved_from().value();
}

lidar_counts background_reader::counts() const {
  if (!thread_) return {};
  lidar_counts all = thread_->view.counts();
  if (thread_->queue) all.scans_missed += thread_->queue->scans.missed();
  return all;
}

std::optional<lidar_event> background_reader::next_event() {
  return thread_ && thread_->queue ? thread_->queue->next_event() : std::nullopt;
}

reader_status background_reader::status() const {
  if (thread_) return thread_->view.status();
  return {.state = reader_state::ended, .why = moved_from().value()};
}

void background_reader::rest(bool rests) {
  if (thread_) thread_->requests.add([&](reader_request& all) { all.rests = rests; });
}
void background_reader::ask(std::function<void(lidar*)> what) {
  if (!thread_) return;
  thread_->requests.add([&](reader_request& all) { all.questions.push_back(std::move(what)); });
}
void background_reader::pause(bool pauses) {
  if (thread_) thread_->requests.add([&](reader_request& all) { all.pauses = pauses; });
}
result<void> background_reader::set_speed(double speed) {
  if (const auto wrong = problem_with({.speed = speed})) return tl::unexpected(*wrong);
  if (thread_) thread_->requests.add([&](reader_request& all) { all.speed = speed; });
  return {};
}
void background_reader::seek(std::int64_t position_ns) {
  if (thread_) thread_->requests.add([&](reader_request& all) { all.seek_ns = position_ns; });
}

std::int64_t background_reader::wall_ns(std::int64_t time_ns) const noexcept {
  return thread_ ? thread_->wall_ns(time_ns) : time_ns;
}

}  // namespace g4lidar
