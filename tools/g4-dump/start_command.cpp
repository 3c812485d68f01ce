// SPDX-License-Identifier: MIT
// The verbs start, stop and restart. What start has begun goes on when it has ended.
#include <fmt/format.h>

#include <chrono>
#include <memory>

#include "exit_code.hpp"
#include "interrupt.hpp"
#include "live.hpp"
#include "manners.hpp"
#include "talk.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

/// Longer than the session tries to bring a scan about.
constexpr auto longest_start = 12s;

/// A device with too little power confirms the start and dies of it, perhaps behind its first points.
void wait_for_revolution(g4lidar::lidar& lidar) {
  const auto end = clock::now() + longest_start;
  while (interrupt() == 0) {
    const auto got = lidar.next_scan(100ms);
    if (got) return;
    if (got.error().is_fatal() || clock::now() > end) throw failure(got.error());
  }
  throw interrupted();
}

int start(const common_options& options) {
  talking_source source(options, g4lidar::task::starting);
  g4lidar::lidar& lidar = source.lidar();
  if (const auto started = lidar.start(); !started) throw failure(started.error());
  wait_for_revolution(lidar);
  tell_events(lidar);
  tell(fmt::format("{}: scanning\n", lidar.name()));
  lidar.release();
  return static_cast<int>(exit_code::ok);
}

int stop(const common_options& options) {
  talking_source source(options, g4lidar::task::stopping);  // which has stopped it
  if (!source.was_scanning()) {
    tell(fmt::format("{}: stopped; it was not heard scanning\n", source.lidar().name()));
  }
  return static_cast<int>(exit_code::ok);
}

int restart(const common_options& options) {
  talking_source source(options, g4lidar::task::asking);
  g4lidar::lidar& lidar = source.lidar();
  const auto begin = clock::now();
  const auto restarted = lidar.ask(g4lidar::requests::restart());
  if (!restarted) throw failure(restarted.error());
  const std::chrono::duration<double> took = clock::now() - begin;
  tell(
      fmt::format("{}: restarted; it answers again after {:.1f} s. It may have forgotten what was "
                  "set.\n",
                  lidar.name(), took.count()));
  return static_cast<int>(exit_code::ok);
}

verb make(const char* name, int (*run)(const common_options&)) {
  const auto options = std::make_shared<common_options>();
  verb made;
  made.name = name;
  made.arguments.push_back(source_argument(options));
  append(made.options, device_rows(options));
  made.examples = {fmt::format("g4-dump {}", name), fmt::format("g4-dump {} /dev/ttyUSB0", name)};
  made.exits = talk_exits();
  made.run = [options, run] { return run(*options); };
  return made;
}

}  // namespace

verb make_start_verb() {
  verb made = make("start", start);
  made.summary = "Let it scan, and leave it so";
  made.details =
      R"(Ends when a whole revolution has come, and the device goes on scanning. Under power-down
protection it stops by itself 3 s later, since nobody feeds it. Nothing is set.)";
  return made;
}

verb make_stop_verb() {
  verb made = make("stop", stop);
  made.summary = "Stop whatever it is doing";
  made.details = "Ends when the line is silent. That it was not scanning is no error.";
  return made;
}

verb make_restart_verb() {
  verb made = make("restart", restart);
  made.summary = "Let it boot, and wait until it answers";
  made.details = "It does not scan afterwards, and may have forgotten what was set.";
  return made;
}

}  // namespace g4_dump
