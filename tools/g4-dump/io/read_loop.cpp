// SPDX-License-Identifier: MIT
#include "read_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/source_word.hpp"

namespace g4_tool {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

constexpr auto pulse_time = 100ms;
constexpr auto flush_time = 50ms;
constexpr std::uint64_t most_without_s = 10;

class read_loop {
 public:
  read_loop(opened_source& source, const common_options& options, const read_sink& sink,
            output& out)
      : source_(source), options_(options), sink_(sink), out_(out) {}

  void run() {
    // What was read of a pipe while it was opened is taken in any case.
    for (bool has_begun = is_live_; !has_begun || !is_over(); has_begun = true) {
      const bool got = read();
      report_events(lidar_);
      if (ended_) return;
      if (got || has_new_bytes()) limits_.restart_idle();
      if (!got) {
        flush_if_due();
        refuse_endless();
        wait();
      }
      if (source_.size() >= progress_bar::least_bytes) bar_.show(source_.position());
      if (sink_.pulse) sink_.pulse();
    }
  }

 private:
  [[nodiscard]] bool is_over() const {
    return interrupt() != 0 || out_.is_closed() || has_enough() || limits_.is_over();
  }

  [[nodiscard]] bool has_enough() const {
    if (sink_.is_done) return sink_.is_done();
    return options_.count > 0 && records_ >= options_.count;
  }

  /// Bytes that make no point yet.
  bool has_new_bytes() {
    const std::uint64_t before = std::exchange(bytes_, lidar_.counts().bytes);
    return before != bytes_;
  }

  void flush_if_due() {
    const auto now = clock::now();
    if (out_.has_unwritten() && !is_terminal_ && now - flushed_ < flush_time) return;
    out_.flush();
    flushed_ = now;
  }

  /// Takes available data; waits only if poll() cannot. False if there was none.
  bool read() {
    const auto longest = lidar_.event_loop().native_handle() < 0 ? 50ms : 0ms;
    const auto take_scan = [this](const g4lidar::scan& scan) { records_ += sink_.scan(scan); };
    const auto took = sink_.scan ? lidar_.try_scan(longest).map(take_scan)
                                 : lidar_.next_points(longest).map(sink_.points);
    if (took) return true;
    ended_ = took.error() == g4lidar::problem::end_of_input;
    if (ended_ || !took.error().is_fatal()) return false;
    report_events(lidar_);
    if (!is_live_) throw failure_of(options_, took.error());
    throw failure(took.error(), true);
  }

  /// Packets come, and make no revolution: the command would wait for ever.
  void refuse_endless() {
    const bool goes_on = options_.count == 0 && records_ > 0;  // the head may turn again
    if (!sink_.scan || !is_live_ || options_.duration != 0ns || goes_on) return;
    const lidar_counts now = lidar_.counts();
    if (now.scans != whole_.scans || records_ != whole_.records)
      whole_ = {now.scans, records_, now.stream.points};
    const std::uint64_t most = most_without_s * first_rate_hz(*lidar_.recognition().model);
    if (now.stream.points < whole_.points + most) return;
    report_events(lidar_);
    throw failure(
        exit_code::lost,
        fmt::format("{}: {} s of packets make no whole revolution: the head stands, or turns very "
                    "slowly, or the lidar sends no packet of the angle 0. --partial writes the "
                    "pieces; g4-dump doctor examines the lidar.",
                    lidar_.name(), most_without_s),
        name_of(g4lidar::problem::timeout));
  }

  void wait() {
    if (lidar_.event_loop().native_handle() < 0) return;  // read() has waited
    auto until =
        std::min({clock::now() + pulse_time, lidar_.event_loop().next_deadline(), limits_.end()});
    if (out_.has_unwritten()) until = std::min(until, flushed_ + flush_time);
    const wake woken =
        wait_for_input(lidar_.event_loop().native_handle(), out_.descriptor(), until);
    if (woken == wake::output_closed) out_.close_early();
  }

  opened_source& source_;
  g4lidar::lidar& lidar_ = source_.lidar();
  const common_options& options_;
  const read_sink& sink_;
  output& out_;
  time_limits limits_{options_.duration, options_.idle};
  clock::time_point flushed_ = clock::now();
  bool is_terminal_ = out_.is_terminal();
  progress_bar bar_{source_.size(), sink_.with_bar && !is_terminal_};
  bool is_live_ = !names_file(options_.source);
  std::uint64_t records_ = 0;
  std::uint64_t bytes_ = 0;
  struct {
    std::uint64_t scans = 0;
    std::uint64_t records = 0;
    std::uint64_t points = 0;
  } whole_;  // when the last revolution was complete
  bool ended_ = false;
};

/// What a signal, -d or --idle has left of the bytes of a file or a pipe.
void take_rest(g4lidar::lidar& lidar, const read_sink& sink) {
  if (sink.scan) {
    if (const auto last = lidar.try_scan(0ms)) sink.scan(*last);
    return;
  }
  while (const auto more = lidar.next_points(0ms)) sink.points(*more);
}

}  // namespace

void report_events(g4lidar::lidar& lidar) {
  while (const auto event = lidar.next_event()) {
    const bool is_loss = event->what == lidar_event::kind::lost;
    const bool is_of_file = event->reason == g4lidar::problem::end_of_input ||
                            event->reason == g4lidar::problem::bad_file;
    if (is_loss && is_of_file) continue;  // its end, or an error
    const g4lidar::model& which = *lidar.recognition().model;
    if (event->what == lidar_event::kind::no_zero_angle) {
      report_missing_zero(which);
      continue;
    }
    if (event->what == lidar_event::kind::other_number) continue;  // it is reported below
    logger::info(fmt::format("{}: {}{}{}\n", lidar.name(), name_of(event->what),
                             is_loss ? ", " : "", is_loss ? name_of(event->reason) : ""));
  }
  report_contradictions(lidar);
}

void read_source(opened_source& source, const common_options& options, const read_sink& sink,
                 output& out) {
  g4lidar::lidar& lidar = source.lidar();
  value_of(lidar.start());
  read_loop(source, options, sink, out).run();
  static_cast<void>(lidar.stop());  // the data is valid even if stopping fails
  const bool has_enough = sink.is_done && sink.is_done();
  if (names_file(options.source) && !has_enough) take_rest(lidar, sink);
  report_events(lidar);
}

void report_counts(const lidar_counts& counts, bool has_scans) {
  const std::uint64_t mismatches = counts.stream.crc_mismatches;
  const std::string crc =
      mismatches > 0 ? counted(mismatches, "revolution") + " with a wrong CRC, " : "";
  // A command that reads points misses no scans, and the other way round.
  logger::info(fmt::format(
      "{}: {} ({} suspect) with {} in {} and {}\n{} skipped, {} lost, {}{} missed, {}\n",
      counted(counts.bytes, "byte"), counted(counts.stream.packets, "packet"),
      counts.stream.suspect, counted(counts.stream.points, "point"), counted(counts.scans, "scan"),
      counted(counts.partial_scans, "piece"), counted(counts.stream.skipped_bytes(), "byte"),
      counted(counts.samples_lost, "sample"), crc,
      counted(has_scans ? counts.scans_missed : counts.points_missed, has_scans ? "scan" : "point"),
      counted(counts.reconnects, "reconnect")));
}

}  // namespace g4_tool
