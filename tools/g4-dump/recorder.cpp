// SPDX-License-Identifier: MIT
#include "recorder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "exit_code.hpp"
#include "file_id.hpp"
#include "g4lidar/recording_reader.hpp"
#include "live.hpp"
#include "manners.hpp"
#include "output.hpp"
#include "say.hpp"
#include "service_watch.hpp"

namespace g4_dump {
namespace {

using clock = std::chrono::steady_clock;

std::string advice_on(int error) {
  switch (error) {
    case EEXIST:
      return "Give another name, or --force to replace it.";
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "Make room there, or give another place. What was written before can be read.";
    case ENOENT:
    case ENOTDIR:
      return "Make its directory first, or give another name.";
    case EACCES:
    case EPERM:
    case EROFS:
      return "Give a place where you may write.";
    default:
      return "Give another place.";
  }
}

const std::string& title_of(const recording_job& job) {
  return job.title.empty() ? job.path : job.title;
}

failure file_failure(const g4lidar::error& why, const std::string& path) {
  return {why.what() == g4lidar::problem::bad_option ? exit_code::usage : exit_code::bad_file,
          words_about_file(why, path)};
}

/// How it goes, in one line of a terminal that is drawn over.
class counts_line {
 public:
  explicit counts_line(bool wanted) : on_(wanted && !our_manners().quiet && ::isatty(2) != 0) {}
  counts_line(const counts_line&) = delete;
  counts_line& operator=(const counts_line&) = delete;
  ~counts_line() { clear(); }

  void show(const g4lidar::lidar_counts& lidar, const g4lidar::recording_counts& file,
            std::string_view path) {
    if (!on_ || clock::now() < next_) return;
    next_ = clock::now() + std::chrono::milliseconds(200);
    drawn_ = true;
    const std::chrono::duration<double> took = clock::now() - begin_;
    say(fmt::format("\r{:.0f} s  {} points  {} scans  {} bytes skipped  {:.1f} MB in {}\x1b[K",
                    took.count(), lidar.stream.points, lidar.scans, lidar.stream.skipped_bytes(),
                    static_cast<double>(file.file_bytes) / 1e6, path));
  }
  void clear() {
    if (std::exchange(drawn_, false)) say("\r\x1b[K");
  }

 private:
  bool on_;
  bool drawn_ = false;
  clock::time_point begin_ = clock::now();
  clock::time_point next_ = begin_;
};

/// One recording, from its beginning to its end.
class recorder {
 public:
  explicit recorder(const recording_job& job) : job_(job), line_(job.shows_counts) {}

  void run() {
    try {
      open();
      output nowhere("/dev/null");
      run_live(source_->lidar(), job_.common, sink(), nowhere);
    } catch (...) {
      line_.clear();
      end();
      throw;
    }
    line_.clear();
    end();
    if (const auto why = file_error_) throw file_failure(*why, title_of(job_));
  }

  [[nodiscard]] const recorded_result& result() const noexcept { return result_; }
  /// Whether there is anything to tell of.
  [[nodiscard]] bool has_run() const noexcept { return has_run_; }

 private:
  /// The file is there before the source is opened, for that is recorded, too.
  void open() {
    opening how = job_.source;
    how.how.partial_scans = true;  // so that points come at latest when a scan's storage is full
    how.tap = [this](std::unique_ptr<g4lidar::connector> line)
        -> g4lidar::result<std::unique_ptr<g4lidar::connector>> {
      if (!writer_) create();
      return g4lidar::recorded(std::move(line), *writer_);
    };
    source_ = std::make_unique<opened_source>(job_.common, how);
    points_ =
        std::make_unique<g4lidar::lidar_ring::reader>(source_->lidar().points().make_reader());
    has_run_ = true;
    describe();
  }

  void create() {
    auto made = g4lidar::recording_writer::create(job_.path, job_.made);
    if (!made) throw file_failure(made.error(), title_of(job_));
    writer_ = std::make_unique<g4lidar::recording_writer>(std::move(*made));
  }

  /// What there is to know of the device without changing anything.
  void describe() {
    g4lidar::lidar& lidar = source_->lidar();
    g4lidar::recorded_device known;
    known.information = lidar.information();
    const source_kind kind = kind_of(job_.common.source);
    if (kind == source_kind::recording) {
      const auto reader = g4lidar::recording_reader::open(path_of(job_.common.source));
      if (reader) {
        const std::optional<g4lidar::recorded_device>& device = reader->device();
        if (device) known = *device;
      }
    } else if (kind != source_kind::bytes) {
      known.ranging = asked<g4lidar::ranging_frequency>(g4lidar::requests::get_ranging());
      known.frequency = asked<g4lidar::scan_frequency>(g4lidar::requests::get_scan_frequency());
    } else {
      return;
    }
    writer_->device(known);
  }

  template <class Answer>
  std::optional<Answer> asked(const g4lidar::request& question) {
    const auto got = source_->lidar().ask_for<Answer>(question);
    if (!got) return std::nullopt;
    return *got;
  }

  live_sink sink() {
    live_sink made;
    made.scan = [this](const g4lidar::scan& scan) { return take(scan); };
    made.pulse = [this] { pulse(); };
    return made;
  }

  std::uint64_t take(const g4lidar::scan& scan) {
    constexpr g4lidar::scan_marks pieces = g4lidar::scan_marks::start_missing |
                                           g4lidar::scan_marks::end_missing |
                                           g4lidar::scan_marks::turn_short;
    if (scan.has(pieces)) return 0;
    if (job_.scans) writer_->scan(scan);
    return 1;
  }

  void pulse() {
    take_points();
    tell_service();
    if (const auto why = writer_->take_error()) throw file_failure(*why, title_of(job_));
    line_.show(source_->lidar().counts(), writer_->counts(),
               job_.title.empty() ? writer_->path() : std::string_view(job_.title));
  }

  void take_points() {
    while (const std::size_t count = points_->read(memory_).points) {
      writer_->points(std::span(memory_).first(count));
    }
  }

  /// A service says that it is ready when the lidar scans, and that it lives with each turn.
  void tell_service() {
    service_.ready();
    service_.alive();
    if (service_.is_heard()) {
      service_.status(
          fmt::format("recording {}: {} scans", writer_->path(), source_->lidar().counts().scans));
    }
  }

  /// Ends the scan, the line and the file, in this order; what failed by then stays to be told.
  void end() {
    service_.stopping();
    if (!writer_) return;
    if (source_) {
      result_.damage = source_->damage();
      static_cast<void>(source_->lidar().close());
      if (points_) take_points();
      result_.lidar = source_->lidar().counts();
    }
    points_.reset();
    source_.reset();
    const auto closed = writer_->close();
    file_error_ = writer_->take_error();
    if (!closed && !file_error_) file_error_ = closed.error();
    result_.file = writer_->counts();
    result_.digest = writer_->digest();
    std::error_code unimportant;
    // It holds an attempt to open the source, and nothing else.
    const bool is_file = std::filesystem::is_regular_file(job_.path, unimportant);
    if (!has_run_ && is_file) std::filesystem::remove(job_.path, unimportant);
  }

  const recording_job& job_;
  counts_line line_;
  service_watch service_;
  std::unique_ptr<g4lidar::recording_writer>
      writer_;  // outlives the source, which is recorded by it
  std::unique_ptr<opened_source> source_;
  std::unique_ptr<g4lidar::lidar_ring::reader> points_;
  std::array<g4lidar::point, 512> memory_{};
  std::optional<g4lidar::error> file_error_;
  recorded_result result_;
  bool has_run_ = false;
};

}  // namespace

std::string words_about_file(const g4lidar::error& why, const std::string& path) {
  if (why.what() != g4lidar::problem::system || why.system_errno() == 0) return why.message();
  const bool is_there = why.system_errno() == EEXIST;
  return fmt::format(
      "cannot write {}: {}. {}", in_quotes(path),
      is_there ? "it is there already" : std::generic_category().message(why.system_errno()),
      advice_on(why.system_errno()));
}

recorded_result record(const recording_job& job) {
  recorder one(job);
  try {
    one.run();
  } catch (const failure&) {
    if (job.shows_counts && one.has_run()) tell_recorded(one.result(), title_of(job));
    throw;
  }
  return one.result();
}

void tell_recorded(const recorded_result& result, const std::string& path) {
  const g4lidar::recording_counts& file = result.file;
  tell(fmt::format("{}: {} bytes in {} file{}: {} bytes from the lidar, {} to it, {} scans\n", path,
                   file.file_bytes, file.files, file.files == 1 ? "" : "s", file.bytes_from_device,
                   file.bytes_to_device, file.scans));
  if (file.chunks_lost > 0) {
    tell(fmt::format("{} bytes in {} chunks could not be written\n", file.bytes_lost,
                     file.chunks_lost));
  }
  tell(fmt::format("digest of all bytes {:016x}, of {} points {:016x}\n", result.digest.payload,
                   result.digest.point_count, result.digest.points));
}

}  // namespace g4_dump
