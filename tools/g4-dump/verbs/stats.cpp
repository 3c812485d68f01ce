// SPDX-License-Identifier: MIT
// The verb stats: reads a lidar and prints counts.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "io/command_source.hpp"
#include "io/far_times.hpp"
#include "io/input.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/read_loop.hpp"
#include "io/source_word.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

constexpr auto usual_duration = 5s;

struct stats_options : common_options {
  std::chrono::nanoseconds interval{0};  ///< 0: once, at the end.
  [[nodiscard]] bool is_watch() const noexcept { return interval.count() > 0; }
};

/// The counts at a time, and the rates since the previous line.
struct report_line {
  double seconds = 0.0;  ///< Since the beginning.
  lidar_counts now{};
  double points_per_second = 0.0;
  double scans_per_second = 0.0;
};

report_line following(const report_line& before, double seconds, const lidar_counts& now) {
  const double passed = seconds - before.seconds;
  const auto a_second = [passed](std::uint64_t count) {
    return passed > 0.0 ? static_cast<double>(count) / passed : 0.0;
  };
  return {seconds, now, a_second(now.stream.points - before.now.stream.points),
          a_second(now.scans - before.now.scans)};
}

nlohmann::ordered_json as_json(const report_line& line) {
  const lidar_counts& now = line.now;
  const auto rounded = [](double value) { return std::round(value * 1000.0) / 1000.0; };
  nlohmann::ordered_json all{{"seconds", rounded(line.seconds)},
                             {"points_per_second", rounded(line.points_per_second)},
                             {"scans_per_second", rounded(line.scans_per_second)}};
  all.update(counts_as_json(now.stream, now.bytes));
  all.update({{"scans", now.scans},
              {"partial_scans", now.partial_scans},
              {"samples_lost", now.samples_lost},
              {"command_retries", now.command_retries},
              {"reconnects", now.reconnects},
              {"largest_gap_ms", rounded(static_cast<double>(now.largest_gap_ns) / 1e6)}});
  return all;
}

constexpr const char* columns =
    "SECONDS POINTS/S  SCANS/S        BYTES    PACKETS       POINTS    SCANS SUSPECT  SKIPPED     "
    "LOST CRC_BAD  GAP_MS RECONNECTS\n";

std::string as_row(const report_line& line) {
  const lidar_counts& now = line.now;
  return fmt::format(
      "{:7.1f} {:8.0f} {:8.2f} {:12} {:10} {:12} {:8} {:7} {:8} {:8} {:7} {:7.1f} {:10}\n",
      line.seconds, line.points_per_second, line.scans_per_second, now.bytes, now.stream.packets,
      now.stream.points, now.scans, now.stream.suspect, now.stream.skipped_bytes(),
      now.samples_lost, now.stream.crc_mismatches, static_cast<double>(now.largest_gap_ns) / 1e6,
      now.reconnects);
}

/// Seconds since the beginning; of a file by the times of its points.
class source_clock {
 public:
  explicit source_clock(bool is_file) noexcept : is_file_(is_file) {}

  void add(const scan& what) noexcept {
    if (what.points.empty()) return;
    if (!first_ns_) first_ns_ = what.points.front().time_ns;
    recorded_ = std::chrono::nanoseconds(way_ns(*first_ns_, what.points.back().time_ns));
  }
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(is_file_ ? recorded_ : clock::now() - begin_).count();
  }

 private:
  bool is_file_;
  std::optional<std::int64_t> first_ns_;
  clock::duration recorded_{0};
  clock::time_point begin_ = clock::now();
};

common_options readable(const stats_options& options) {
  common_options how = options;
  if (kind_of_source(how.source) == source_kind::raw_bytes) {
    if (how.source == "-") {
      throw bad_value("stats reads a lidar or a file; for a pipe use g4-dump decode --stats json");
    }
    if (!how.source.starts_with("file:")) how.source.insert(0, "file:");
  }
  const bool ends = how.duration.count() > 0 || how.count > 0;
  if (!options.is_watch() && !ends && !names_file(how.source)) how.duration = usual_duration;
  return how;
}

int stats(const stats_options& options) {
  const common_options how = readable(options);
  output out(how.output);
  opened_source source(how, {.partial_scans = true});  // for their times
  if (options.is_watch() && !how.json) out.write(columns);
  source_clock time(names_file(how.source));
  report_line last;
  auto next = clock::now() + options.interval;
  std::uint64_t lines = 0;
  const auto write = [&] {
    next = clock::now() + options.interval;
    ++lines;
    last = following(last, time.seconds(), source.lidar().counts());
    if (options.is_watch() && !how.json) return out.write(as_row(last));
    write_object(out, as_json(last), 22, how.json);
  };
  read_sink sink;
  sink.scan = [&](const scan& what) {
    time.add(what);
    return std::uint64_t{what.is_piece() ? 0U : 1U};
  };
  if (options.is_watch()) {
    sink.is_done = [&] { return how.count > 0 && lines == how.count; };
    sink.pulse = [&] {
      if (clock::now() < next) return;
      write();
      out.flush();
    };
  }
  const auto end = [&] {
    if (!options.is_watch()) write();
    out.commit();
  };
  try {
    read_source(source, how, sink, out);
  } catch (const failure&) {  // the counts until then are valid
    end();
    throw;
  }
  end();
  logger::info(describe(source.damage()));
  return exit_code_now();
}

constexpr const char* stats_details =
    R"(The lidar is started, read and stopped. The counts are printed once at the end (after 5 s, or at
the end of a file), or with --watch in a line each TIME until ^C (then -n counts lines, else
revolutions). They are totals since the start; points_per_second and scans_per_second are for the
time since the previous line.

  seconds             since the start; of a file the time in which it was recorded
  bytes, packets      received; responses are answers to commands
  points, scans       decoded, and whole revolutions; partial_scans are pieces
  suspect             packets whose angles contradict each other: they give no points
  skipped             bytes that belong to no packet: noise, bad_header, bad_checksum, truncated
  time_packets        packets with the clock of the device; a G4 sends none
  empty_packets       packets without samples, as some X2 send them
  crc_matches         revolutions that are complete by the CRC byte of devices that send one
  crc_mismatches      revolutions that lost a packet, by that byte; CRC_BAD in a line
  samples_lost        samples that were measured but not received, by the angles
  command_retries     commands that were sent again
  reconnects          with --on-loss reconnect
  largest_gap_ms      the longest time between two packets of a scan)";

}  // namespace

verb make_stats_verb() {
  const auto options = std::make_shared<stats_options>();
  common_options& common = *options;
  return {
      .name = "stats",
      .summary = "Print counts and rates",
      .arguments = {source_argument(common)},
      .options =
          joined(duration_row("--watch", "Print a line each TIME: 1s", options->interval),
                 json_row(common), output_rows(common), ending_rows(common), device_rows(common)),
      .details = stats_details,
      .examples = {{"g4-dump stats", "The counts of 5 s of the only lidar"},
                   {"g4-dump stats --watch 1s", "A line each second"},
                   {"g4-dump stats sim: --watch 500ms -d 2s --json", "A simulated G4, as JSON"}},
      .run = [options] { return stats(*options); }};
}

}  // namespace g4_tool
