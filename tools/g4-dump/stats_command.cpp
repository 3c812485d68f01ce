// SPDX-License-Identifier: MIT
// The verb stats: the counts of a lidar that is being read.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "exit_code.hpp"
#include "interrupt.hpp"
#include "live.hpp"
#include "manners.hpp"
#include "output.hpp"
#include "played_points.hpp"
#include "source.hpp"
#include "talk.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

constexpr auto usual_duration = 5s;

struct stats_options {
  shared_options common = std::make_shared<common_options>();
  std::shared_ptr<bool> json = std::make_shared<bool>(false);
  std::chrono::nanoseconds interval{0};  ///< 0: once, at the end.
};

/// The counts at a moment, and what has come since the moment before.
struct report_line {
  double seconds;  ///< Since the beginning.
  g4lidar::lidar_counts now;
  double points_per_second;
  double scans_per_second;
};

nlohmann::ordered_json as_json(const report_line& line) {
  const g4lidar::lidar_counts& now = line.now;
  nlohmann::ordered_json skipped;
  for (std::size_t i = 0; i < g4lidar::skip_reasons; ++i) {
    skipped[name_of(static_cast<g4lidar::skip_reason>(i))] = now.stream.skipped_by_reason[i];
  }
  const auto rounded = [](double value) { return std::round(value * 1000.0) / 1000.0; };
  nlohmann::ordered_json all;
  all["seconds"] = rounded(line.seconds);
  all["points_per_second"] = rounded(line.points_per_second);
  all["scans_per_second"] = rounded(line.scans_per_second);
  all["bytes"] = now.bytes;
  all["packets"] = now.stream.packets;
  all["responses"] = now.stream.responses;
  all["points"] = now.stream.points;
  all["scans"] = now.scans;
  all["partial_scans"] = now.partial_scans;
  all["suspect"] = now.stream.suspect;
  all["skipped"] = std::move(skipped);
  all["samples_lost"] = now.samples_lost;
  all["command_retries"] = now.command_retries;
  all["reconnects"] = now.reconnects;
  all["largest_gap_ms"] = rounded(static_cast<double>(now.largest_gap_ns) / 1e6);
  return all;
}

constexpr const char* columns =
    "SECONDS POINTS/S  SCANS/S        BYTES    PACKETS       POINTS    SCANS SUSPECT  SKIPPED     "
    "LOST  GAP_MS RECONNECTS\n";

std::string as_row(const report_line& line) {
  const g4lidar::lidar_counts& now = line.now;
  return fmt::format(
      "{:7.1f} {:8.0f} {:8.2f} {:12} {:10} {:12} {:8} {:7} {:8} {:8} {:7.1f} {:10}\n", line.seconds,
      line.points_per_second, line.scans_per_second, now.bytes, now.stream.packets,
      now.stream.points, now.scans, now.stream.suspect, now.stream.skipped_bytes(),
      now.samples_lost, static_cast<double>(now.largest_gap_ns) / 1e6, now.reconnects);
}

/// "name  value", as --json has them.
std::string as_words(const report_line& line) {
  std::string text;
  const nlohmann::ordered_json all = as_json(line);
  for (const auto& [name, value] : all.items()) {
    if (!value.is_object()) {
      text += fmt::format("{:<22}{}\n", name, value.dump());
      continue;
    }
    for (const auto& [reason, count] : value.items()) {
      text += fmt::format("{:<22}{}\n", fmt::format("{}_{}", name, reason), count.dump());
    }
  }
  return text;
}

bool is_file(const std::string& source) {
  const source_kind kind = kind_of(source);
  return kind == source_kind::recording || kind == source_kind::bytes;
}

class stats_keeper {
 public:
  stats_keeper(const g4lidar::lidar& lidar, const stats_options& options, output& out)
      : lidar_(lidar), options_(options), out_(out), is_file_(is_file(options.common->source)) {
    if (is_watch() && !*options_.json) out_.write(columns);
  }

  [[nodiscard]] bool is_watch() const noexcept { return options_.interval.count() > 0; }

  /// Writes the line of each interval that has passed; how many that were since it was asked last.
  std::uint64_t write_due() {
    const auto now = clock::now();
    if (!is_watch() || now < last_ + options_.interval) return 0;
    if (options_.common->count > 0 && lines_ == options_.common->count) return 0;
    ++lines_;
    write_one(now);
    out_.flush();
    return 1;
  }

  /// A file's seconds are those in which it was recorded, not those in which it is read.
  void came(const g4lidar::scan& scan) {
    if (!is_file_ || scan.points.empty()) return;
    if (!first_ns_) first_ns_ = scan.points.front().time_ns;
    file_time_ = std::chrono::nanoseconds(scan.points.back().time_ns - *first_ns_);
  }

  /// All at the end.
  void write_end() { write_one(clock::now()); }

 private:
  void write_one(clock::time_point now) {
    const g4lidar::lidar_counts counts = lidar_.counts();
    const auto seconds = [](clock::duration time) {
      return std::chrono::duration<double>(time).count();
    };
    const clock::duration since = is_file_ ? file_time_ : clock::duration(now - begin_);
    const double passed = seconds(since - last_since_);
    const auto a_second = [passed](std::uint64_t after, std::uint64_t before) {
      return passed > 0.0 ? static_cast<double>(after - before) / passed : 0.0;
    };
    const report_line line{seconds(since), counts,
                           a_second(counts.stream.points, before_.stream.points),
                           a_second(counts.scans, before_.scans)};
    if (*options_.json) {
      write_line(out_, as_json(line));
    } else {
      out_.write(is_watch() ? as_row(line) : as_words(line));
    }
    last_ = now;
    last_since_ = since;
    before_ = counts;
  }

  const g4lidar::lidar& lidar_;
  const stats_options& options_;
  output& out_;
  clock::time_point begin_ = clock::now();
  clock::time_point last_ = begin_;
  bool is_file_;
  std::optional<std::int64_t> first_ns_;
  clock::duration file_time_{0};
  clock::duration last_since_{0};
  g4lidar::lidar_counts before_;
  std::uint64_t lines_ = 0;
};

common_options readable(const stats_options& options) {
  common_options how = *options.common;
  if (kind_of(how.source) == source_kind::bytes) {
    if (how.source == "-") {
      throw bad_value("stats wants a lidar or a file; for a pipe there is decode --stats json");
    }
    if (!how.source.starts_with("file:")) how.source.insert(0, "file:");
  }
  const bool ends = how.duration.count() > 0 || how.count > 0;
  if (options.interval.count() == 0 && !ends && !is_file(how.source)) how.duration = usual_duration;
  return how;
}

int stats(const stats_options& options) {
  const common_options how = readable(options);
  output out(how.output);
  opening wish;
  wish.how.partial_scans = true;  // for their times
  opened_source source(how, wish);
  stats_keeper keeper(source.lidar(), options, out);
  live_sink sink;
  std::uint64_t lines = 0;
  sink.scan = [&](const g4lidar::scan& scan) {
    keeper.came(scan);
    if (scan.is_partial() && !keeper.is_watch()) return std::uint64_t{0};
    return keeper.is_watch() ? std::exchange(lines, 0) : std::uint64_t{1};
  };
  sink.pulse = [&] { lines += keeper.write_due(); };
  const auto end = [&] {
    if (!keeper.is_watch()) keeper.write_end();
    out.commit();
  };
  try {
    run_live(source.lidar(), how, sink, out);
  } catch (const failure&) {  // what was counted until then is good
    end();
    throw;
  }
  end();
  tell(words_about(source.damage()));
  return interrupt() != 0 ? 128 + interrupt() : static_cast<int>(exit_code::ok);
}

constexpr const char* details =
    R"(The lidar is started, read and stopped; what is counted is told once at the end (after 5 s, or
that of a file), or with --watch a line each TIME until ^C (then -n counts lines, else revolutions).
Counts are since the beginning; points_per_second and scans_per_second are of the time since the
line before.

  seconds             since the start; of a file those in which it was recorded
  bytes, packets      that came; responses are answers to commands
  points, scans       decoded, and whole revolutions; partial_scans are pieces of some
  suspect             packets whose angles contradict each other: no points come of them
  skipped             bytes that belong to no packet: noise, bad_header, bad_checksum, truncated
  samples_lost        that were measured and never came, by the angles
  command_retries     commands that had to be sent again
  reconnects          times it came back after a loss, with --on-loss reconnect
  largest_gap_ms      the longest time between two packets of a scan

Columns of --watch: SECONDS, POINTS/S, SCANS/S, BYTES, PACKETS, POINTS, SCANS, SUSPECT, SKIPPED,
LOST (samples), GAP_MS (the largest), RECONNECTS.)";

}  // namespace

verb make_stats_verb() {
  const auto options = std::make_shared<stats_options>();
  verb made;
  made.name = "stats";
  made.summary = "Counts while it is read";
  made.arguments.push_back(source_argument(options->common));
  made.options.push_back(
      {.names = "--watch",
       .value = "TIME",
       .help = "A line each TIME: 1s",
       .take = [options](const std::string& word) { options->interval = duration_of(word); }});
  made.options.push_back(json_row(options->json));
  made.options.push_back(output_row(options->common));
  append(made.options, ending_rows(options->common));
  append(made.options, device_rows(options->common));
  made.details = details;
  made.examples = {"g4-dump stats", "g4-dump stats --watch 1s",
                   "g4-dump stats sim: --watch 500ms -d 2s --json"};
  made.exits = talk_exits();
  made.run = [options] { return stats(*options); };
  return made;
}

}  // namespace g4_dump
