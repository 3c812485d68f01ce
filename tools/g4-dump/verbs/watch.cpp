// SPDX-License-Identifier: MIT
// The verb watch: reports serial ports that are plugged and unplugged.
#include <fmt/chrono.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/discovery.hpp"
#include "io/command_source.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/port_row.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

constexpr auto poll_interval = 500ms;

/// "2026-11-21T21:50:21.123Z"
std::string now_as_text() {
  const auto ms = std::chrono::floor<std::chrono::milliseconds>(std::chrono::system_clock::now());
  return fmt::format("{:%FT%T}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(ms)),
                     ms.time_since_epoch().count() % 1000);
}

using known_ports = std::map<std::string, port_info>;  // by their paths

known_ports ports_now() {
  known_ports ports;
  for (port_info& port : value_of(list_ports())) ports.emplace(port.path, std::move(port));
  return ports;
}

class watcher {
 public:
  watcher(const common_options& options, output& out) : options_(options), out_(out) {
    auto monitor = port_monitor::open();
    if (monitor) monitor_.emplace(std::move(*monitor));
    polls_ = !monitor_ || ::access("/run/udev/control", F_OK) != 0;
    if (polls_) logger::info("udevd is not running: the ports are checked every 500 ms\n");
    known_ = ports_now();
    if (!options_.json) write_row("TIME", "EVENT", port_columns());
    out_.flush();
  }

  void run() {
    while (interrupt() == 0 && !out_.is_closed() && !has_enough() && !limits_.is_over()) {
      const int heard = monitor_ ? monitor_->native_handle() : -1;
      const auto until = polls_ ? std::min(next_poll_, limits_.end()) : limits_.end();
      const wake woken = wait_for_input(heard, out_.descriptor(), until);
      if (woken == wake::output_closed) out_.close_early();
      while (auto event = monitor_ ? monitor_->next() : std::nullopt) {
        apply(event->plugged, std::move(event->port));
        next_poll_ = clock::now() + poll_interval;  // udevd may still change the port
      }
      if (polls_ && clock::now() >= next_poll_) poll_ports();
      out_.flush();
    }
  }

 private:
  [[nodiscard]] bool has_enough() const { return options_.count > 0 && printed_ >= options_.count; }

  /// Compares the ports with those known.
  void poll_ports() {
    next_poll_ = clock::now() + poll_interval;
    const known_ports there = ports_now();
    for (const auto& [path, port] : known_ports(known_)) {
      const auto now = there.find(path);
      if (now == there.end() || now->second.bus_path != port.bus_path) apply(false, port);
    }
    for (const auto& [path, port] : there) apply(true, port);
  }

  /// Reports a change, unless it is already known.
  void apply(bool plugged, port_info port) {
    if (known_.contains(port.path) == plugged || has_enough()) return;
    if (!plugged) port.may_open = false;
    write(plugged ? "plugged" : "unplugged", port);
    ++printed_;
    if (plugged) {
      known_[port.path] = port;
    } else {
      known_.erase(port.path);
    }
  }

  void write(const char* what, const port_info& port) {
    if (!options_.json) return write_row(now_as_text(), what, port_cells(port));
    nlohmann::ordered_json all{{"time", now_as_text()}, {"event", what}};
    all.update(port_object(port));
    out_.write(json_line(all));
  }

  /// Uses widths that suit most ports, because later lines are unknown.
  void write_row(const std::string& time, const char* what, std::vector<std::string> cells) {
    cells.insert(cells.begin(), {time, what});
    out_.write(line_of(cells, {24, 9, 12, 8, 9, 8, 6, 4, 0}));
  }

  const common_options& options_;
  output& out_;
  std::optional<port_monitor> monitor_;
  bool polls_ = false;  // lists the ports periodically
  known_ports known_;
  std::uint64_t printed_ = 0;
  time_limits limits_{options_.duration, std::chrono::nanoseconds(0)};
  clock::time_point next_poll_ = clock::now();
};

int watch(const common_options& options) {
  output out(options.output);
  watcher(options, out).run();
  out.commit();
  return exit_code_now();
}

constexpr const char* watch_details =
    R"(A line for each serial port that is plugged or unplugged from now on: TIME (UTC), EVENT
(plugged, unplugged), and PATH, USB, ID, DRIVER, BRIDGE, OPEN and BY-ID as in g4-dump list. With
--json an object for each event, with time, event, and the keys that g4-dump list --json has for a
port. No port is opened. Without udevd, as in most containers, the ports are also checked every
500 ms.)";

}  // namespace

verb make_watch_verb() {
  const auto options = std::make_shared<common_options>();
  return {
      .name = "watch",
      .summary = "Report ports as they are plugged and unplugged",
      .options = joined(json_row(*options), output_rows(*options), ending_rows(*options, false)),
      .details = watch_details,
      .examples = {{"g4-dump watch", "Report until ^C"},
                   {"g4-dump watch -n 1 --json", "Wait for one event"}},
      .exits = {0, 2, 10, 11, 130},
      .run = [options] { return watch(*options); }};
}

}  // namespace g4_tool
