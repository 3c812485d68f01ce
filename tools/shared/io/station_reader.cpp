// SPDX-License-Identifier: MIT
#include "station_reader.hpp"

#include <algorithm>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/recording/reader.hpp"
#include "input.hpp"
#include "interrupt.hpp"

namespace g4_tool {
namespace {

using namespace std::chrono_literals;

constexpr double ns_per_s = 1e9;
constexpr std::chrono::nanoseconds first_backoff = 250ms;
constexpr std::chrono::nanoseconds longest_backoff = 2s;
constexpr auto longest_wait = 100ms;

std::int64_t steady_now() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Whether another attempt may succeed.
bool may_pass(exit_code why) noexcept {
  using enum exit_code;
  return why != bad_file && why != internal && why != not_a_g4 && why != usage;
}

}  // namespace

station_reader::station_reader(const common_options& options, const lidar_options& how,
                               station_listener& listener, const station_options& wishes)
    : options_(options), how_(how), listener_(listener), wishes_(wishes), backoff_(first_backoff) {
  const source_kind kind = kind_of_source(options_.source);
  nature_.is_file = kind == source_kind::recording || kind == source_kind::raw_bytes;
  // This waits, and can be stopped.
  nature_.has_patience = options_.on_loss == loss_rule::wait && !nature_.is_file;
  if (nature_.has_patience) options_.on_loss = loss_rule::reconnect;
  how_.wrap = [this, inner = how.wrap](std::unique_ptr<connector> from) {
    auto tapped =
        inner ? inner(std::move(from)) : result<std::unique_ptr<connector>>(std::move(from));
    if (tapped) tapped = diagnosis.observe(std::move(*tapped));
    return tapped;
  };
  how_.is_cancelled = [this] { return board.has_to_stop() || interrupt() != 0; };
  board.request([&](station_requests& all) {
    all.rests = wishes.starts_rested;
    all.speed = wishes.speed;
  });
}

void station_reader::start() {
  thread_ = std::thread([this] { run(); });
}

void station_reader::stop() {
  board.request([](station_requests& all) { all.stops = true; });
  if (thread_.joinable()) thread_.join();
}

std::int64_t station_reader::wall_ns(std::int64_t time_ns) const noexcept {
  return time_ns + (recorded_ ? recorded_->wall_ahead_ns : wall_.ahead().count());
}

station_reader::recorded_times station_reader::times_of(const std::string& path) const {
  recording_reader read = open_recording(path, {.is_cancelled = how_.is_cancelled});
  recorded_times times{.first_ns = read.first_ns()};
  auto next = read.next();
  if (how_.is_cancelled()) throw interrupted();
  if (const auto first = value_of(std::move(next))) {
    times.wall_ahead_ns = first->wall_ns - first->time_ns;
  }
  const std::int64_t length_ns = std::max(read.last_ns() - times.first_ns, std::int64_t{0});
  times.length_s = static_cast<double>(length_ns) / ns_per_s;
  return times;
}

void station_reader::run() noexcept {
  try {
    while (!board.has_to_stop()) live();
    return;
  } catch (const interrupted&) {
    end(nullptr, {});
  } catch (const std::exception& reason) {
    end(std::current_exception(), reason.what());
  }
  source_.reset();
  while (serve() || !board.has_to_stop()) board.wait();
}

void station_reader::end(const std::exception_ptr& failure, const std::string& why) noexcept {
  try {
    board.show([&](station_view& all) { all.failure = failure; });
    set_state(station_state::ended, why);
  } catch (const std::exception&) {
    logger::write("out of memory\n");
  }
}

void station_reader::set_state(station_state state, const std::string& why) {
  bool is_new = false;
  board.show([&](station_view& all) {
    is_new = all.state != state || all.why != why;
    all.state = state;
    all.why = why;
  });
  if (!is_new) return;
  if (!why.empty()) logger::verbose(why + "\n");
  listener_.on_state(state, why);
}

void station_reader::live() {
  try {
    open();
    while (serve() && step()) publish();
    close();
  } catch (const g4_tool::failure& reason) {
    if (!nature_.has_patience || !may_pass(reason.code())) throw;
    source_.reset();
    set_state(station_state::opening, reason.what());
    const auto until = clock::now() + backoff_;
    backoff_ = std::min(2 * backoff_, longest_backoff);
    while (serve() && clock::now() < until) board.wait(until);
  }
}

void station_reader::open() {
  if (nature_.is_file && !recorded_ && kind_of_source(options_.source) == source_kind::recording) {
    recorded_ = times_of(path_of_source(options_.source));
  }
  how_.playback.from_ns = static_cast<std::int64_t>(begin_s_ * ns_per_s);
  source_.reset();  // before the next one opens the port
  source_ = std::make_unique<opened_source>(options_, how_);
  g4lidar::lidar& lidar = source_->lidar();
  at_ = {.is_paced = lidar.player() != nullptr};
  playback_.restart();
  static_cast<void>(wall_.update());
  board.show([&](station_view& all) {
    all.name = lidar.name();
    if (lidar.information().model != 0) all.identity = lidar.information();
    if (recorded_) all.player.emplace().length_s = recorded_->length_s;
  });
  show_player(begin_s_);
  listener_.on_open(*source_);
}

void station_reader::close() {
  if (!source_) return;
  static_cast<void>(source_->lidar().stop());  // what was received is good
  report_events();
  publish();
  source_.reset();
}

bool station_reader::serve() {
  const station_requests now = board.take();
  if (now.pauses) playback_.pause(*now.pauses, steady_now());
  if (now.speed) playback_.set_speed(*now.speed, steady_now());
  if (now.pauses || now.speed) show_player({});
  for (const auto& question : now.questions)
    question(source_ && !is_lost() ? &source_->lidar() : nullptr);
  rests_ = now.rests;
  if (now.stops) return false;
  if (!now.seek_s || !recorded_) return true;
  // A second before its end there is still something to be seen.
  begin_s_ = std::clamp(*now.seek_s, 0.0, std::max(recorded_->length_s - 1.0, 0.0));
  shows_one_ = true;
  return false;
}

bool station_reader::step() {
  g4lidar::lidar& lidar = source_->lidar();
  if (rests_) return rest();
  if (!at_.is_started && !start_scan()) return true;
  const bool got = take(lidar, at_.is_paced ? 50ms : 0ms);
  report_events();
  if (at_.is_over) return wait_at_end();
  if (!got && !at_.is_paced) {
    board.wait(std::min(clock::now() + longest_wait, lidar.next_deadline()), lidar.native_handle());
  }
  return !at_.is_left;
}

bool station_reader::start_scan() {
  const auto started = source_->lidar().start();
  report_events();
  if (!started && started.error() != problem::reconnecting) throw g4_tool::failure(started.error());
  at_.is_started = started.has_value();
  if (!at_.is_started) look();
  if (!is_lost()) set_state(station_state::running);
  return at_.is_started;
}

bool station_reader::rest() {
  if (std::exchange(at_.is_started, false) && !at_.is_paced)
    static_cast<void>(source_->lidar().stop());
  if (!is_lost()) set_state(station_state::resting);
  look();
  return true;
}

void station_reader::look() {
  if (at_.is_paced) return board.wait();
  g4lidar::lidar& lidar = source_->lidar();
  board.wait(std::min(clock::now() + longest_wait, lidar.next_deadline()), lidar.native_handle());
  const auto done = lidar.process();
  report_events();
  if (!done && done.error().is_fatal()) throw g4_tool::failure(done.error(), true);
}

bool station_reader::take(g4lidar::lidar& lidar, lidar::milliseconds longest) {
  bool got = false;
  if (wishes_.wants_points) {
    const auto points = lidar.next_points(longest);
    if (points) give(*points);
    if (!points) check(points.error());
    got = points.has_value();
    longest = 0ms;
  }
  if (at_.is_over || at_.is_left) return got;
  const auto scan = lidar.next_scan(longest);
  if (scan) give(*scan);
  if (!scan) check(scan.error());
  return got || scan.has_value();
}

void station_reader::check(const error& why) {
  at_.is_over = nature_.is_file && why == problem::end_of_input;
  if (at_.is_over || !why.is_fatal()) return;
  diagnosis.add(why);
  throw g4_tool::failure(why, true);
}

void station_reader::give(const g4lidar::scan& scan) {
  backoff_ = first_backoff;
  if (!at_.is_paced) return listener_.on_scan(scan);
  held_ = scan;
  if (!hold(scan.time_ns(), scan.end_ns())) return;
  listener_.on_scan(held_.view());
  if (recorded_) {
    show_player(static_cast<double>(held_.view().end_ns() - recorded_->first_ns) / ns_per_s);
  }
}

void station_reader::give(std::span<const point> points) {
  if (!at_.is_paced) return listener_.on_points(points);
  const std::vector<point> held(points.begin(), points.end());
  if (hold(held.front().time_ns, held.back().time_ns)) listener_.on_points(held);
}

bool station_reader::hold(std::int64_t begin_ns, std::int64_t end_ns) {
  while (true) {
    at_.is_left = !serve();
    if (at_.is_left) return false;
    if (std::exchange(shows_one_, false)) return true;
    const auto due_ns = rests_ ? std::nullopt : playback_.due_ns(begin_ns, end_ns, steady_now());
    if (due_ns && *due_ns <= steady_now()) return true;
    set_state(rests_ ? station_state::resting : station_state::running);
    board.wait(due_ns ? clock::time_point(std::chrono::nanoseconds(*due_ns)) : no_deadline);
  }
}

bool station_reader::wait_at_end() {
  const bool is_all = std::exchange(begin_s_, 0) == 0;
  const lidar_counts counts = source_->lidar().counts();
  if (is_all && counts.stream.packets == 0) {
    throw g4_tool::failure(exit_code::bad_file, why_no_packet(counts.stream, counts.bytes, false,
                                                              in_quotes(options_.source)));
  }
  if (wishes_.loops && recorded_ && counts.scans > 0) return false;
  close();
  set_state(station_state::ended);
  while (serve()) board.wait();
  return false;
}

void station_reader::report_events() {
  while (const auto event = source_->lidar().next_event()) {
    if (event->what == lidar_event::kind::lost) {
      if (event->reason == problem::end_of_input && nature_.is_file) continue;  // a file is over
      set_state(station_state::lost, std::string(description_of(event->reason)) + '.');
    }
    if (event->what == lidar_event::kind::reconnected)
      set_state(rests_ ? station_state::resting : station_state::running);
    diagnosis.add(*event);
    listener_.on_event(*event);
  }
}

void station_reader::publish() {
  if (const auto now = clock::now(); now >= wall_due_) {
    static_cast<void>(wall_.update());
    wall_due_ = now + 1s;
  }
  if (!source_) return;
  const lidar_counts counts = source_->lidar().counts();
  board.show([&](station_view& all) { all.counts = counts; });
}

void station_reader::show_player(std::optional<double> position_s) {
  board.show([&](station_view& all) {
    if (!all.player) return;
    all.player->speed = playback_.speed();
    all.player->is_paused = playback_.is_paused();
    if (position_s) all.player->position_s = *position_s;
  });
}

}  // namespace g4_tool
