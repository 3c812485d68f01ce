// SPDX-License-Identifier: MIT
// The verb packets: what goes over the line, both ways, in words.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "byte_pump.hpp"
#include "exit_code.hpp"
#include "g4lidar/recording_reader.hpp"
#include "input.hpp"
#include "interrupt.hpp"
#include "line_tap.hpp"
#include "live.hpp"
#include "manners.hpp"
#include "output.hpp"
#include "played_points.hpp"
#include "protocol_log.hpp"
#include "shaped_writer.hpp"
#include "source.hpp"
#include "stats.hpp"
#include "values.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

struct packets_options {
  shared_options common = std::make_shared<common_options>();
  log_style style;
};

std::string path_of(const std::string& source) {
  return source.starts_with("file:") ? source.substr(5) : source;
}

int end() { return interrupt() != 0 ? 128 + interrupt() : static_cast<int>(exit_code::ok); }

void tell_log_counts(const protocol_log& log) {
  tell(stats_in_words(log.counts(), log.bytes_from_device()));
}

int list_bytes(const packets_options& options) {
  const common_options& common = *options.common;
  if (common.time)
    throw bad_value("--time: raw bytes carry no times; lines tell the place instead");
  input in(path_of(common.source),
           "Give a file of bytes as they came from the lidar's port, or pipe them in.");
  output out(common.output, in.id() ? output::appears::whole : output::appears::growing);
  refuse_same_file(in.id(), out);
  log_style style = options.style;
  style.has_times = false;
  style.lines = common.count;
  protocol_log log(style, time_shift(time_style::monotonic, 0), out);
  pump(in, out,
       {.take = [&](std::span<const std::uint8_t> got) { log.from_device(got, 0); },
        .is_done = [&] { return log.is_done(); },
        .duration = common.duration,
        .idle = common.idle,
        .with_bar = !our_manners().quiet});
  if (!log.is_done()) log.finish();  // else what is left was not wanted
  out.commit();
  tell_log_counts(log);
  return end();
}

/// What became of the line, as it stands in a recording.
void remark_on(const g4lidar::line_note& note, protocol_log& log) {
  using enum g4lidar::line_note::kind;
  if (note.what == opened) return log.remark(fmt::format("opened {}", note.line), note.time_ns);
  if (note.what == closed) {
    log.finish();
    return log.remark("closed", note.time_ns);
  }
  if (note.what == gap) {
    log.finish();
    log.remark("bytes are missing from the recording here", note.time_ns);
  }
}

int list_recording(const packets_options& options) {
  const common_options& common = *options.common;
  const std::string path = path_of(common.source);
  auto reader = g4lidar::recording_reader::open(path);
  if (!reader) throw failure(reader.error());
  output out(common.output);
  log_style style = options.style;
  style.lines = common.count;
  const time_style wanted = common.time.value_or(time_style::absolute);
  std::optional<protocol_log> log;
  std::optional<std::int64_t> end_ns;
  while (interrupt() == 0 && !out.is_closed() && !(log && log->is_done())) {
    const auto next = reader->next();
    if (!next) throw failure(next.error());
    const std::optional<g4lidar::recorded_item>& found = *next;
    if (!found) break;
    const g4lidar::recorded_item& item = *found;
    if (!log) {
      log.emplace(style, time_shift(wanted, item.wall_ns - item.time_ns), out);
      if (common.duration.count() > 0) end_ns = item.time_ns + common.duration.count();
    }
    if (end_ns && item.time_ns >= *end_ns) break;
    if (item.what == g4lidar::recorded_item::kind::from_device) {
      log->from_device(item.data, item.time_ns);
    } else if (item.what == g4lidar::recorded_item::kind::to_device) {
      log->to_device(item.data, item.time_ns);
    } else {
      remark_on(item.note, *log);
    }
  }
  if (log && !log->is_done()) log->finish();
  out.commit();
  if (log) tell_log_counts(*log);
  tell(words_about(reader->damage()));
  return end();
}

/// Writes what was heard since the last time.
void write_heard(heard_items& heard, protocol_log& log) {
  for (const heard_item& item : heard) {
    switch (item.what) {
      case heard_item::kind::opened:
        log.remark("opened " + item.line, item.time_ns);
        break;
      case heard_item::kind::closed:
        log.finish();
        log.remark("closed", item.time_ns);
        break;
      case heard_item::kind::from_device:
        log.from_device(item.data, item.time_ns);
        break;
      case heard_item::kind::to_device:
        log.to_device(item.data, item.time_ns);
        break;
    }
  }
  heard.clear();
}

int list_lidar(const packets_options& options) {
  const common_options& common = *options.common;
  output out(common.output, output::appears::growing);
  log_style style = options.style;
  style.lines = common.count;
  protocol_log log(style, time_shift(common.time.value_or(time_style::absolute), wall_ahead_ns()),
                   out);
  heard_items heard;
  live_sink sink;
  sink.points = [](std::span<const g4lidar::point>) { return std::uint64_t{0}; };
  sink.pulse = [&] { write_heard(heard, log); };
  sink.is_done = [&] { return log.is_done(); };
  try {
    opened_source source(common, {}, [&heard](std::unique_ptr<g4lidar::connector> lines) {
      return tapped(std::move(lines), heard);
    });
    run_live(source.lidar(), common, sink, out);
  } catch (const failure&) {  // what went over the line tells why
    write_heard(heard, log);
    log.finish();
    out.commit();
    if (log.bytes_from_device() > 0) tell_log_counts(log);
    throw;
  }
  write_heard(heard, log);
  if (!log.is_done()) log.finish();
  out.commit();
  tell_log_counts(log);
  return end();
}

int run(const packets_options& options) {
  switch (kind_of(options.common->source)) {
    case source_kind::bytes:
      return list_bytes(options);
    case source_kind::recording:
      return list_recording(options);
    default:
      return list_lidar(options);
  }
}

constexpr const char* details =
    R"(Each line has a time (seconds; of raw bytes, which carry none, the place of the first byte), a mark
and words. Marks: > to the lidar, < from it, ! what could not be read or is suspect, with its
reason: noise (single bytes are sent by healthy lidars, too), bad header, bad checksum, truncated;
- what became of the line. Commands and what was skipped show their first 16 bytes, --hex all bytes
of everything in lines of their own. Of raw bytes only one way is there.
A lidar is opened, started and stopped as dump does it; what was said before a failure is written,
too. -n counts lines.)";

option_row flag(const std::string& name, const std::string& help,
                const std::shared_ptr<packets_options>& options, bool log_style::* which) {
  return {.names = name, .value = "", .help = help, .take = [options, which](const std::string&) {
            options->style.*which = true;
          }};
}

}  // namespace

verb make_packets_verb() {
  const auto options = std::make_shared<packets_options>();
  verb made;
  made.name = "packets";
  made.summary = "What goes over the line, both ways, in words";
  made.arguments.push_back(source_argument(options->common));
  made.options.push_back(output_row(options->common));
  made.options.push_back(flag("--hex", "All bytes of everything", options, &log_style::hex));
  made.options.push_back(
      flag("--errors", "Only what was skipped or is suspect", options, &log_style::errors));
  append(made.options, ending_rows(options->common));
  for (option_row& row : shape_rows(options->common)) {
    if (row.names == "--time") made.options.push_back(std::move(row));
  }
  append(made.options, device_rows(options->common));
  made.details = details;
  made.examples = {"g4-dump packets -n 20", "g4-dump packets sim: --hex -d 1s",
                   "g4-dump packets walk.bin --errors"};
  made.run = [options] { return run(*options); };
  return made;
}

}  // namespace g4_dump
