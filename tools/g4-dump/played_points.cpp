// SPDX-License-Identifier: MIT
#include "played_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <span>
#include <utility>

#include "exit_code.hpp"
#include "g4lidar/replay.hpp"
#include "interrupt.hpp"
#include "manners.hpp"
#include "progress.hpp"

namespace g4_dump {
namespace {

using namespace std::chrono_literals;

shown_scan shown(const g4lidar::scan& scan) {
  shown_scan made;
  made.scan = scan;
  if (!scan.points.empty()) made.time_ns = scan.points.front().time_ns;
  made.measured_hz = static_cast<double>(scan.measured_frequency_hz(9000));
  return made;
}

/// One reading of the lidar to the writer; what is wrong, if anything is.
std::optional<g4lidar::error> take(g4lidar::lidar& lidar, point_writer& writer, output& out) {
  if (writer.takes_scans()) {
    const auto got = lidar.next_scan(50ms);
    if (!got) return got.error();
    writer.write_scan(shown(*got), out);
    return std::nullopt;
  }
  const auto got = lidar.next_points(50ms);
  if (!got) return got.error();
  std::span<const g4lidar::point> points = *got;
  while (!points.empty()) {
    const auto piece = points.first(std::min(points.size(), point_writer::max_points));
    writer.write_points(piece, out);
    points = points.subspan(piece.size());
  }
  return std::nullopt;
}

}  // namespace

played_result play_points(const std::string& path, const g4lidar::reading_options& range,
                          point_writer& writer, output& out, const std::function<bool()>& is_done) {
  g4lidar::replay_options how;
  how.range = range;
  auto line = g4lidar::replay::open(path, how);
  if (!line) throw failure(line.error());
  const g4lidar::recording_reader* const reader = g4lidar::replay::reader_of(**line);
  progress_bar bar(!our_manners().quiet && !out.is_terminal(), reader->size());
  g4lidar::lidar_options options;
  options.partial_scans = writer.takes_scans();
  auto lidar = g4lidar::lidar::open(std::move(*line), options);
  if (!lidar) throw failure(lidar.error());
  if (const auto started = lidar->start(); !started) throw failure(started.error());
  writer.begin(out);
  for (unsigned turn = 0; interrupt() == 0 && !out.is_closed() && !is_done(); ++turn) {
    if (const auto why = take(*lidar, writer, out)) {
      if (why->what() == g4lidar::problem::end_of_input) break;
      if (why->is_fatal()) throw failure(*why);
    }
    if (turn % 64 == 0) bar.show(reader->position());
  }
  const g4lidar::recording_damage damage = reader->damage();
  static_cast<void>(lidar->close());
  return {lidar->counts(), damage};
}

std::int64_t recorded_wall_ahead_ns(const std::string& path) {
  auto reader = g4lidar::recording_reader::open(path);
  if (!reader) throw failure(reader.error());
  const auto next = reader->next();
  if (!next) return 0;
  const std::optional<g4lidar::recorded_item>& first = *next;
  return first ? first->wall_ns - first->time_ns : 0;
}

std::string words_about(const g4lidar::recording_damage& damage) {
  if (!damage.any()) return {};
  return fmt::format(
      "{}{} bytes of the file belong to nothing that is whole, {} chunks are damaged\n",
      damage.is_cut_off ? "the file was cut off, " : "", damage.bytes_skipped, damage.chunks_lost);
}

}  // namespace g4_dump
