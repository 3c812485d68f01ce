// SPDX-License-Identifier: MIT
// The verbs that send one command to a device: health, start, stop and restart.
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "cli/logger.hpp"
#include "io/command_source.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/read_loop.hpp"
#include "verbs/verbs.hpp"

namespace g4_tool {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

/// Longer than the session tries to start a scan.
constexpr auto longest_start = 40s;

exit_code health(const common_options& options) {
  output out(options.output);
  command_source source(options, task::asking);
  const auto given = value_of(source.lidar().ask(requests::health()));
  nlohmann::ordered_json all{{"source", source.lidar().name()},
                             {"status", g4lidar::name_of(given.status)},
                             {"error_code", given.error_code}};
  if (!options.json) all.erase("source");
  write_object(out, all, 12, options.json);
  out.commit();
  return given.status == health_status::error ? exit_code::unhealthy : exit_code::ok;
}

/// A device with too little power may confirm the start and fail after its first points.
void wait_for_revolution(g4lidar::lidar& lidar) {
  const auto end = clock::now() + longest_start;
  while (interrupt() == 0) {
    const auto got = lidar.next_scan(100ms);
    if (got) return;
    if (got.error().is_fatal() || clock::now() > end) throw failure(got.error());
  }
  throw interrupted();
}

exit_code start(const common_options& options) {
  command_source source(options, task::starting);
  g4lidar::lidar& lidar = source.lidar();
  value_of(lidar.start());
  wait_for_revolution(lidar);
  report_events(lidar);
  logger::info(fmt::format("{}: scanning\n", lidar.name()));
  lidar.release();
  return exit_code::ok;
}

exit_code stop(const common_options& options) {
  command_source source(options, task::stopping);  // its constructor stops the device
  if (source.candidates().front()->link == g4lidar::link_kind::one_way) {
    logger::info(fmt::format("{}: this model has no commands: its scan cannot be stopped\n",
                             source.lidar().name()));
  } else if (!source.was_scanning()) {
    logger::info(fmt::format("{}: stopped; it was not scanning\n", source.lidar().name()));
  }
  return exit_code::ok;
}

exit_code restart(const common_options& options) {
  command_source source(options, task::asking);
  const auto begin = clock::now();
  value_of(source.lidar().ask(requests::restart()));
  const std::chrono::duration<double> took = clock::now() - begin;
  logger::info(fmt::format("{}: restarted; it answered after {:.1f} s. Its settings may be lost.\n",
                           source.lidar().name(), took.count()));
  return exit_code::ok;
}

}  // namespace

verb make_health_verb() {
  return device_verb(
      {.name = "health",
       .summary = "Print the health status",
       .details =
           R"(Two lines: status (ok, warning, error) and error_code. The meaning of the bits of the code is
not documented. The exit code is 8 if the status is error. A device that is scanning is stopped
first; that is reported.)",
       .examples = {{"g4-dump health", "Health of the only lidar"},
                    {"g4-dump health 'sim:?fault=health=warning'",
                     "A simulated G4 with a warning"}}},
      health, true);
}

verb make_start_verb() {
  return device_verb(
      {.name = "start",
       .summary = "Start scanning",
       .details =
           R"(The command ends when a whole revolution has arrived; the device continues to scan. With power-down
protection the device stops 3 s later, because no program sends keep-alives. No setting is
changed.)",
       .examples = {{"g4-dump start", "Start the only lidar"},
                    {"g4-dump start /dev/ttyUSB0", "Start the one at this port"}}},
      start);
}

verb make_stop_verb() {
  return device_verb({.name = "stop",
                      .summary = "Stop scanning",
                      .details = "The command ends when the device is silent. It is no error if "
                                 "the device was not scanning.",
                      .examples = {{"g4-dump stop", "Stop the only lidar"}}},
                     stop);
}

verb make_restart_verb() {
  return device_verb(
      {.name = "restart",
       .summary = "Restart the device and wait until it answers",
       .details = "It does not scan after the restart, and its settings may be lost.",
       .examples = {{"g4-dump restart", "Restart the only lidar"}}},
      restart);
}

}  // namespace g4_tool
