// SPDX-License-Identifier: MIT
// The verb list: the serial ports, and with --probe who is behind them.
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "exit_code.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/serial_port.hpp"
#include "interrupt.hpp"
#include "manners.hpp"
#include "output.hpp"
#include "port_line.hpp"
#include "talk.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

struct list_options {
  shared_options common = std::make_shared<common_options>();
  std::shared_ptr<bool> json = std::make_shared<bool>(false);
  bool probe = false;
  bool all = false;  ///< Ask at other ports, too.
};

/// A port, and what has come of asking there, if that was done.
struct listed_port {
  g4lidar::port_info port;
  std::optional<g4lidar::device_information> device{};
  std::optional<g4lidar::error> problem{};
};

g4lidar::result<g4lidar::device_information> ask_at(const g4lidar::port_info& port,
                                                    std::uint32_t baud) {
  using enum g4lidar::problem;
  // Programs that do not lock a port would be disturbed.
  if (!port.holder.empty()) {
    return g4lidar::failure(g4lidar::task::opening, busy, port.path + ", held by " + port.holder);
  }
  auto line = g4lidar::serial_port::open(port.path, {.baud = baud});
  if (!line) return tl::unexpected(line.error());
  const auto longest = g4lidar::find_options{}.probe_timeout;
  return g4lidar::probe(**line, (*line)->now_ns() + std::chrono::nanoseconds(longest).count());
}

void probe(std::vector<listed_port>& ports, const list_options& options) {
  for (listed_port& each : ports) {
    if (!options.all && !g4lidar::is_g4_bridge(each.port)) continue;
    if (interrupt() != 0) throw interrupted();
    const auto device = ask_at(each.port, options.common->baud);
    if (device) {
      each.device = *device;
    } else {
      each.problem = device.error();
      tell(device.error().message() + "\n");
    }
  }
}

std::string firmware_of(const g4lidar::device_information& device) {
  return std::to_string(device.firmware_major) + "." + std::to_string(device.firmware_minor);
}

std::vector<std::string> cells_of(const listed_port& listed, bool probed) {
  std::vector<std::string> cells = port_cells(listed.port);
  if (probed && listed.device) {
    cells.insert(cells.end(),
                 {"g4", std::string(listed.device->serial_number()), firmware_of(*listed.device)});
  } else if (probed) {
    const std::string answer = listed.problem ? std::string(name_of(listed.problem->what())) : "-";
    cells.insert(cells.end(), {answer, "-", "-"});
  }
  cells.push_back(listed.port.holder.empty() ? "-" : listed.port.holder);
  return cells;
}

void write_table(const std::vector<listed_port>& ports, bool probed, output& out) {
  std::vector<std::vector<std::string>> rows{port_columns()};
  if (probed) rows[0].insert(rows[0].end(), {"ANSWER", "SERIAL", "FIRMWARE"});
  rows[0].emplace_back("HOLDER");
  for (const listed_port& each : ports) rows.push_back(cells_of(each, probed));
  std::vector<std::size_t> widths(rows[0].size());
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const auto& row : rows) out.write(line_of(row, widths));
}

nlohmann::ordered_json object_of(const listed_port& listed) {
  nlohmann::ordered_json all = port_object(listed.port);
  all["device"] = nullptr;
  all["problem"] = nullptr;
  if (const auto& device = listed.device) {
    all["device"] = {{"model", device->model},
                     {"serial", std::string(device->serial_number())},
                     {"firmware", firmware_of(*device)},
                     {"hardware", device->hardware}};
  }
  if (const auto& problem = listed.problem) {
    all["problem"] = {{"name", name_of(problem->what())}, {"message", problem->message()}};
  }
  return all;
}

/// 0 where there is what was looked for; else why there is not.
int verdict_on(const std::vector<listed_port>& ports, bool probed) {
  const auto is_bridge = [](const listed_port& each) { return g4lidar::is_g4_bridge(each.port); };
  const auto answered = [](const listed_port& each) { return each.device.has_value(); };
  const bool found = probed ? std::any_of(ports.begin(), ports.end(), answered)
                            : std::any_of(ports.begin(), ports.end(), is_bridge);
  if (found) return static_cast<int>(exit_code::ok);
  for (const listed_port& each : ports) {
    if (is_bridge(each) && each.problem) return static_cast<int>(exit_code_for(*each.problem));
  }
  tell(ports.empty() ? "There is no serial port.\n" : "No serial port is behind a G4's bridge.\n");
  return static_cast<int>(exit_code::no_device);
}

int list(const list_options& options) {
  output out(options.common->output);
  auto found = g4lidar::list_ports();
  if (!found) throw failure(found.error());
  g4lidar::find_holders(*found);
  std::vector<listed_port> ports;
  for (g4lidar::port_info& port : *found) ports.push_back({.port = std::move(port)});
  const bool probed = options.probe || options.all;
  if (probed) probe(ports, options);
  if (*options.json) {
    for (const listed_port& each : ports) write_line(out, object_of(each));
  } else if (!ports.empty()) {
    write_table(ports, probed, out);
  }
  out.commit();
  return verdict_on(ports, probed);
}

constexpr const char* details =
    R"(A line for each serial port, ordered by PATH:

  PATH      of the port
  USB       its place on the bus, which SOURCE takes as usb:1-1.4
  ID        USB vendor and product
  DRIVER    of the kernel
  BRIDGE    g4: a CP2102 as it comes with a G4 (and with much else); other; - for no USB device
  OPEN      whether this user may open it
  BY-ID     the link that udevd has made
  ANSWER    with --probe: g4, or what was wrong (busy, silence, ...); - where nobody was asked
  SERIAL    with --probe: the lidar's own number, which SOURCE takes as serial:NUMBER
  FIRMWARE  with --probe
  HOLDER    who has it open, as far as this user may see that; the only column with blanks in it

What is not known is -. With --json an object a port, with path, usb, id, driver, is_g4_bridge,
may_open, by_id, holder, manufacturer, product, usb_serial, device (model, serial, firmware,
hardware) and problem (name, message); what is not known is null.

--probe asks at each G4's bridge that nobody holds; a lidar found scanning is stopped by that.
Other ports are written to with --all only. Where no port is, nothing is written but a word on
standard error. Exits with 3 where there is no G4's bridge; with --probe, where no G4 has answered,
with what the first bridge came to.)";

}  // namespace

verb make_list_verb() {
  const auto options = std::make_shared<list_options>();
  verb made;
  made.name = "list";
  made.summary = "Serial ports, and which of them is a G4";
  made.options.push_back({.names = "--probe",
                          .value = "",
                          .help = "Ask at each G4's bridge who is there",
                          .take = [options](const std::string&) { options->probe = true; }});
  made.options.push_back({.names = "--all",
                          .value = "",
                          .help = "Ask at every port: two commands go to whatever is there",
                          .take = [options](const std::string&) { options->all = true; }});
  made.options.push_back(json_row(options->json));
  made.options.push_back(output_row(options->common));
  made.options.push_back(baud_row(options->common));
  made.details = details;
  made.examples = {"g4-dump list", "g4-dump list --probe", "g4-dump list --json"};
  made.exits = {0, 2, 3, 4, 5, 6, 7, 8, 10, 130};
  made.run = [options] { return list(*options); };
  return made;
}

}  // namespace g4_dump
