// SPDX-License-Identifier: MIT
#include "point_run.hpp"

#include <span>
#include <string>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "io/input.hpp"
#include "io/interrupt.hpp"
#include "io/source_word.hpp"
#include "read_loop.hpp"

namespace g4_tool {
namespace {

time_origin origin_of(source_kind kind) {
  if (kind == source_kind::recording) return time_origin::recorded;
  return kind == source_kind::raw_bytes ? time_origin::counted : time_origin::live;
}

/// One run, from the options to the counts.
class point_run {
 public:
  explicit point_run(const point_options& options)
      : options_(options), common_(*options.common), to_(options_, origin_of(kind_)) {}

  int run() {
    if (options_.json_counts) our_global_options().quiet = true;
    if (!is_raw()) to_.open(has_end());
    to_.use_model(g4_model);  // until it is opened
    opened_source source(common_, source_options());
    if (is_raw()) to_.open(has_end());  // it may be a pipe that its reader opens later
    to_.use_model(source.model());      // if nothing comes
    try {
      read(source);
    } catch (const failure&) {  // what came before it is good
      if (counts_of(source).stream.packets > 0) to_.commit();
      report(source);
      throw;
    }
    // A file is not replaced by one without contents.
    const bool may_be_empty = common_.output == "-" && options_.source.playback.from_ns <= 0;
    const bool has_something =
        counts_of(source).stream.packets > 0 && (may_be_empty || to_.writer().has_taken());
    if (has_something || is_live()) to_.commit();
    report(source);
    if (!has_something && !is_live() && interrupt() == 0 && !to_.out().is_closed())
      throw why_nothing(source);
    return exit_code_now();
  }

 private:
  [[nodiscard]] bool is_live() const { return !names_file(common_.source); }
  [[nodiscard]] bool is_raw() const { return kind_ == source_kind::raw_bytes; }
  [[nodiscard]] bool has_end() const {
    return kind_ == source_kind::recording ||
           (is_raw() && size_of_file(path_of_source(common_.source)).has_value());
  }
  [[nodiscard]] static lidar_counts counts_of(opened_source& source) {
    return source.lidar().counts();
  }

  /// The writer leaves out what is outside of the range of raw bytes, point by point, and pieces, which it counts.
  [[nodiscard]] lidar_options source_options() {
    lidar_options how = options_.source;
    how.partial_scans = to_.writer().takes_scans();
    how.counts_times = is_raw();
    if (!is_raw()) return how;
    how.playback = {};
    if (has_end()) return how;
    how.is_cancelled = [limits = time_limits(common_.duration, common_.idle)] {
      return interrupt() != 0 || limits.is_over();
    };
    return how;
  }

  void read(opened_source& source) {
    read_sink sink;
    if (to_.writer().takes_scans()) {
      sink.scan = [&](const scan& found) {
        follow_model(source);
        return std::uint64_t{to_.write(found) ? 0U : 1U};
      };
    } else {
      sink.points = [&](std::span<const point> found) {
        follow_model(source);
        to_.write(found);
      };
    }
    sink.is_done = [this] { return to_.writer().is_done(); };
    common_options ending = common_;
    if (has_end()) ending.duration = ending.idle = std::chrono::nanoseconds(0);
    read_source(source, ending, sink, to_.out());
  }

  /// The first bytes of a pipe may come long after it was opened, and show another model than a G4.
  void follow_model(opened_source& source) {
    if (!std::exchange(has_begun_, true)) to_.use_model(source.model());
  }

  void report(opened_source& source) const {
    const lidar_counts counts = counts_of(source);
    if (options_.json_counts) {
      logger::write(json_line(counts_as_json(counts.stream, counts.bytes)));
    } else if (is_raw() && counts.bytes > 0) {
      logger::info(stats_in_words(counts.stream, counts.bytes));
      logger::info(warning_about(counts.stream, counts.bytes, source.beginning()));
    } else if (!is_raw()) {
      report_counts(counts, to_.writer().takes_scans());
      logger::info(describe(source.damage()));
    }
    to_.report();
  }

  [[nodiscard]] failure why_nothing(opened_source& source) const {
    const lidar_counts counts = counts_of(source);
    if (counts.stream.packets > 0)
      return nothing_to_write(title_of_input(common_.source), to_.writer().takes_scans());
    if (is_raw())
      return without_packets(counts.stream, counts.bytes, source.beginning(),
                             title_of_input(common_.source));
    return no_packet_in(common_.source, options_.source.playback.from_ns > 0);
  }

  const point_options& options_;
  const common_options& common_;
  source_kind kind_ = kind_of_source(common_.source);
  point_output to_;
  bool has_begun_ = false;  // to write
};

}  // namespace

int run(const point_options& options) { return point_run(options).run(); }

}  // namespace g4_tool
