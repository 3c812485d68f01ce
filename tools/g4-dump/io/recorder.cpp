// SPDX-License-Identifier: MIT
#include "recorder.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <span>
#include <system_error>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/option_rows.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/motion/odometry_feed.hpp"
#include "g4lidar/recording/reader.hpp"
#include "io/command_files.hpp"
#include "io/input.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/service_watch.hpp"
#include "io/shape_files.hpp"
#include "read_loop.hpp"

namespace g4_tool {

failure file_failure(const g4lidar::error& why, const std::string& path, bool is_kept) {
  const int number = why.system_errno();
  if (why.code() == problem::bad_option) return {exit_code::usage, in_tool_words(why.message())};
  if (why.code() != problem::system || number == 0)
    return {exit_code::bad_file, in_tool_words(why.message())};
  const bool is_full = number == ENOSPC || number == EDQUOT || number == EFBIG;
  return {
      exit_code::bad_file,
      fmt::format("cannot write {}: {}. {}{}", in_quotes(path),
                  number == EEXIST ? "it exists already" : std::generic_category().message(number),
                  advice_on_writing(number),
                  is_full && is_kept ? " What was written before can be read." : "")};
}

namespace {

/// One recording, from its beginning to its end.
class recorder {
 public:
  explicit recorder(const recording_job& job) : job_(job), line_(job.shows_counts) {}

  recorded_result run() {
    try {
      open();
      output nowhere("/dev/null");
      read_source(*source_, job_.common, sink(), nowhere);
      end();
      if (file_error_) throw why_not_written(job_.is_kept);
    } catch (...) {
      end();
      if (job_.shows_counts && has_run_ && job_.is_kept) report_recorded(result_, title_);
      if (file_error_ && interrupt() == 0) throw why_not_written(has_run_ && job_.is_kept);
      throw;
    }
    return result_;
  }

 private:
  /// Creates the file before the source is opened, because opening is recorded, too.
  void open() {
    const std::string& source = job_.common.source;
    if (size_of_file(path_of_source(source)) == 0U)
      throw without_packets({}, 0, {}, title_of_input(source));
    if (job_.title.empty()) claim_.emplace(job_.path);
    recording_options made = job_.made;
    made.overwrite = made.overwrite || may_replace();
    made.mount = job_.common.mount;
    if (!job_.common.odometry.empty()) {
      odometry_.set(load_moving_odometry(job_.common.odometry));
      made.keep_odometry = false;
    }
    lidar_options how = job_.source;
    how.partial_scans = true;  // so that points arrive at the latest when a scan's storage is full
    // The ring stores the points of many reads, so a read for each revolution is enough.
    how.tuning.pace = read_pace::revolutions;
    how.is_cancelled = [this] { return interrupt() != 0 || cannot_write(); };
    how.wrap = [this,
                &made](std::unique_ptr<connector> from) -> result<std::unique_ptr<connector>> {
      if (!writer_) {
        auto file = recording_writer::create(job_.path, made);
        if (!file) throw file_failure(file.error(), title_, false);  // nothing was written
        writer_ = std::make_unique<recording_writer>(std::move(*file));
        // Odometry of a file counts from its first byte; the clock of the connection does not begin at 0.
        const std::string& name = job_.common.source;
        if (kind_of_source(name) == source_kind::raw_bytes && is_file(path_of_source(name))) {
          odometry_.shift(from->now_ns());
        }
      }
      return recorded(std::move(from), *writer_);
    };
    source_ = std::make_unique<opened_source>(job_.common, how);
    points_ = std::make_unique<lidar_ring::reader>(source_->lidar().points().make_reader());
    odometry_.follow(source_->simulation());
    has_run_ = true;
    static_cast<void>(writer_->flush());  // from now on the file is at its place
    describe();
  }

  /// Records the information and settings of the device; recorded() does that for a recording.
  void describe() {
    if (names_file(job_.common.source)) return;
    g4lidar::lidar& lidar = source_->lidar();
    recorded_device known;
    known.information = lidar.information();
    if (const auto got = lidar.ask(requests::get_sample_rate())) known.sample_rate = *got;
    if (const auto got = lidar.ask(requests::get_scan_frequency())) known.frequency = *got;
    writer_->device(known);
  }

  read_sink sink() {
    const auto take = [this](const g4lidar::scan& scan) -> std::uint64_t {
      if (!scan.is_piece()) writer_->scan(scan);
      return scan.is_piece() ? 0 : 1;
    };
    return {.scan = take, .pulse = [this] { pulse(); }, .with_bar = !job_.shows_counts};
  }

  void pulse() {
    take_points();
    report_to_service();
    if (cannot_write()) throw why_not_written(job_.is_kept);
    if (!line_.is_due()) return;
    const lidar_counts lidar = source_->lidar().counts();
    line_.draw(fmt::format(
        "{:.0f} s  {}  {}  {} skipped  {:.1f} MB in {}", line_.seconds(),
        counted(lidar.stream.points, "point"), counted(lidar.scans, "scan"),
        counted(lidar.stream.skipped_bytes(), "byte"),
        static_cast<double>(writer_->counts().file_bytes) / 1e6,
        printable(job_.title.empty() ? writer_->path() : std::string_view(job_.title))));
  }

  void take_points() {
    while (const std::size_t count = points_->read(memory_).points) {
      const std::span<const point> points = std::span(memory_).first(count);
      writer_->points(points);
      odometry_.follow(points, [this](const stamped_odometry& at) { writer_->odometry(at); });
    }
  }

  /// Reports to systemd: ready when the lidar scans, alive with each call.
  void report_to_service() {
    service_.ready();
    service_.alive();
    if (service_.has_manager()) {
      service_.status(fmt::format("recording {}: {}", writer_->path(),
                                  counted(source_->lidar().counts().scans, "scan")));
    }
  }

  /// Ends the scan, the connection and the file, in this order. Keeps the first error of the file.
  void end() {
    line_.clear();
    service_.stopping();
    if (!writer_) return;
    if (source_) {
      result_.damage = source_->damage();
      if (const auto* played = source_->recording()) result_.recorded = played->digest();
      static_cast<void>(source_->lidar().close());
      if (points_) take_points();
      result_.lidar = source_->lidar().counts();
    }
    points_.reset();
    odometry_.follow(nullptr);
    source_.reset();
    result_.file = writer_->counts();
    // Without has_run_ the file contains only the attempt to open the source.
    const bool has_bytes = result_.file.bytes_from_device + result_.file.bytes_to_device > 0;
    const bool is_kept = has_run_ || (job_.keeps_attempt && has_bytes);
    if (is_kept) {
      static_cast<void>(writer_->flush());
      const auto closed = writer_->close();
      if (!cannot_write() && !closed) file_error_ = closed.error();
    } else {
      writer_->discard();
    }
    result_.file = writer_->counts();
    result_.digest = writer_->digest();
    path_ = writer_->path();
    writer_.reset();
  }

  /// Whether something could not be written.
  bool cannot_write() {
    if (!file_error_ && writer_) file_error_ = writer_->take_error();
    return file_error_.has_value();
  }

  /// The failure for `file_error_`.
  [[nodiscard]] failure why_not_written(bool is_kept) {
    if (writer_) path_ = writer_->path();
    const bool has_several = job_.title.empty() && !path_.empty();
    // NOLINTNEXTLINE(bugprone-unchecked-optional-access): there is one
    return file_failure(*file_error_, has_several ? path_ : title_, is_kept);
  }

  static bool is_file(const std::string& path) {
    std::error_code unimportant;
    return std::filesystem::is_regular_file(path, unimportant);
  }

  const recording_job& job_;
  const std::string& title_ = job_.title.empty() ? job_.path : job_.title;
  std::optional<claimed_output> claim_;
  std::string path_;  // of the last file
  status_line line_;
  service_watch service_;
  std::unique_ptr<recording_writer> writer_;  // outlives the source, which writes to it
  std::unique_ptr<opened_source> source_;
  std::unique_ptr<lidar_ring::reader> points_;
  std::array<g4lidar::point, 512> memory_{};
  odometry_feed odometry_;
  std::optional<g4lidar::error> file_error_;
  recorded_result result_;
  bool has_run_ = false;
};

}  // namespace

option_rows message_rows(g4lidar::recording_options& into) {
  return joined(
      option_rows{value_row("--points", "", "Write each revolution as a PointCloud2 message, too",
                            into.points_topic, [](const std::string&) { return "/points"; }),
                  row_of("order", into.order)},
      near_row(into.near), grid_rows(into.grid));
}

recorded_result record(const recording_job& job) {
  note_order(job.made.order);
  return recorder(job).run();
}

void report_recorded(const recorded_result& result, const std::string& path) {
  const recording_counts& file = result.file;
  logger::info(fmt::format("{}: {} in {}: {} from the lidar, {} to it, {}\n", path,
                           counted(file.file_bytes, "byte"), counted(file.files, "file"),
                           counted(file.bytes_from_device, "byte"), file.bytes_to_device,
                           counted(file.scans, "scan")));
  if (file.odometry > 0) logger::info(counted(file.odometry, "pose") + " of the odometry\n");
  if (file.chunks_lost > 0) {
    logger::info(fmt::format("{} in {} could not be written\n", counted(file.bytes_lost, "byte"),
                             counted(file.chunks_lost, "chunk")));
  }
  logger::info(fmt::format("digest of all bytes {:016x}, of {} {:016x}\n", result.digest.payload,
                           counted(result.digest.point_count, "point"), result.digest.points));
}

}  // namespace g4_tool
