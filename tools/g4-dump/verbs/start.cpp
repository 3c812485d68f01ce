// SPDX-License-Identifier: MIT
// The verb start: the device goes on scanning after it.
#include <fmt/format.h>

#include <chrono>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "io/command_source.hpp"
#include "io/interrupt.hpp"
#include "io/read_loop.hpp"
#include "verbs/verbs.hpp"

namespace g4_tool {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

/// Longer than the session tries to start a scan.
constexpr auto longest_start = 40s;

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

}  // namespace

verb make_start_verb() {
  return device_verb(
      {.name = "start",
       .summary = "Start scanning",
       .details =
           R"(The command ends when a whole revolution has arrived; the device continues to scan. With power-down
protection the device stops 3 s later, because no program sends keep-alives. No setting is
changed.)",
       .examples = {{"g4-dump start", "Start the only G4"},
                    {"g4-dump start /dev/ttyUSB0", "Start the one at this port"}}},
      start);
}

}  // namespace g4_tool
