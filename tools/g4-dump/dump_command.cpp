// SPDX-License-Identifier: MIT
#include "dump_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "byte_points.hpp"
#include "byte_pump.hpp"
#include "exit_code.hpp"
#include "grid_writer.hpp"
#include "input.hpp"
#include "interrupt.hpp"
#include "live.hpp"
#include "manners.hpp"
#include "output.hpp"
#include "played_points.hpp"
#include "point_writer.hpp"
#include "shaped_writer.hpp"
#include "source.hpp"
#include "stats.hpp"

namespace g4_dump {
namespace {

shape_plan plan_for(const dump_options& options, source_kind kind) {
  const common_options& common = *options.common;
  const bool is_bytes = kind == source_kind::bytes;
  shape_plan plan;
  plan.partial_scans = options.partial;
  plan.counts_duration = is_bytes || kind == source_kind::recording;
  if (options.bins > 0) plan.purpose = point_shaper::purpose::grid;
  const time_style wanted =
      common.time.value_or(is_bytes ? time_style::zero : time_style::absolute);
  if (is_bytes && (wanted == time_style::absolute || wanted == time_style::monotonic)) {
    throw bad_value("--time: raw bytes carry no times; zero and delta are counted at --rate");
  }
  plan.time = is_bytes && wanted == time_style::zero ? time_style::monotonic : wanted;
  if (plan.time == time_style::absolute) {
    plan.follows_wall_clock = kind != source_kind::recording;
    plan.wall_ahead_ns =
        plan.follows_wall_clock ? wall_ahead_ns() : recorded_wall_ahead_ns(path_of(common.source));
  }
  return plan;
}

/// One dump or scan, from the options to the counts.
class dumping {
 public:
  explicit dumping(const dump_options& options)
      : options_(options), common_(*options.common), kind_(kind_of(common_.source)) {
    if (options_.pcd) take_files();
    const shape_plan plan = plan_for(options_, kind_);
    options_.style.frame = common_.frame;
    options_.style.unit = common_.unit;
    if (plan.time == time_style::absolute || plan.time == time_style::monotonic) {
      if (kind_ != source_kind::bytes) options_.style.time_width = 10;
    }
    writer_ = std::make_unique<shaped_writer>(make_writer(), common_, plan);
  }

  int run() { return kind_ == source_kind::bytes ? dump_bytes() : dump_lidar(); }

 private:
  void take_files() {
    if (options_.bins > 0) throw bad_value("--grid: a PCD file holds points");
    files_ = numbered_files::from(common_.output);
    if (files_) return;
    if (common_.count > 1) {
      throw bad_value("-n: a PCD file holds one revolution; name more by -o scan-%04d.pcd");
    }
    common_.count = 1;
    if (common_.output == "-" && options_.data == pcd_data::binary && ::isatty(1) != 0) {
      throw bad_value("standard output is a terminal; give -o FILE, or --pcd-data ascii");
    }
  }

  std::unique_ptr<point_writer> make_writer() const {
    if (options_.pcd) return make_pcd_writer(common_.frame, options_.data, files_);
    if (options_.bins > 0) return make_grid_writer(options_.style, options_.bins);
    return make_point_writer(options_.style);
  }

  /// Numbered files make themselves. What may be read for ever goes to its file at once.
  [[nodiscard]] std::string output_name() const { return files_ ? "/dev/null" : common_.output; }
  static output::appears when_it_appears(bool has_end) {
    return has_end ? output::appears::whole : output::appears::growing;
  }

  int dump_bytes();
  int dump_lidar();
  void run_lidar(opened_source& source, output& out);
  void tell_lidar(opened_source& source) const;
  void tell_pieces() const;
  static int end() { return interrupt() != 0 ? 128 + interrupt() : 0; }

  dump_options options_;
  common_options common_;
  source_kind kind_;
  std::optional<numbered_files> files_;
  std::unique_ptr<shaped_writer> writer_;
};

int dumping::dump_bytes() {
  input in(path_of(common_.source),
           "Give a file of bytes as they came from the lidar's port, or pipe them in.");
  output out(output_name(), when_it_appears(in.id().has_value() || options_.pcd));
  refuse_same_file(in.id(), out);
  byte_points way(*writer_, out, options_.style.rate_hz);
  text_detector detector;
  byte_sink sink{.take =
                     [&](std::span<const std::uint8_t> got) {
                       detector.look_at(got);
                       way.take(got);
                     },
                 .is_done = [this] { return writer_->is_done(); },
                 .duration = common_.duration,
                 .idle = common_.idle,
                 .with_bar = !our_manners().quiet};
  pump(in, out, sink);
  if (!writer_->is_done()) way.finish();  // else what is left was not wanted
  if (way.counts().packets > 0) out.commit();
  if (way.bytes() > 0) {
    tell(stats_in_words(way.counts(), way.bytes()));
    tell(warning_about(way.counts(), way.bytes()));
    tell_pieces();
  }
  if (way.counts().packets == 0 && !out.is_closed() && interrupt() == 0) {
    throw failure(exit_code::bad_file,
                  why_no_packet(way.counts(), way.bytes(), detector.is_text(), in.title()));
  }
  return end();
}

int dumping::dump_lidar() {
  const bool has_end = kind_ == source_kind::recording || options_.pcd;
  output out(output_name(), when_it_appears(has_end));
  opening how = options_.source;
  how.how.partial_scans = writer_->takes_scans();  // the writer leaves them out, and counts them
  opened_source source(common_, how);
  try {
    run_lidar(source, out);
  } catch (const failure&) {  // what came before it is good
    out.commit();
    tell_lidar(source);
    throw;
  }
  const bool has_packets = source.lidar().counts().stream.packets > 0;
  if (has_packets || kind_ != source_kind::recording) out.commit();
  tell_lidar(source);
  if (!has_packets && kind_ == source_kind::recording && interrupt() == 0) {
    throw failure(exit_code::bad_file,
                  "there is no whole packet in " + in_quotes(common_.source) +
                      ". g4-dump packets shows what else there may be; or give another file.");
  }
  return end();
}

void dumping::run_lidar(opened_source& source, output& out) {
  live_sink sink;
  if (writer_->takes_scans()) {
    sink.scan = [&](const g4lidar::scan& scan) {
      shown_scan shown{.scan = scan};
      if (!scan.points.empty()) shown.time_ns = scan.points.front().time_ns;
      shown.measured_hz = static_cast<double>(scan.measured_frequency_hz(options_.style.rate_hz));
      writer_->write_scan(shown, out);
      return std::uint64_t{1};
    };
  } else {
    sink.points = [&](std::span<const g4lidar::point> points) {
      writer_->write_points(points, out);
      return points.size();
    };
  }
  sink.is_done = [this] { return writer_->is_done(); };
  common_options ending = common_;
  if (kind_ == source_kind::recording) ending.duration = std::chrono::nanoseconds(0);
  run_live(source.lidar(), ending, sink, out);
}

void dumping::tell_lidar(opened_source& source) const {
  tell_counts(source.lidar(), writer_->takes_scans() ? reading::scans : reading::points);
  tell(words_about(source.damage()));
  tell_pieces();
}

void dumping::tell_pieces() const {
  const std::uint64_t count = writer_->pieces_left_out();
  if (count == 0) return;
  tell(fmt::format("{} piece{} of revolutions left out; --partial writes {}, too\n", count,
                   count == 1 ? "" : "s", count == 1 ? "it" : "them"));
}

}  // namespace

int run(const dump_options& options) { return dumping(options).run(); }

}  // namespace g4_dump
