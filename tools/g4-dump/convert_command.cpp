// SPDX-License-Identifier: MIT
#include "convert_command.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "byte_line.hpp"
#include "byte_points.hpp"
#include "byte_pump.hpp"
#include "exit_code.hpp"
#include "file_id.hpp"
#include "g4lidar/transport.hpp"
#include "input.hpp"
#include "interrupt.hpp"
#include "live.hpp"
#include "manners.hpp"
#include "output.hpp"
#include "pcd_writer.hpp"
#include "played_points.hpp"
#include "progress.hpp"
#include "recorder.hpp"
#include "shaped_writer.hpp"
#include "source.hpp"
#include "stats.hpp"
#include "text_points.hpp"

namespace g4_dump {
namespace {

bool ends_with_any(const std::string& name, std::initializer_list<std::string_view> endings) {
  for (const std::string_view ending : endings) {
    if (name.ends_with(ending)) return true;
  }
  return false;
}

/// What IN seems to be.
file_form form_by_looks(const convert_options& options) {
  const std::string& name = options.common->source;
  const source_kind kind = kind_of(name);
  if (kind == source_kind::device && !std::filesystem::exists(path_of(name))) {
    throw failure(exit_code::bad_file, "there is no file " + in_quotes(name) +
                                           ". Check the name; a lidar is read by g4-dump dump, or "
                                           "by g4-dump record first.");
  }
  if (kind == source_kind::simulated || kind == source_kind::device) {
    throw bad_value(in_quotes(name) + " is no file: dump or record it");
  }
  if (options.from) return *options.from;
  if (kind == source_kind::recording) return file_form::recording;
  if (ends_with_any(name, {".mcap"})) return file_form::recording;  // it will say what is wrong
  if (ends_with_any(name, {".csv"})) return file_form::csv;
  if (ends_with_any(name, {".jsonl", ".ndjson"})) return file_form::jsonl;
  if (ends_with_any(name, {".pcd"})) throw bad_value("pcd is written, but not read");
  return file_form::raw_bytes;
}

file_form form_of_output(const convert_options& options) {
  if (options.to) return *options.to;
  const std::string& name = options.common->output;
  std::error_code unknown;
  if (ends_with_any(name, {".pcd", "/"}) || std::filesystem::is_directory(name, unknown)) {
    return file_form::pcd;
  }
  if (ends_with_any(name, {".mcap"})) return file_form::recording;
  if (ends_with_any(name, {".csv"})) return file_form::csv;
  if (ends_with_any(name, {".jsonl", ".ndjson"})) return file_form::jsonl;
  if (ends_with_any(name, {".bin", ".raw"})) return file_form::raw_bytes;
  throw bad_value(
      fmt::format("'{}' ends in none of .mcap, .bin, .csv, .jsonl and .pcd; say what it "
                  "is to be with --to-format",
                  name));
}

file_form form_of_input(const convert_options& options) {
  const file_form form = form_by_looks(options);
  const std::string& name = options.common->source;
  if (form == file_form::recording && kind_of(name) != source_kind::recording) {
    throw failure(exit_code::bad_file,
                  in_quotes(name) + " is no recording. Give a file that g4-dump record made.");
  }
  return form;
}

bool is_text(file_form form) { return form == file_form::csv || form == file_form::jsonl; }

void refuse_nonsense(const convert_options& options, file_form from, file_form to) {
  const bool to_points = is_text(to) || to == file_form::pcd;
  if (is_text(from) && !to_points) {
    throw bad_value(
        fmt::format("{} holds points, and no bytes of a lidar: of these, csv, jsonl and "
                    "pcd can be made, but neither raw bytes nor a recording",
                    in_quotes(options.common->source)));
  }
  if (!to_points && options.shapes) {
    throw bad_value(
        "raw bytes and recordings hold what the lidar sent: --range, --fov, --ignore, "
        "--frame, --unit, --time and --scans are for points");
  }
  if (to == file_form::recording && options.common->output == "-") {
    throw bad_value("a recording is written to a file, not to standard output");
  }
}

std::optional<file_id> id_of_name(const std::string& name) {
  struct stat status{};
  if (::stat(name.c_str(), &status) != 0) return std::nullopt;
  return id_of(status);
}

int exit_code_now() {
  return interrupt() != 0 ? 128 + interrupt() : static_cast<int>(exit_code::ok);
}

/// Lets through what lies in a range of time, counted from the first point.
class time_cut final : public point_writer {
 public:
  time_cut(point_writer& inner, const g4lidar::reading_options& range)
      : inner_(inner), range_(range) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return inner_.takes_scans(); }
  void begin(output& out) override { inner_.begin(out); }
  void write_points(std::span<const g4lidar::point> points, output& out) override {
    std::size_t first = 0;
    while (first < points.size() && !has(points[first].time_ns)) ++first;
    std::size_t end = first;
    while (end < points.size() && has(points[end].time_ns)) ++end;
    if (end > first) inner_.write_points(points.subspan(first, end - first), out);
  }
  void write_scan(const shown_scan& shown, output& out) override {
    if (has(shown.time_ns)) inner_.write_scan(shown, out);
  }

  /// Whether nothing more can follow.
  [[nodiscard]] bool is_over() const noexcept { return is_over_; }

 private:
  bool has(std::int64_t time_ns) {
    if (!first_ns_) first_ns_ = time_ns;
    const std::int64_t since_ns = time_ns - *first_ns_;
    is_over_ = since_ns >= range_.to_ns;
    return since_ns >= range_.from_ns && !is_over_;
  }

  point_writer& inner_;
  g4lidar::reading_options range_;
  std::optional<std::int64_t> first_ns_;
  bool is_over_ = false;
};

// ---- to points ----------------------------------------------------------------------------------

void from_bytes(const convert_options& options, shaped_writer& writer, output& out) {
  input in(path_of(options.common->source), "Give a recording, raw bytes, csv or jsonl.");
  refuse_same_file(in.id(), out);
  time_cut cut(writer, options.range);
  byte_points way(cut, out, options.rate_hz);
  text_detector detector;
  byte_sink sink;
  sink.take = [&](std::span<const std::uint8_t> got) {
    detector.look_at(got);
    way.take(got);
  };
  sink.is_done = [&] { return cut.is_over() || writer.is_done(); };
  sink.with_bar = !our_manners().quiet;
  pump(in, out, sink);
  way.finish();
  if (way.bytes() > 0) {
    tell(stats_in_words(way.counts(), way.bytes()));
    tell(warning_about(way.counts(), way.bytes()));
  }
  if (way.counts().packets == 0 && interrupt() == 0 && !out.is_closed()) {
    throw failure(exit_code::bad_file,
                  why_no_packet(way.counts(), way.bytes(), detector.is_text(), in.title()));
  }
}

[[noreturn]] void refuse_text(const text_points& way, const std::string& title) {
  throw failure(exit_code::bad_file,
                way.is_foreign()
                    ? title +
                          " has no columns angle_deg and range_mm or range_m. Give points as "
                          "g4-dump writes them."
                    : title +
                          " holds no points. Give points as g4-dump writes them, a line for "
                          "each.");
}

void from_text(const convert_options& options, text_source form, shaped_writer& writer,
               output& out) {
  input in(path_of(options.common->source), "Give a recording, raw bytes, csv or jsonl.");
  refuse_same_file(in.id(), out);
  time_cut cut(writer, options.range);
  text_points way(form, options.from_frame, cut, out);
  byte_sink sink;
  sink.take = [&](std::span<const std::uint8_t> got) {
    way.take({reinterpret_cast<const char*>(got.data()), got.size()});
  };
  sink.is_done = [&] { return cut.is_over() || writer.is_done(); };
  sink.with_bar = !our_manners().quiet;
  pump(in, out, sink);
  way.finish();
  if (way.points() == 0 && interrupt() == 0) refuse_text(way, in.title());
  tell(fmt::format("{} points, {} lines without one\n", way.points(), way.bad_lines()));
}

void from_recording(const convert_options& options, shaped_writer& writer, output& out) {
  const std::string path = path_of(options.common->source);
  refuse_same_file(id_of_name(path), out);
  const played_result played =
      play_points(path, options.range, writer, out, [&] { return writer.is_done(); });
  tell_counts(played.counts, writer.takes_scans() ? reading::scans : reading::points);
  tell(words_about(played.damage));
  if (played.counts.stream.points == 0 && interrupt() == 0 && !out.is_closed()) {
    throw failure(exit_code::bad_file, in_quotes(path) + " holds no points" +
                                           (options.range.from_ns > 0 ? " there." : "."));
  }
}

std::unique_ptr<point_writer> writer_for(const convert_options& options, file_form to,
                                         const std::optional<numbered_files>& files) {
  point_style style;
  style.scans = options.scans;
  style.rate_hz = options.rate_hz;
  style.frame = options.common->frame;
  style.unit = options.common->unit;
  if (to == file_form::pcd) {
    return make_pcd_writer(style.frame, options.is_ascii ? pcd_data::ascii : pcd_data::binary,
                           files);
  }
  style.format = to == file_form::csv ? text_format::csv : text_format::jsonl;
  return make_point_writer(style);
}

int to_points(const convert_options& options, file_form from, file_form to) {
  std::optional<numbered_files> files;
  if (to == file_form::pcd) files = numbered_files::from(options.common->output);
  const bool is_one_cloud = to == file_form::pcd && !files;
  common_options common = *options.common;
  if (is_one_cloud) common.count = 1;
  output out(files ? "/dev/null" : common.output);
  shape_plan plan;
  plan.time = options.common->time.value_or(time_style::monotonic);
  if (from == file_form::recording && plan.time == time_style::absolute) {
    plan.wall_ahead_ns = recorded_wall_ahead_ns(path_of(options.common->source));
  }
  plan.partial_scans = to != file_form::pcd;
  shaped_writer writer(writer_for(options, to, files), common, plan);
  switch (from) {
    case file_form::recording:
      from_recording(options, writer, out);
      break;
    case file_form::raw_bytes:
      from_bytes(options, writer, out);
      break;
    default:
      from_text(options, from == file_form::csv ? text_source::csv : text_source::jsonl, writer,
                out);
  }
  out.commit();
  if (is_one_cloud && writer.is_done()) {
    tell("the first whole revolution; OUT with %04d, or a directory, takes all of them\n");
  }
  return exit_code_now();
}

// ---- to bytes -----------------------------------------------------------------------------------

void write_bytes(g4lidar::bytes data, output& out) {
  out.write({reinterpret_cast<const char*>(data.data()), data.size()});
}

/// What the lidar sent, as it sent it.
void copy_recording(const convert_options& options, output& out) {
  const std::string path = path_of(options.common->source);
  refuse_same_file(id_of_name(path), out);
  auto reader = g4lidar::recording_reader::open(path, options.range);
  if (!reader) throw failure(reader.error());
  progress_bar bar(!our_manners().quiet, reader->size());
  std::uint64_t count = 0;
  while (interrupt() == 0 && !out.is_closed()) {
    const auto got = reader->next();
    if (!got) throw failure(got.error());
    const std::optional<g4lidar::recorded_item>& next = *got;
    if (!next) break;
    const g4lidar::recorded_item& item = *next;
    if (item.what != g4lidar::recorded_item::kind::from_device) continue;
    write_bytes(item.data, out);
    count += item.data.size();
    bar.show(reader->position());
  }
  bar.clear();
  tell(fmt::format("{} bytes from the lidar\n{}", count, words_about(reader->damage())));
}

/// A part of raw bytes, by times that are counted.
void copy_bytes(const convert_options& options, output& out) {
  const std::string path = path_of(options.common->source);
  refuse_same_file(id_of_name(path), out);
  auto line = open_byte_line(path, options.rate_hz);
  if (!line) throw failure(line.error());
  const std::int64_t begin_ns = (*line)->now_ns();
  auto opened = (*line)->connect();
  if (!opened) throw failure(opened.error());
  std::array<std::uint8_t, 32'768> memory;
  while (interrupt() == 0 && !out.is_closed()) {
    const auto got = (*opened)->read(memory, (*opened)->now_ns() + 50'000'000);
    if (!got && got.error().what() == g4lidar::problem::end_of_input) break;
    if (!got) throw failure(got.error());
    const std::int64_t since_ns = got->arrival_ns - begin_ns;
    if (got->count == 0 || since_ns < options.range.from_ns) continue;
    if (since_ns >= options.range.to_ns) break;
    write_bytes(std::span(memory).first(got->count), out);
  }
}

int to_bytes(const convert_options& options, file_form from) {
  output out(options.common->output);
  if (out.is_terminal()) {
    throw failure(exit_code::usage, "raw bytes are nothing for a terminal. Give a file as OUT.");
  }
  from == file_form::recording ? copy_recording(options, out) : copy_bytes(options, out);
  out.commit();
  return exit_code_now();
}

// ---- to recordings ------------------------------------------------------------------------------

[[noreturn]] void refuse_without_packets(const convert_options& options,
                                         const recorded_result& result) {
  const std::string path = path_of(options.common->source);
  input in(path, "Give a recording or raw bytes.");
  std::array<std::uint8_t, 4096> begin;
  text_detector detector;
  detector.look_at(std::span(begin).first(in.read(begin)));
  throw failure(exit_code::bad_file, why_no_packet(result.lidar.stream, result.lidar.bytes,
                                                   detector.is_text(), in.title()));
}

/// A recording that appears in its place when it is finished.
int to_recording(const convert_options& options) {
  const std::string& path = options.common->output;
  if (const auto id = id_of_name(path); id && id == id_of_name(path_of(options.common->source))) {
    throw failure(exit_code::usage, in_quotes(path) + " is what is read, too. Give another name.");
  }
  const std::filesystem::path place = std::filesystem::path(path).parent_path();
  recording_job job;
  job.common = *options.common;
  job.common.count = 0;
  job.source.played.range = options.range;
  job.source.bytes_rate_hz = options.rate_hz;
  job.path = (place / fmt::format(".g4-dump-{}.tmp.mcap", ::getpid())).string();
  job.made = options.made;
  job.title = path;
  std::error_code wrong;
  try {
    const recorded_result result = record(job);
    if (result.lidar.stream.packets == 0 && interrupt() == 0)
      refuse_without_packets(options, result);
    std::filesystem::rename(job.path, path, wrong);
    if (!wrong) {
      tell_counts(result.lidar, reading::points);
      tell(words_about(result.damage));
      tell_recorded(result, path);
    }
  } catch (...) {
    std::error_code unimportant;
    std::filesystem::remove(job.path, unimportant);
    throw;
  }
  if (wrong) {
    throw failure(exit_code::bad_file, fmt::format("cannot replace {}: {}. Give another place.",
                                                   in_quotes(path), wrong.message()));
  }
  return exit_code_now();
}

}  // namespace

int run(const convert_options& options) {
  const file_form from = form_of_input(options);
  const file_form to = form_of_output(options);
  refuse_nonsense(options, from, to);
  if (to == file_form::recording) return to_recording(options);
  if (to == file_form::raw_bytes) return to_bytes(options, from);
  return to_points(options, from, to);
}

}  // namespace g4_dump
