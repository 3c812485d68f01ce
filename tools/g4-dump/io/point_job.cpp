// SPDX-License-Identifier: MIT
#include "point_job.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "export/byte_points.hpp"
#include "export/shaping_writer.hpp"
#include "export/slam_text.hpp"
#include "g4lidar/wall_clock.hpp"
#include "io/far_times.hpp"
#include "io/input.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/shape_files.hpp"
#include "read_loop.hpp"
#include "scan_file_writer.hpp"
#include "text_input.hpp"

namespace g4_tool {
namespace {

/// For any model. `shape`: of the revolutions.
writing_options how_to_write(const point_job& job, const common_options& common, source_kind kind,
                             const shaping_options& shape) {
  const bool is_file = kind == source_kind::raw_bytes;
  writing_options made{.shape = shape};
  made.shape.filter.returns_only = job.returns_only;
  made.partial_scans = job.partial;
  if (common.count > 0) made.count = common.count;
  if (is_file) {
    made.from_ns = job.source.playback.from_ns;
    made.to_ns = job.source.playback.to_ns;
  }
  if (common.duration.count() > 0 && (is_file || kind == source_kind::recording)) {
    made.to_ns = std::min<std::int64_t>(made.to_ns, common.duration.count());
  }
  made.time = common.time.value_or(is_file ? time_style::monotonic : time_style::absolute);
  if (job.log != slam_log::none && made.time == time_style::delta) {
    throw bad_value("--time delta: this format needs times that do not go back");
  }
  if (is_file && !job.text && common.time &&
      (made.time == time_style::absolute || made.time == time_style::monotonic)) {
    throw bad_value("--time: raw bytes carry no times; use zero or delta, see --sample-rate");
  }
  if (made.time != time_style::absolute || is_file) return made;
  made.follows_wall_clock = kind != source_kind::recording;
  made.wall_ahead_ns = wall_clock().ahead().count();
  if (made.follows_wall_clock) return made;
  read_items(path_of_source(common.source), {}, [&made](const recorded_item& first) {
    made.wall_ahead_ns = way_ns(first.time_ns, first.wall_ns);
    return false;
  });
  return made;
}

/// One run of a job, from the options to the counts.
class point_run {
 public:
  explicit point_run(const point_job& job)
      : job_(job), common_(*job.common), kind_(kind_of_source(common_.source)) {
    if (job_.text) kind_ = source_kind::raw_bytes;
    if (has_scan_files()) choose_files();
    const g4lidar::model* known = common_.expected.model;
    if (!job_.text) known = model_of(common_, &recognised_);
    if (known == nullptr && kind_ == source_kind::raw_bytes && !job_.text) known = open_pipe();
    if (job_.text) {
      text_model_ = model_of_text(open_input(), *job_.text, common_);
      known = &text_model_;
    }
    mask_ = mask_in(common_.mask);
    how_ = how_to_write(job_, common_, kind_, shape_of(common_, mask_));
    load_path(how_);
    job_.style.to = common_.frame;
    job_.style.unit = common_.unit;
    const bool has_long_times =
        how_.time == time_style::absolute || how_.time == time_style::monotonic;
    if (has_long_times && kind_ != source_kind::raw_bytes) job_.style.time_width = 10;
    use_model(known != nullptr ? *known : g4_model);  // of a device: until it is opened
  }

  int run() {
    if (recognised_ && !job_.json_counts) report_model(*recognised_);
    kind_ == source_kind::raw_bytes ? read_file() : read_lidar();
    return exit_code_now();
  }

 private:
  [[nodiscard]] bool has_scan_files() const { return job_.file != scan_file::none; }
  input& open_input() {
    return input_.emplace(path_of_source(common_.source),
                          job_.text ? "Give csv or jsonl as g4-dump writes it."
                                    : "Give a file of raw bytes from the lidar's port, or "
                                      "pipe them in.");
  }
  /// The model of a pipe is not known before its first bytes.
  const g4lidar::model* open_pipe() {
    return recognised_.emplace(open_input().recognise(common_)).which;
  }
  /// Makes the writer, with the columns and the turn of the model.
  void use_model(const g4lidar::model& which) {
    model_ = &which;
    // A G4 measures 1286 points at 7 Hz.
    bins_ = job_.log == slam_log::carmen && job_.bins == 0 ? std::size_t{2} * default_bins(which)
                                                           : job_.bins;
    job_.style.intensity = has_intensity(which);
    job_.style.sample_flags = has_sample_flags(which.samples.layout);
    job_.style.turn_deg = which.turn_deg;
    how_.model = model_;
    how_.sample_rate_hz = job_.source.raw_sample_rate_hz.value_or(0);
    how_.for_grid = bins_ > 0;
    point_file_ = nullptr;
    writer_ = std::make_unique<shaping_writer>(make_writer(), how_);
  }
  void choose_files() {
    if (job_.bins > 0) throw bad_value("--grid cannot be combined with the formats pcd and svg");
    files_ = numbered_files_of(common_.output);
    if (files_) return;
    if (common_.count > 1) {
      throw bad_value("-n: a file holds one revolution; write several with -o scan-%04d.pcd");
    }
    common_.count = 1;
    if (job_.file == scan_file::pcd && common_.output == "-" && job_.data == pcd_data::binary &&
        ::isatty(1) != 0) {
      throw bad_value("standard output is a terminal; give -o FILE, or --pcd-data ascii");
    }
  }

  /// The poses of the file of --odometry, or of the recording.
  void load_path(writing_options& how) {
    const bool is_needed = common_.deskew == deskewing::by_path || job_.log != slam_log::none;
    if (!common_.odometry.empty()) {
      path_ = load_odometry(common_.odometry);
    } else if (is_needed && kind_ == source_kind::recording) {
      for (const stamped_odometry& each : odometry_of_recording(path_of_source(common_.source))) {
        path_.push_back({each.time_ns, each.pose});
      }
    }
    if (path_.empty() && (common_.deskew == deskewing::by_path || job_.log == slam_log::tum)) {
      throw bad_value(in_quotes(common_.source) +
                      " has no poses of the robot: give --odometry FILE" +
                      (job_.log == slam_log::tum ? "" : ", or --deskew scans"));
    }
    how.path = path_;
    how.on_path_only = job_.log != slam_log::none && !path_.empty();
  }

  std::unique_ptr<point_writer> make_writer() {
    if (job_.point_file) {
      auto writer = make_point_file_writer(*job_.point_file, common_.frame, *model_);
      point_file_ = writer.get();
      return writer;
    }
    if (has_scan_files()) {
      return std::make_unique<scan_file_writer>(job_.file, common_.frame, job_.data, files_);
    }
    if (job_.log == slam_log::carmen)
      return make_carmen_writer(bins_, common_.mount.value_or(mounting{}));
    if (job_.log == slam_log::tum) return make_tum_writer();
    if (bins_ > 0) return make_grid_writer(job_.style, bins_, common_.grid);
    return make_point_writer(job_.style);
  }

  /// Numbered files are made by their writer. What may have no end goes to its file at once.
  [[nodiscard]] std::string output_name() const { return files_ ? "/dev/null" : common_.output; }
  [[nodiscard]] output::appears when_it_appears(bool has_end) const {
    return has_end || has_scan_files() || job_.point_file || job_.whole_file
               ? output::appears::whole
               : output::appears::growing;
  }

  /// Writes what is left, and ends the file.
  void commit(output& out) {
    writer_->finish(out);
    if (point_file_ != nullptr) {
      writer_->begin(out);  // if there was no point
      point_file_->end(out);
      if (const std::string begin = point_file_->first_bytes(); !begin.empty())
        out.replace_begin(begin);
    }
    out.commit();
  }

  void pump(input& in, output& out,
            const std::function<void(std::span<const std::uint8_t>)>& take) {
    in.pump(out,
            {.take = take,
             .is_done = [this] { return writer_->is_done(); },
             .with_bar = !job_.json_counts},
            common_);
  }

  void read_file() {
    input& in = input_ ? *input_ : open_input();
    output out(output_name(), when_it_appears(in.is_file()));
    const std::uint64_t found = job_.text ? read_text(in, out) : read_bytes(in, out);
    if (found > 0) commit(out);
    report_left_out();
  }

  std::uint64_t read_bytes(input& in, output& out) {
    if (common_.expected.zero_angle && model_->zero_angle_divisor == 0) {
      throw bad_value(
          fmt::format("--zero-angle: {} {} has no such offset", article_of(*model_), model_->name));
    }
    byte_points way(*writer_, out, job_.source.raw_sample_rate_hz.value_or(first_rate_hz(*model_)),
                    *model_, common_.expected.zero_angle);
    std::vector<std::uint8_t> beginning;
    pump(in, out, [&](std::span<const std::uint8_t> got) {
      const auto more = got.first(std::min(got.size(), beginning_bytes - beginning.size()));
      beginning.insert(beginning.end(), more.begin(), more.end());
      way.take(got);
    });
    if (!writer_->is_done()) way.finish();  // else what is left was not asked for
    if (job_.json_counts) {
      logger::write(json_line(counts_as_json(way.counts(), way.bytes())));
    } else if (way.bytes() > 0) {
      logger::info(stats_in_words(way.counts(), way.bytes()));
      logger::info(warning_about(way.counts(), way.bytes(), beginning));
      if (way.lacks_zero()) report_missing_zero(*model_);
      report_contradictions(
          {.model = model_, .by = known_by::samples, .number = way.other_number()});
    }
    if (way.counts().packets == 0 && !out.is_closed() && interrupt() == 0) {
      throw without_packets(way.counts(), way.bytes(), beginning, in.title());
    }
    return way.counts().packets;
  }

  std::uint64_t read_text(input& in, output& out) {
    if (!job_.text) return 0;
    text_points way(*job_.text, job_.text_frame, *writer_, out, *model_);
    pump(in, out, [&](std::span<const std::uint8_t> got) {
      way.take({reinterpret_cast<const char*>(got.data()), got.size()});
    });
    if (!writer_->is_done()) way.finish();
    report_text(way, in.title(), text_model_);
    return way.points();
  }

  void read_lidar() {
    const bool is_recording = kind_ == source_kind::recording;
    output out(output_name(), when_it_appears(is_recording));
    lidar_options how = job_.source;
    how.partial_scans = writer_->takes_scans();  // the writer leaves them out, and counts them
    opened_source source(common_, how);
    use_model(source.model());
    try {
      run_lidar(source, out);
    } catch (const failure&) {  // what came before it is good
      if (source.lidar().counts().stream.packets > 0) commit(out);
      report_lidar(source);
      throw;
    }
    const bool has_packets = source.lidar().counts().stream.packets > 0;
    if (has_packets || !is_recording) commit(out);
    report_lidar(source);
    if (!has_packets && is_recording && interrupt() == 0 && !out.is_closed()) {
      throw failure(exit_code::bad_file,
                    "there is no whole packet in " + in_quotes(common_.source) +
                        (job_.source.playback.from_ns > 0 ? " from that time on." : ".") +
                        " g4-dump packets shows what it holds; or give another file.");
    }
  }

  void run_lidar(opened_source& source, output& out) {
    read_sink sink;
    if (writer_->takes_scans()) {
      sink.scan = [&](const g4lidar::scan& scan) {
        scan_record record{.scan = scan};
        if (!scan.points.empty()) record.time_ns = scan.points.front().time_ns;
        record.measured_hz = static_cast<double>(scan.measured_frequency_hz());
        const std::uint64_t left_out = writer_->pieces_left_out();
        writer_->write_scan(record, out);
        return std::uint64_t{writer_->pieces_left_out() == left_out ? 1U : 0U};
      };
    } else {
      sink.points = [&](std::span<const point> points) { writer_->write_points(points, out); };
    }
    sink.is_done = [this] { return writer_->is_done(); };
    common_options ending = common_;
    if (kind_ == source_kind::recording) ending.duration = std::chrono::nanoseconds(0);
    read_source(source, ending, sink, out);
  }

  void report_lidar(opened_source& source) const {
    report_counts(source.lidar().counts(), writer_->takes_scans());
    logger::info(describe(source.damage()));
    report_left_out();
  }

  void report_left_out() const {
    if (const std::uint64_t count = writer_->pieces_left_out(); count > 0) {
      logger::info(counted(count, "incomplete revolution") + " left out" +
                   (job_.whole_file ? "\n" : "; --partial includes them\n"));
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
    if (has_scan_files() && !files_ && writer_->is_done()) {
      logger::info(
          "OUT has the first whole revolution. For all of them give a directory as OUT, or a name "
          "with %04d.\n");
    }
  }

  point_job job_;
  common_options common_;
  source_kind kind_;
  numbered_files files_;
  std::optional<input> input_;
  g4lidar::model text_model_;                   // of points as text
  std::optional<recognised_model> recognised_;  // from raw bytes, if no model is named
  std::vector<stamped_pose> path_;
  g4lidar::mask mask_;
  writing_options how_;  // but for the model
  const g4lidar::model* model_ = nullptr;
  std::size_t bins_ = 0;  // 0: points and no grid
  std::unique_ptr<shaping_writer> writer_;
  point_file_writer* point_file_ = nullptr;  // behind writer_
};

}  // namespace

int run(const point_job& job) { return point_run(job).run(); }

}  // namespace g4_tool
