// SPDX-License-Identifier: MIT
#include "point_output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/core/wall_clock.hpp"
#include "g4lidar/transport/source.hpp"
#include "io/far_times.hpp"
#include "io/input.hpp"
#include "io/shape_files.hpp"

namespace g4_tool {

point_output::point_output(const point_options& options, time_origin origin)
    : options_(options), origin_(origin) {
  if (options_.form.has_scan_files()) choose_files();
  mask_ = mask_in(common_.mask);
  how_.shape = shape_of(common_, mask_);
  how_.shape.filter.returns_only = options_.returns_only;
  how_.partial_scans = options_.partial;
  how_.sample_rate_hz = options_.source.raw_sample_rate_hz.value_or(0);
  if (common_.count > 0) how_.count = common_.count;
  choose_times();
  load_path();
}

void point_output::choose_files() {
  const output_form& form = options_.form;
  if (form.bins > 0) throw bad_value("--grid cannot be combined with the formats pcd and svg");
  files_ = numbered_files_of(common_.output);
  if (files_) return;
  if (common_.count > 1) {
    throw bad_value("-n: a file holds one revolution; write several with -o scan-%04d.pcd");
  }
  common_.count = 1;
  if (form.file == scan_file::pcd && common_.output == "-" && form.data == pcd_data::binary &&
      ::isatty(1) != 0) {
    throw bad_value("standard output is a terminal; give -o FILE, or --pcd-data ascii");
  }
}

void point_output::choose_times() {
  const bool is_counted = origin_ == time_origin::counted;
  const bool has_range = is_counted || origin_ == time_origin::written;
  if (has_range) {
    how_.from_ns = options_.source.playback.from_ns;
    how_.to_ns = options_.source.playback.to_ns;
  }
  if (common_.duration.count() > 0 && origin_ != time_origin::live) {
    how_.to_ns = std::min<std::int64_t>(how_.to_ns, common_.duration.count());
  }
  how_.time = common_.time.value_or(has_range ? time_style::monotonic : time_style::absolute);
  const bool is_long = how_.time == time_style::absolute || how_.time == time_style::monotonic;
  if (options_.form.log != slam_log::none && how_.time == time_style::delta) {
    throw bad_value("--time delta: this format needs times that do not go back");
  }
  if (is_counted && common_.time && is_long)
    throw bad_value("--time: raw bytes carry no times; use zero or delta, see --sample-rate");
  if (is_long && !has_range) options_.form.style.time_width = 10;
  if (how_.time != time_style::absolute || has_range) return;
  how_.follows_wall_clock = origin_ == time_origin::live;
  how_.wall_ahead_ns = wall_clock().ahead().count();
  if (how_.follows_wall_clock) return;
  read_items(path_of_source(common_.source), {}, [this](const recorded_item& first) {
    how_.wall_ahead_ns = way_ns(first.time_ns, first.wall_ns);
    return false;
  });
}

/// The poses of the file of --odometry, or of the recording.
void point_output::load_path() {
  const slam_log log = options_.form.log;
  const bool is_needed = common_.deskew == deskewing::by_path || log != slam_log::none;
  if (!common_.odometry.empty()) {
    path_ = load_odometry(common_.odometry);
  } else if (is_needed && origin_ == time_origin::recorded) {
    for (const stamped_odometry& each : odometry_of_recording(path_of_source(common_.source))) {
      path_.push_back({each.time_ns, each.pose});
    }
  }
  if (path_.empty() && (common_.deskew == deskewing::by_path || log == slam_log::tum)) {
    throw bad_value(in_quotes(common_.source) + " has no poses of the robot: give --odometry FILE" +
                    (log == slam_log::tum ? "" : ", or --deskew scans"));
  }
  how_.path = path_;
  how_.on_path_only = log != slam_log::none && !path_.empty();
}

/// Numbered files are made by their writer. What may have no end goes to its file at once.
void point_output::open(bool has_end) {
  const bool is_whole =
      has_end || options_.form.has_scan_files() || options_.form.point_file || options_.whole_file;
  out_.emplace(files_ ? "/dev/null" : common_.output,
               is_whole ? output::appears::whole : output::appears::growing);
}

void point_output::use_model(const model& model) {
  how_.model = &model;
  how_.for_grid = options_.form.bins_of(model) > 0;
  auto [writer, point_file] = make_writer(options_.form, common_, model, files_);
  point_file_ = point_file;
  writer_ = std::make_unique<shaping_writer>(std::move(writer), how_);
}

/// Counted times begin with 0.
std::span<const point> point_output::from_first(std::span<const point> found) {
  if (origin_ != time_origin::counted || found.empty()) return found;
  if (!first_ns_) first_ns_ = found.front().time_ns;
  moved_.assign(found.begin(), found.end());
  for (point& each : moved_) each.time_ns = way_ns(*first_ns_, each.time_ns);
  return moved_;
}

void point_output::write(std::span<const point> found) {
  writer_->write_points(from_first(found), *out_);
}

bool point_output::write(const scan& found) {
  scan_record record{.scan = found};
  record.scan.points = from_first(found.points);
  if (!found.points.empty()) record.time_ns = record.scan.points.front().time_ns;
  scan measured = found;
  if (origin_ == time_origin::counted) measured.duration_ns = 0;  // it shows no frequency
  record.measured_hz = static_cast<double>(measured.measured_frequency_hz());
  const std::uint64_t left_out = writer_->pieces_left_out();
  writer_->write_scan(record, *out_);
  return writer_->pieces_left_out() != left_out;
}

void point_output::commit() {
  writer_->finish(*out_);
  // If there was no point, but packets.
  if (point_file_ != nullptr || origin_ == time_origin::counted) writer_->begin(*out_);
  if (point_file_ != nullptr) {
    point_file_->end(*out_);
    if (const std::string begin = point_file_->first_bytes(); !begin.empty())
      out_->replace_begin(begin);
  }
  out_->commit();
}

void point_output::report() const {
  if (const std::uint64_t count = writer_->pieces_left_out(); count > 0) {
    logger::info(counted(count, "incomplete revolution") + " left out" +
                 (options_.whole_file ? "\n" : "; --partial includes them\n"));
  }
  if (const std::uint64_t count = writer_->scans_off_path(); count > 0) {
    logger::info(counted(count, "revolution") +
                 " left out: the odometry has no pose at their time\n");
  }
  if (const std::uint64_t count = writer_->points_not_deskewed(); count > 0) {
    logger::info(fmt::format("{} not deskewed: {}\n", counted(count, "point"),
                             common_.deskew == deskewing::by_path
                                 ? "the odometry has no pose at their time"
                                 : "the scans do not show the motion"));
  }
  if (options_.form.has_scan_files() && !files_ && writer_->is_done()) {
    logger::info(
        "OUT has the first whole revolution. For all of them give a directory as OUT, or a name "
        "with %04d.\n");
  }
}

}  // namespace g4_tool
