// SPDX-License-Identifier: MIT
// The verb watch: ports that come and go, as they do.
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "exit_code.hpp"
#include "g4lidar/discovery.hpp"
#include "interrupt.hpp"
#include "manners.hpp"
#include "output.hpp"
#include "port_line.hpp"
#include "talk.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

using namespace std::chrono_literals;
using clock = std::chrono::steady_clock;

constexpr auto look_time = 500ms;

struct watch_options {
  shared_options common = std::make_shared<common_options>();
  std::shared_ptr<bool> json = std::make_shared<bool>(false);
};

/// "2026-11-21T21:50:21.123Z"
std::string now_as_text() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  const auto ms = std::chrono::floor<std::chrono::milliseconds>(since);
  const auto seconds =
      static_cast<std::time_t>(std::chrono::floor<std::chrono::seconds>(ms).count());
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", parts.tm_year + 1900,
                     parts.tm_mon + 1, parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec,
                     static_cast<int>((ms % 1s).count()));
}

class watcher {
 public:
  watcher(const watch_options& options, output& out) : options_(options), out_(out) {
    auto monitor = g4lidar::port_monitor::open();
    if (monitor) monitor_.emplace(std::move(*monitor));
    looks_ = !monitor_ || ::access("/run/udev/control", F_OK) != 0;
    if (looks_) {
      tell("No udevd tells of ports here: they are looked at every 500 ms, too.\n");
    }
    for (g4lidar::port_info& port : ports()) known_.emplace(port.path, std::move(port));
    if (!*options_.json) {
      std::vector<std::string> header = port_columns();
      header.insert(header.begin(), {"TIME", "EVENT"});
      out_.write(line_of(header, widths()));
      out_.flush();
    }
  }

  void run() {
    while (!is_over()) {
      wait();
      while (auto event = monitor_ ? monitor_->next() : std::nullopt) {
        apply(event->plugged, std::move(event->port));
        next_look_ = clock::now() + look_time;  // what is told is not settled everywhere yet
      }
      if (looks_ && clock::now() >= next_look_) look();
      out_.flush();
    }
  }

 private:
  [[nodiscard]] bool is_over() const {
    const common_options& common = *options_.common;
    return interrupt() != 0 || nobody_reads_ || out_.is_closed() ||
           (common.count > 0 && told_ >= common.count) ||
           (common.duration.count() > 0 && clock::now() - begin_ >= common.duration);
  }

  void wait() {
    const int heard = monitor_ ? monitor_->native_handle() : -1;
    std::array<pollfd, 3> waiting{
        {{heard, POLLIN, 0}, {interrupt_handle(), POLLIN, 0}, {out_.descriptor(), 0, 0}}};
    const auto now = clock::now();
    auto left = std::chrono::hours(24) + 0ns;
    if (looks_) left = std::min<std::chrono::nanoseconds>(left, next_look_ - now);
    const auto duration = options_.common->duration;
    if (duration.count() > 0) left = std::min(left, begin_ + duration - now);
    const auto ms = std::chrono::ceil<std::chrono::milliseconds>(left);
    ::poll(waiting.data(), waiting.size(), static_cast<int>(std::max(ms, 0ms).count()));
    nobody_reads_ = (waiting[2].revents & (POLLERR | POLLHUP)) != 0;
  }

  [[nodiscard]] static std::vector<g4lidar::port_info> ports() {
    auto found = g4lidar::list_ports();
    if (!found) throw failure(found.error());
    return *std::move(found);
  }

  /// Holds what is there against what was.
  void look() {
    next_look_ = clock::now() + look_time;
    std::map<std::string, g4lidar::port_info> there;
    for (g4lidar::port_info& port : ports()) there.emplace(port.path, std::move(port));
    std::vector<g4lidar::port_info> gone;
    for (const auto& [path, port] : known_) {
      const auto now = there.find(path);
      const bool is_same = now != there.end() && now->second.bus_path == port.bus_path;
      if (!is_same) gone.push_back(port);
    }
    for (g4lidar::port_info& port : gone) apply(false, std::move(port));
    for (auto& [path, port] : there) apply(true, std::move(port));
  }

  /// Tells of it, unless that is known already.
  void apply(bool plugged, g4lidar::port_info port) {
    if (known_.contains(port.path) == plugged) return;
    if (options_.common->count > 0 && told_ >= options_.common->count) return;
    if (!plugged) port.may_open = false;
    write(plugged ? "plugged" : "unplugged", port);
    ++told_;
    if (plugged) {
      std::string path = port.path;
      known_.emplace(std::move(path), std::move(port));
    } else {
      known_.erase(port.path);
    }
  }

  void write(const char* what, const g4lidar::port_info& port) {
    if (*options_.json) {
      nlohmann::ordered_json all;
      all["time"] = now_as_text();
      all["event"] = what;
      all.update(port_object(port));
      return write_line(out_, all);
    }
    std::vector<std::string> cells = port_cells(port);
    cells.insert(cells.begin(), {now_as_text(), what});
    out_.write(line_of(cells, widths()));
  }

  static std::vector<std::size_t> widths() {
    std::vector<std::size_t> all = usual_port_widths();
    all.insert(all.begin(), {24, 9});
    return all;
  }

  const watch_options& options_;
  output& out_;
  std::optional<g4lidar::port_monitor> monitor_;
  bool looks_ = false;  // since nobody may tell
  std::map<std::string, g4lidar::port_info> known_;
  bool nobody_reads_ = false;
  std::uint64_t told_ = 0;
  clock::time_point begin_ = clock::now();
  clock::time_point next_look_ = begin_;
};

int watch(const watch_options& options) {
  output out(options.common->output);
  watcher(options, out).run();
  out.commit();
  return interrupt() != 0 ? 128 + interrupt() : static_cast<int>(exit_code::ok);
}

constexpr const char* details =
    R"(A line for each serial port that comes or goes from now on: TIME (UTC), EVENT (plugged, unplugged),
and PATH, USB, ID, DRIVER, BRIDGE, OPEN and BY-ID as list has them. With --json an object an event,
with time, event, and the keys that list --json has for a port.

Nothing is opened. Where no udevd runs, as in most containers, the ports are also looked at every
500 ms; that is told. Ends with ^C, after -n events, or after -d.)";

}  // namespace

verb make_watch_verb() {
  const auto options = std::make_shared<watch_options>();
  verb made;
  made.name = "watch";
  made.summary = "Ports that come and go";
  made.options.push_back(json_row(options->json));
  made.options.push_back(output_row(options->common));
  for (option_row& row : ending_rows(options->common)) {
    if (row.names != "--idle") made.options.push_back(std::move(row));
  }
  made.details = details;
  made.examples = {"g4-dump watch", "g4-dump watch -n 1 --json", "g4-dump watch -d 10min"};
  made.exits = {0, 2, 10, 130};
  made.run = [options] { return watch(*options); };
  return made;
}

}  // namespace g4_dump
