// SPDX-License-Identifier: MIT
#include "command_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>

#include "cli/logger.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "io/output.hpp"

namespace g4_tool {
namespace {

/// In this time the slowest lidar sends a packet.
constexpr std::int64_t listen_ns = 60'000'000;

/// Whether a packet arrives. Errors are left to the driver, which reports them.
bool hears_packet(transport& port, sample_format samples, std::int64_t deadline_ns) {
  stream_parser parser(samples);
  std::array<std::uint8_t, 1024> buffer;
  bool found = false;
  while (!found && port.now_ns() < deadline_ns) {
    const auto got = port.read(buffer, deadline_ns);
    if (!got || got->count == 0) return false;
    parser.feed(bytes(buffer).first(got->count), [&found](const event& what) {
      found = found || std::holds_alternative<packet_view>(what);
    });
  }
  return found;
}

/// Options that wait for a packet before anything is sent. The driver alone would report a scan only if
/// it receives a whole packet before the device obeys its stop.
lidar_options listening(bool& heard) {
  lidar_options how;
  how.wrap = [&heard](std::unique_ptr<connector> from) {
    const g4lidar::model* const which = from->traits().model;
    const sample_format samples = which != nullptr ? which->samples : g4_format;
    return for_each_connection([&heard, samples](std::unique_ptr<transport> port) {
      if (hears_packet(*port, samples, port->now_ns() + listen_ns)) heard = true;
      return port;
    })(std::move(from));
  };
  return how;
}

}  // namespace

void refuse_files(const common_options& options, task doing) {
  const source_kind kind = kind_of_source(options.source);
  if (kind == source_kind::device || kind == source_kind::simulated) return;
  throw failure(error(doing, problem::read_only, options.source));
}

command_source::command_source(const common_options& options, task doing)
    : source_((refuse_files(options, doing), options), listening(was_scanning_)) {
  while (const auto event = lidar().next_event()) {
    was_scanning_ = was_scanning_ || event->what == lidar_event::kind::found_scanning;
  }
  // A one-way lidar always scans, and nothing stops it.
  was_scanning_ = was_scanning_ && source_.model().link == g4lidar::link_kind::two_way;
  if (was_scanning_)
    logger::info(fmt::format("{}: was scanning and has been stopped\n", lidar().name()));
}

verb device_verb(verb made, exit_code (*run)(const common_options&), bool has_output) {
  const auto options = std::make_shared<common_options>();
  made.arguments = {source_argument(*options)};
  if (has_output) made.options = joined(json_row(*options), output_rows(*options));
  made.options = joined(made.options, device_rows(*options));
  made.run = [options, run] { return static_cast<int>(run(*options)); };
  return made;
}

void write_object(output& out, const nlohmann::ordered_json& value, std::size_t width,
                  bool as_json) {
  if (as_json) return out.write(json_line(value));
  const nlohmann::ordered_json all = value.flatten();
  for (const auto& [path, each] : all.items()) {
    std::string name = path.substr(1);
    std::replace(name.begin(), name.end(), '/', '_');
    const std::string text = each.is_string() ? printable(each.get<std::string>()) : each.dump();
    out.write(fmt::format("{:<{}}{}\n", name, width, each.is_null() ? "unknown" : text));
  }
}

}  // namespace g4_tool
