// SPDX-License-Identifier: MIT
#include "live.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>

#include "exit_code.hpp"
#include "interrupt.hpp"
#include "manners.hpp"
#include "output.hpp"

namespace g4_dump {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

constexpr auto pulse_time = 100ms;
constexpr auto flush_time = 50ms;

class live_loop {
 public:
  live_loop(g4lidar::lidar& lidar, const common_options& options, const live_sink& sink,
            output& out)
      : lidar_(lidar), options_(options), sink_(sink), out_(out) {}

  void run() {
    while (!is_over()) {
      const bool got = read();
      tell_events(lidar_);
      if (ended_) return;
      if (got) {
        last_ = clock::now();
      } else {
        flush_if_due();
        wait();
      }
      if (sink_.pulse) sink_.pulse();
    }
  }

 private:
  [[nodiscard]] bool is_over() const {
    const auto now = clock::now();
    return interrupt() != 0 || out_.is_closed() || has_enough() ||
           (options_.duration.count() > 0 && now - begin_ >= options_.duration) ||
           (options_.idle.count() > 0 && now - last_ >= options_.idle);
  }

  [[nodiscard]] bool has_enough() const {
    if (sink_.is_done) return sink_.is_done();
    return options_.count > 0 && records_ >= options_.count;
  }

  void flush_if_due() {
    if (!out_.has_unwritten()) {
      flushed_ = clock::now();
      return;
    }
    if (!is_terminal_ && clock::now() - flushed_ < flush_time) return;
    out_.flush();
    flushed_ = clock::now();
  }

  /// Takes what is there, without waiting where poll() can do that; false if nothing was.
  bool read() {
    const auto longest = lidar_.native_handle() < 0 ? 50ms : 0ms;
    const auto why = sink_.scan ? take_scan(longest) : take_points(longest);
    if (!why) return true;
    using enum g4lidar::problem;
    if (why->what() == end_of_input) {
      ended_ = true;
      return false;
    }
    if (why->is_fatal()) {
      tell_events(lidar_);
      throw failure(*why, true);
    }
    return false;
  }

  std::optional<g4lidar::error> take_scan(std::chrono::milliseconds longest) {
    const auto got = lidar_.next_scan(longest);
    if (!got) return got.error();
    records_ += sink_.scan(*got);
    return std::nullopt;
  }

  std::optional<g4lidar::error> take_points(std::chrono::milliseconds longest) {
    const auto got = lidar_.next_points(longest);
    if (!got) return got.error();
    auto wanted = *got;
    if (options_.count > 0 && !sink_.is_done) {
      const std::uint64_t left = options_.count - records_;
      if (left < wanted.size()) wanted = wanted.first(static_cast<std::size_t>(left));
    }
    records_ += sink_.points(wanted);
    return std::nullopt;
  }

  void wait() {
    if (lidar_.native_handle() < 0) return;  // it has waited itself
    const auto now = clock::now();
    auto until = now + pulse_time;
    const std::int64_t due_ns = lidar_.next_deadline_ns();
    if (due_ns != g4lidar::never_ns) {
      until = std::min(until, clock::time_point(std::chrono::nanoseconds(due_ns)));
    }
    if (options_.duration.count() > 0) until = std::min(until, begin_ + options_.duration);
    if (options_.idle.count() > 0) until = std::min(until, last_ + options_.idle);
    if (out_.has_unwritten()) until = std::min(until, flushed_ + flush_time);
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - now);
    std::array<pollfd, 3> waiting{{{lidar_.native_handle(), POLLIN, 0},
                                   {interrupt_handle(), POLLIN, 0},
                                   {out_.descriptor(), 0, 0}}};
    ::poll(waiting.data(), waiting.size(), static_cast<int>(std::max(left, 0ms).count()));
    if ((waiting[2].revents & (POLLERR | POLLHUP)) != 0) out_.close_early();
  }

  g4lidar::lidar& lidar_;
  const common_options& options_;
  const live_sink& sink_;
  output& out_;
  clock::time_point begin_ = clock::now();
  clock::time_point last_ = begin_;
  clock::time_point flushed_ = begin_;
  bool is_terminal_ = out_.is_terminal();
  std::uint64_t records_ = 0;
  bool ended_ = false;
};

}  // namespace

void tell_events(g4lidar::lidar& lidar) {
  while (const auto event = lidar.next_event()) {
    const bool is_loss = event->what == g4lidar::lidar_event::kind::lost;
    if (is_loss && event->reason == g4lidar::problem::end_of_input) continue;  // a file is over
    tell(fmt::format("{}: {}{}{}\n", lidar.name(), name_of(event->what), is_loss ? ", " : "",
                     is_loss ? name_of(event->reason) : ""));
  }
}

void run_live(g4lidar::lidar& lidar, const common_options& options, const live_sink& sink,
              output& out) {
  if (const auto started = lidar.start(); !started) throw failure(started.error());
  live_loop(lidar, options, sink, out).run();
  static_cast<void>(lidar.stop());  // what has come is good, whatever the device says to that
  tell_events(lidar);
}

void tell_counts(const g4lidar::lidar& lidar, reading what) { tell_counts(lidar.counts(), what); }

void tell_counts(const g4lidar::lidar_counts& counts, reading what) {
  // Nobody wanted what was not read: scans beside points are not missed, nor points beside scans.
  const bool are_points = what == reading::points;
  tell(
      fmt::format("{} bytes: {} packets ({} suspect) with {} points in {} scans and {} pieces\n"
                  "{} bytes skipped, {} samples lost, {} {} missed, {} reconnects\n",
                  counts.bytes, counts.stream.packets, counts.stream.suspect, counts.stream.points,
                  counts.scans, counts.partial_scans, counts.stream.skipped_bytes(),
                  counts.samples_lost, are_points ? counts.points_missed : counts.scans_missed,
                  are_points ? "points" : "scans", counts.reconnects));
}

}  // namespace g4_dump
