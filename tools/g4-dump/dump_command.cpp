// SPDX-License-Identifier: MIT
// The verbs dump and scan: points, or whole revolutions, of any source.
#include <memory>
#include <string>

#include "common_options.hpp"
#include "decode_command.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "live.hpp"
#include "output.hpp"
#include "point_writer.hpp"
#include "source.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

struct dump_options {
  shared_options common = std::make_shared<common_options>();
  point_style style{.format = text_format::text};
};

/// Raw bytes tell no times: they are counted, as decode does.
int dump_bytes(const dump_options& options) {
  decode_options as_bytes;
  as_bytes.input = options.common->source;
  as_bytes.output = options.common->output;
  as_bytes.style = options.style;
  return run(as_bytes);
}

int dump(const dump_options& options) {
  const common_options& common = *options.common;
  if (kind_of(common.source) == source_kind::bytes) return dump_bytes(options);
  output out(common.output);
  opened_source source(common);
  const auto writer = make_point_writer(options.style);
  writer->begin(out);
  live_sink sink;
  if (writer->takes_scans()) {
    sink.scan = [&](const g4lidar::scan& scan) {
      writer->write_scan(scan, out);
      return std::uint64_t{1};
    };
  }
  sink.points = [&](std::span<const g4lidar::point> points) {
    writer->write_points(points, out);
    return points.size();
  };
  run_live(source.lidar(), common, sink, out);
  out.commit();
  tell_counts(source.lidar());
  return interrupt() != 0 ? 128 + interrupt() : static_cast<int>(exit_code::ok);
}

verb make(const std::string& name, bool scans) {
  const auto options = std::make_shared<dump_options>();
  options->style.scans = scans;
  verb made;
  made.name = name;
  made.arguments.push_back(source_argument(options->common));
  made.options.push_back(output_row(options->common));
  made.options.push_back({.names = "-f,--format",
                          .value = "csv|jsonl|text",
                          .help = "How to write (text)",
                          .take =
                              [options](const std::string& word) {
                                options->style.format =
                                    choice_of<text_format>(word, {{"csv", text_format::csv},
                                                                  {"jsonl", text_format::jsonl},
                                                                  {"text", text_format::text}});
                              },
                          .complete = completion::choices});
  append(made.options, ending_rows(options->common));
  append(made.options, filter_rows(options->common));
  append(made.options, shape_rows(options->common));
  append(made.options, device_rows(options->common));
  made.run = [options] { return dump(*options); };
  return made;
}

}  // namespace

verb make_dump_verb() {
  verb made = make("dump", false);
  made.summary = "Points (the verb that may be left out)";
  made.examples = {"g4-dump", "g4-dump -n 1000 -f csv -o points.csv",
                   "g4-dump dump sim: -d 2s -f jsonl"};
  return made;
}

verb make_scan_verb() {
  verb made = make("scan", true);
  made.summary = "Whole revolutions";
  made.examples = {"g4-dump scan -n 5", "g4-dump scan sim:?seed=7 -d 3s -f csv"};
  return made;
}

}  // namespace g4_dump
