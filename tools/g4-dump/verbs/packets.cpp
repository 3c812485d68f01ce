// SPDX-License-Identifier: MIT
// The verb packets: the bytes between host and lidar, both ways, as text.
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "export/protocol_log.hpp"
#include "g4lidar/core/wall_clock.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/transport/transport.hpp"
#include "io/far_times.hpp"
#include "io/input.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/read_loop.hpp"
#include "io/source_word.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

struct packets_options {
  shared_options common = std::make_shared<common_options>();
  protocol_log_style style;
  bool is_model_known = true;
};

/// The style for packets of `model`.
protocol_log_style style_for(protocol_log_style style, const g4lidar::model& model) {
  style.format = model.samples;
  return style;
}

void end(protocol_log& log, output& out) {
  if (!log.is_done()) log.finish();
  out.commit();
  logger::info(stats_in_words(log.counts(), log.bytes_from_device()));
}

void list_bytes(const packets_options& options) {
  const common_options& common = *options.common;
  if (common.time)
    throw bad_value("--time: raw bytes carry no times; lines begin with the offset of the bytes");
  input in(path_of_source(common.source),
           "Give a file of raw bytes from the lidar's port, or pipe them in.");
  output out(common.output, in.is_file() ? output::appears::whole : output::appears::growing);
  protocol_log_style style = options.style;
  if (!options.is_model_known) {
    const recognised_model found = in.recognise(common);
    report_model(found);
    style = style_for(style, *found.which);
  }
  protocol_log log(style, time_shift(time_style::monotonic, 0), out);
  in.pump(out,
          {.take = [&](std::span<const std::uint8_t> got) { log.from_device(got, 0); },
           .is_done = [&] { return log.is_done(); }},
          common);
  if (log.bytes_from_device() == 0 && in.is_file() && interrupt() == 0)
    throw without_packets({}, 0, {}, in.title());
  end(log, out);
}

/// Logs an event of the transport in a recording.
void log_event(const recorded_event& event, protocol_log& log) {
  using enum recorded_event::kind;
  if (event.what == opened) return log.remark(fmt::format("opened {}", event.name), event.time_ns);
  if (event.what != closed && event.what != gap) return;
  log.finish();
  log.remark(event.what == closed ? "closed" : "bytes are missing from the recording here",
             event.time_ns);
}

void list_recording(const packets_options& options) {
  const common_options& common = *options.common;
  const std::string path = path_of_source(common.source);
  output out(common.output);
  const time_style wanted = common.time.value_or(time_style::absolute);
  std::optional<protocol_log> log;
  std::optional<std::int64_t> end_ns;
  const auto reader = read_items(path, {}, [&](const recorded_item& item) {
    if (item.what == recorded_item::kind::odometry) return true;
    if (!log) {
      log.emplace(options.style, time_shift(wanted, way_ns(item.time_ns, item.wall_ns)), out);
      if (common.duration.count() > 0) end_ns = sum_ns(item.time_ns, common.duration.count());
    }
    if (end_ns && item.time_ns >= *end_ns) return false;
    if (item.what == recorded_item::kind::from_device) {
      log->from_device(item.data, item.time_ns);
    } else if (item.what == recorded_item::kind::to_device) {
      log->to_device(item.data, item.time_ns);
    } else {
      log_event(item.other, *log);
    }
    return !out.is_closed() && !log->is_done();
  });
  log ? end(*log, out) : out.commit();
  logger::info(describe(reader.damage()));
}

/// Logs the bytes, the opening and the closing of a connection.
class logged_transport final : public forwarding_transport {
 public:
  logged_transport(std::unique_ptr<transport> inner, protocol_log& log)
      : forwarding_transport(std::move(inner)), log_(log) {
    log_.remark(fmt::format("opened {}", name()), now_ns());
  }
  logged_transport(const logged_transport&) = delete;
  logged_transport& operator=(const logged_transport&) = delete;
  ~logged_transport() override {
    log_.finish();
    log_.remark("closed", inner().now_ns());
  }

  [[nodiscard]] result<received> read(std::span<std::uint8_t> into,
                                      std::int64_t deadline_ns) noexcept override {
    auto got = inner().read(into, deadline_ns);
    if (got && got->count > 0) log_.from_device(into.first(got->count), got->arrival_ns);
    return got;
  }
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    auto done = inner().write(data, deadline_ns);
    if (done) log_.to_device(data, now_ns());
    return done;
  }

 private:
  protocol_log& log_;
};

void list_lidar(const packets_options& options) {
  const common_options& common = *options.common;
  output out(common.output, output::appears::growing);
  // Lines are stored and written later, because a transport must not throw if a file is full.
  std::string lines;
  callback_sink kept([&](std::string_view text) { lines += text; });
  const time_style wanted = common.time.value_or(time_style::absolute);
  std::unique_ptr<protocol_log> log;
  const g4lidar::model* logged = nullptr;
  const auto begin = [&](const g4lidar::model& model) {
    if (log && *logged == model) return;
    if (log) log->finish();
    logged = &model;
    log = std::make_unique<protocol_log>(style_for(options.style, model),
                                         time_shift(wanted, wall_clock().ahead().count()), kept);
  };
  begin(g4_model);  // if nothing can be opened
  const auto write = [&] {
    kept.flush();
    out.write(lines);
    lines.clear();
  };
  read_sink sink;
  sink.points = [](std::span<const point>) {};
  sink.pulse = write;
  sink.is_done = [&] { return log->is_done(); };
  try {
    lidar_options how;
    how.wrap = [&](std::unique_ptr<connector> from) {
      const g4lidar::model* const which = from->traits().recognised.model;
      begin(which != nullptr ? *which : g4_model);
      return for_each_connection([&](auto port) {
        return std::make_unique<logged_transport>(std::move(port), *log);
      })(std::move(from));
    };
    opened_source source(common, how);
    read_source(source, common, sink, out);
  } catch (const failure&) {  // the received bytes may show the cause
    write();
    log->bytes_from_device() > 0 ? end(*log, out) : out.commit();
    throw;
  }
  write();
  end(*log, out);
}

int run(packets_options options) {
  const source_kind kind = kind_of_source(options.common->source);
  options.style.lines = options.common->count;
  const g4lidar::model* const which = model_of(*options.common);
  options.is_model_known = which != nullptr;
  if (kind == source_kind::raw_bytes || kind == source_kind::recording)
    refuse_zero_angle(*options.common, "packets prints the angles that were sent");
  if (which != nullptr) options.style = style_for(options.style, *which);
  options.style.has_times = kind != source_kind::raw_bytes;
  const auto list = kind == source_kind::raw_bytes   ? list_bytes
                    : kind == source_kind::recording ? list_recording
                                                     : list_lidar;
  list(options);
  return exit_code_now();
}

constexpr const char* packets_details =
    R"(A line has a time in seconds (raw bytes have none: the offset of the first byte), a symbol and
a description. Symbols:
  >  sent to the lidar
  <  sent by the lidar
  !  not readable or suspect, with the reason: noise (healthy lidars send single bytes, too),
     bad header, bad checksum, truncated
  -  event of the connection

Lines for commands and skipped bytes show the first 16 bytes; --hex shows all bytes of
everything. What was exchanged before a failure is written, too. -n counts lines.)";

}  // namespace

verb make_packets_verb() {
  const auto options = std::make_shared<packets_options>();
  common_options& common = *options->common;
  protocol_log_style& style = options->style;
  return {
      .name = "packets",
      .summary = "Print commands, responses and packets, both ways",
      .arguments = {source_argument(common)},
      .options = joined(
          output_rows(common), flag_row("--hex", "Show all bytes", style.hex),
          flag_row("--errors", "Show only skipped bytes and suspect packets", style.errors),
          ending_rows(common), in_group("Output form", {time_row(common)}), device_rows(common)),
      .details = packets_details,
      .examples = {{"g4-dump packets -n 20", "The first 20 lines of the only lidar"},
                   {"g4-dump packets sim: --hex -d 1s", "All bytes of a simulated G4"},
                   {"g4-dump packets walk.bin --errors",
                    "The bytes of a file that cannot be read"}},
      .run = [options] { return run(*options); }};
}

}  // namespace g4_tool
