// SPDX-License-Identifier: MIT
// The verbs that send one command to a device: health, start, stop and restart.
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/logger.hpp"
#include "io/command_source.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/read_loop.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

/// Longer than the session tries to start a scan.
constexpr auto longest_start = 40s;

/// What the CT bytes of a one-way lidar report; nothing if no revolution has such bytes with the right CRC.
std::optional<g4lidar::health> reported_health(g4lidar::lidar& lidar) {
  constexpr int revolutions = 5;
  value_of(lidar.start());
  std::optional<g4lidar::health> found;
  for (int i = 0; i < revolutions && !found; ++i) {
    if (const auto scan = lidar.wait_scan(2s); !scan) throw failure(scan.error());
    const auto given = lidar.ask(requests::health());
    if (given) {
      found = *given;
    } else if (given.error() != g4lidar::problem::not_supported) {
      throw failure(given.error());
    }
  }
  value_of(lidar.stop());
  return found;
}

exit_code health(const common_options& options) {
  output out(options.output);
  command_source source(options, task::asking);
  const bool is_asked = source.candidates().front()->link == g4lidar::link_kind::two_way &&
                        !options.expected.listen_only;
  const auto given = !is_asked ? reported_health(source.lidar())
                               : std::optional(value_of(source.lidar().ask(requests::health())));
  report_contradictions(source.lidar().recognition());
  nlohmann::ordered_json all{
      {"source", source.lidar().name()}, {"status", nullptr}, {"error_code", nullptr}};
  if (given) {
    all["status"] = g4lidar::name_of(given->status);
    all["error_code"] = given->error_code;
  }
  if (!options.json) all.erase("source");
  write_object(out, all, 12, options.json);
  out.commit();
  const bool is_bad = given && given->status == health_status::error;
  return is_bad ? exit_code::unhealthy : exit_code::ok;
}

/// A device with too little power may confirm the start and fail after its first points.
void wait_for_revolution(g4lidar::lidar& lidar) {
  const auto end = clock::now() + longest_start;
  while (interrupt() == 0) {
    const auto got = lidar.try_scan(100ms);
    if (got) return;
    if (got.error().is_fatal() || clock::now() > end) throw failure(got.error());
  }
  throw interrupted();
}

exit_code start(const common_options& options) {
  refuse_listening(options);
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
  refuse_listening(options);
  command_source source(options, task::stopping);  // its constructor stops the device
  const g4lidar::model& which = *source.candidates().front();
  if (which.link == g4lidar::link_kind::one_way) {
    const bool is_by_line = which.motor == g4lidar::motor_kind::dtr;
    logger::info(fmt::format("{}: this model has no commands: {}\n", source.lidar().name(),
                             is_by_line ? "it rests while no program has the port open, if the "
                                          "connection has the line DTR"
                                        : "its scan cannot be stopped"));
  } else if (source.lidar().recognition().is_silent) {
    logger::info(fmt::format("{}: it answers no command: its scan cannot be stopped\n",
                             source.lidar().name()));
  } else if (!source.was_scanning()) {
    logger::info(fmt::format("{}: stopped; it was not scanning\n", source.lidar().name()));
  }
  return exit_code::ok;
}

exit_code restart(const common_options& options) {
  refuse_listening(options);
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
first; that is reported. A one-way lidar is not asked: it reports its health in the CT bytes of its
packets. Where these are missing, or their CRC does not fit, both lines are unknown, with --json
null, and the exit code is 0.)",
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
protection the device stops 3 s later, because no program sends keep-alives. Where the line DTR
drives the motor, the line stays high. No setting is changed.)",
       .examples = {{"g4-dump start", "Start the only lidar"},
                    {"g4-dump start /dev/ttyUSB0", "Start the one at this port"}}},
      start);
}

verb make_stop_verb() {
  return device_verb({.name = "stop",
                      .summary = "Stop scanning",
                      .details = "The command ends when the device is silent. It is no error if "
                                 "the device was not scanning.\nWhere the line DTR drives the "
                                 "motor, the line is low at the end.",
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
