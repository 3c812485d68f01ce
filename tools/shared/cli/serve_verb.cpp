// SPDX-License-Identifier: MIT
#include "serve_verb.hpp"

#include <utility>

#include "option_rows.hpp"

namespace g4_tool {
namespace {

constexpr const char* serve_details =
    R"(Open http://localhost:8765/ in a browser: the radar, rates and losses, what the doctor finds, the
settings, and for a recording a time line. Foxglove connects to ws://localhost:8765/ and gets
/scan (LaserScan), /points (PointCloud2) and /diagnostics (DiagnosticArray).

Only programs of this machine can connect, unless --address is given: 0.0.0.0 for all networks.
There is no password and no encryption. Web pages of other origins are refused, but those of
--allow-origin, such as https://app.foxglove.dev. The settings of the lidar can be changed only
with --allow-set, and pages can record into a directory only with --allow-record.

Several lidars on one robot have names, and are joined into one scan in the frame of the robot:
front=/dev/ttyUSB0 rear=/dev/ttyUSB1 --merge --mount front=0.2,0,0 --mount rear=-0.2,0,180. The page
can show each of them in a colour of its own.

The web page draws all points in the robot's frame: x ahead, y left.)";

std::string origin_of(const std::string& word) {
  const std::size_t colon = word.find("://");
  if (colon == std::string::npos || colon == 0 || word.find('/', colon + 3) != std::string::npos) {
    throw bad_value("'" + word + "' is not an origin such as https://app.foxglove.dev");
  }
  return word;
}

option_rows server_rows(serve_options& options) {
  option_row origin{
      "--allow-origin", "ORIGIN",
      "A web page of others that may connect: https://HOST; may be repeated",
      [&into = options.origins](const std::string& word) { into.push_back(origin_of(word)); }};
  origin.repeatable = true;
  return in_group(
      "Server",
      {number_row("--port", "PORT", "TCP port; 0: any free one (8765)", options.port,
                  std::uint16_t{0}, std::uint16_t{65535}),
       value_row("--address", "ADDRESS", "Listen at this address of the machine (127.0.0.1)",
                 options.address,
                 [](const std::string& word) {
                   return word == "localhost" ? std::string("127.0.0.1") : word;
                 }),
       flag_row("--allow-set", "Let clients change the settings of the lidar", options.allows_set),
       text_row("--allow-record", "DIRECTORY", "Let pages record into this directory",
                options.record_directory, completion::output),
       value_row("--record-limit", "SIZE", "Of all recordings in this directory (4G)",
                 options.record_limit, byte_count_of),
       origin});
}

option_rows scan_rows(serve_options& options) {
  return in_group(
      "Scans",
      {frame_row("--frame", "Of --fov and --ignore; vendor: clockwise from 0 of the lidar (robot)",
                 options.common.frame),
       row_of("deskew", options.common.deskew), merge_row(options.merges),
       named_mount_row(options.mounts), row_of("grid", options.bins),
       text_row("--frame-id", "NAME", "For Foxglove (laser; base_link of merged scans)",
                options.frame_id, completion::nothing)});
}

}  // namespace

std::string frame_id_of(const serve_options& options) {
  if (!options.frame_id.empty()) return options.frame_id;
  return options.merges ? "base_link" : "laser";
}

verb make_serve_verb(std::string name, const std::function<int(const serve_options&)>& run) {
  const auto options = std::make_shared<serve_options>();
  const std::string command = name == "serve" ? "g4-dump serve" : name;
  return {
      .name = std::move(name),
      .summary = "Show the lidar in a web page, and to Foxglove",
      .arguments = {named_source_arguments(
          options->sources,
          "The lidar, a recording, raw bytes, or sim:; NAME=SOURCE (the only lidar)")},
      .options =
          joined(server_rows(*options), device_rows(options->common), filter_rows(options->common),
                 near_row(options->common.marks.near), scan_rows(*options),
                 grid_rows(options->common.grid), player_rows(options->speed, options->loops),
                 in_group("End condition", {duration_row(options->common)})),
      .details = serve_details,
      .examples = {{command, "Serve the only lidar at http://localhost:8765/"},
                   {command + " walk.mcap --loop --port 8000", "Play a recording, again and again"},
                   {command + " front=/dev/ttyUSB0 rear=/dev/ttyUSB1 --merge "
                              "--mount front=0.2,0,0 --mount rear=-0.2,0,180",
                    "Join two lidars into one scan"},
                   {command + " --address 0.0.0.0 --allow-set",
                    "For all machines of the network, which may change settings"}},
      .run = [options, run] { return run(*options); }};
}

}  // namespace g4_tool
