// SPDX-License-Identifier: MIT
// Bytes through the parser and the decoder to a writer, in constant memory.
#include "decode_command.hpp"

#include <array>
#include <span>
#include <variant>
#include <vector>

#include "exit_code.hpp"
#include "g4lidar/correction.hpp"
#include "g4lidar/decode.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/stream_counts.hpp"
#include "g4lidar/stream_parser.hpp"
#include "input.hpp"
#include "interrupt.hpp"
#include "output.hpp"
#include "progress.hpp"
#include "sample_clock.hpp"
#include "say.hpp"
#include "stats.hpp"

namespace g4_dump {
namespace {

/// The way of the bytes, from the parser to the writer.
class pipeline {
 public:
  pipeline(const point_style& style, output& out)
      : out_(out),
        writer_(make_point_writer(style)),
        by_scan_(writer_->takes_scans()),
        clock_(style.rate_hz),
        scan_storage_(by_scan_ ? max_scan_points : 1),
        assembler_(scan_storage_) {}

  void take(std::span<const std::uint8_t> data) {
    bytes_ += data.size();
    parser_.feed(data, [this](const g4lidar::event& found) { take(found); });
  }

  void finish() {
    while (const auto found = parser_.finish()) take(*found);
    if (!by_scan_) return;
    if (const auto scan = assembler_.finish()) writer_->write_scan(*scan, out_);
  }

  [[nodiscard]] const g4lidar::stream_counts& counts() const noexcept { return counts_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

 private:
  // A G4 at its slowest makes 1,800 points in a revolution; this is nine times as many.
  static constexpr std::size_t max_scan_points = 16'384;

  void take(const g4lidar::event& found) {
    counts_.add(found);
    if (const auto* packet = std::get_if<g4lidar::packet_view>(&found)) return take(*packet);
    if (const auto* gone = std::get_if<g4lidar::skipped>(&found)) assembler_.add(*gone);
  }

  void take(g4lidar::packet_view packet) {
    if (counts_.packets == 1) writer_->begin(out_);
    g4lidar::decoded decoded =
        g4lidar::decode(packet, g4lidar::compact_correction{}, revolutions_.count(packet), points_);
    for (g4lidar::point& p : std::span(points_).first(decoded.points.size())) {
      p.time_ns = clock_.now_ns();
      clock_.tick();
    }
    // The samples of a suspect packet were measured, too, though nobody can tell where. The clock
    // begins with the first point.
    if (decoded.suspect && counts_.points > 0) clock_.tick(decoded.sample_count);
    if (!by_scan_) return writer_->write_points(decoded.points, out_);
    while (const auto scan = assembler_.next(decoded)) writer_->write_scan(*scan, out_);
  }

  output& out_;
  std::unique_ptr<point_writer> writer_;
  bool by_scan_;
  std::uint64_t bytes_ = 0;
  g4lidar::stream_parser parser_;
  g4lidar::stream_counts counts_;
  g4lidar::revolution_counter revolutions_;
  sample_clock clock_;
  std::array<g4lidar::point, g4lidar::max_samples> points_{};
  std::vector<g4lidar::point> scan_storage_;
  g4lidar::scan_assembler assembler_;
};

/// Reads to the end, a signal, or until nobody wants to know any more.
void pump(input& in, output& out, pipeline& way, text_detector& detector, bool with_bar) {
  progress_bar bar(with_bar && !out.is_terminal(), in.size());
  std::vector<std::uint8_t> buffer(std::size_t{256} * 1024);
  while (!out.is_closed()) {
    if (in.would_wait()) {
      out.flush();  // who reads us has all there is before we wait for more
      if (out.is_closed()) return;
      if (wait_for_input(in.descriptor(), out.descriptor()) != wake::input) return;
    }
    const std::span<const std::uint8_t> got(buffer.data(), in.read(buffer));
    if (got.empty()) return;
    detector.look_at(got);
    way.take(got);
    bar.show(way.bytes());
  }
}

void say_stats(const pipeline& way, stats_format format) {
  if (format == stats_format::json) return say(stats_as_json(way.counts(), way.bytes()));
  if (way.bytes() == 0) return;  // the failure that follows says it all
  say(stats_in_words(way.counts(), way.bytes()));
  say(warning_about(way.counts(), way.bytes()));
}

}  // namespace

int run(const decode_options& options) {
  input in(options.input,
           "Give a file of bytes as they came from the lidar's port, or pipe them in.");
  output out(options.output);
  refuse_same_file(in.id(), out);
  pipeline way(options.style, out);
  text_detector detector;
  pump(in, out, way, detector, options.stats == stats_format::words);
  way.finish();
  if (way.counts().packets > 0) out.commit();
  say_stats(way, options.stats);
  if (interrupt() != 0) return 128 + interrupt();
  if (way.counts().packets == 0 && !out.is_closed()) {
    throw failure(exit_code::bad_file,
                  why_no_packet(way.counts(), way.bytes(), detector.is_text(), in.title()));
  }
  return static_cast<int>(exit_code::ok);
}

}  // namespace g4_dump
