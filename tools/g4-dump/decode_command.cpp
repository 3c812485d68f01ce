// SPDX-License-Identifier: MIT
#include "decode_command.hpp"

#include <span>

#include "byte_points.hpp"
#include "byte_pump.hpp"
#include "exit_code.hpp"
#include "input.hpp"
#include "interrupt.hpp"
#include "output.hpp"
#include "say.hpp"
#include "stats.hpp"

namespace g4_dump {
namespace {

void say_stats(const byte_points& way, stats_format format) {
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
  const auto writer = make_point_writer(options.style);
  byte_points way(*writer, out, options.style.rate_hz);
  text_detector detector;
  byte_sink sink;
  sink.take = [&](std::span<const std::uint8_t> got) {
    detector.look_at(got);
    way.take(got);
  };
  sink.with_bar = options.stats == stats_format::words;
  pump(in, out, sink);
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
