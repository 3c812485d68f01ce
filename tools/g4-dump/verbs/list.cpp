// SPDX-License-Identifier: MIT
// The verb list: the serial ports, and with --probe the devices attached to them.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/setting_words.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/transport/serial_port.hpp"
#include "io/command_source.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/port_row.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

struct list_options {
  common_options common;
  bool probe = false;
  bool all = false;  ///< Also probe ports without the bridge of a G4.
  bool models = false;
};

/// A port and, if it was probed, the result.
struct listed_port {
  port_info port;
  std::optional<result<recognised_lidar>> answer{};
};

result<recognised_lidar> ask_at(const port_info& port, std::uint32_t baud) {
  using enum g4lidar::problem;
  // Probing would disturb a program that has not locked the port.
  if (!port.holder.empty()) {
    return g4lidar::failure(task::opening, busy, port.path + ", held by " + port.holder);
  }
  auto opened = serial_port::open(port.path, {.baud = baud != 0 ? baud : g4_model.bauds[0]});
  if (!opened) return tl::unexpected(opened.error());
  const auto longest = find_options{}.probe_timeout;
  return search(**opened, (*opened)->now_ns() + std::chrono::nanoseconds(longest).count(),
                {.baud = baud, .is_cancelled = [] { return interrupt() != 0; }});
}

void probe(std::vector<listed_port>& ports, const list_options& options) {
  for (listed_port& each : ports) {
    const bool is_probed = is_g4_bridge(each.port) || (options.all && !is_reserved(each.port));
    if (!is_probed) continue;
    const auto& answer = each.answer.emplace(ask_at(each.port, options.common.expected.baud));
    if (interrupt() != 0) throw interrupted();
    if (!answer) logger::info(in_tool_words(answer.error().message()) + "\n");
  }
}

/// The other models that send the same: "x2l,x3"; "-" if there is none.
std::string other_words(const recognised_lidar& lidar) {
  std::string all;
  for (const model* each : lidar.candidates) {
    if (*each == *lidar.model) continue;
    all.append(all.empty() ? "" : ",").append(each->word);
  }
  return all.empty() ? "-" : all;
}

std::vector<std::string> cells_of(const listed_port& listed, bool probed) {
  const auto& [port, answer] = listed;
  std::vector<std::string> cells = port_cells(port);
  if (answer && *answer) {
    const recognised_lidar& lidar = **answer;
    const bool is_known = lidar.device.model != 0;
    cells.insert(cells.end(), {std::string(lidar.model->word),
                               is_known ? std::string(lidar.device.serial_number()) : "-",
                               is_known ? firmware_of(lidar.device) : "-",
                               std::to_string(lidar.baud), other_words(lidar)});
  } else if (probed) {
    cells.insert(cells.end(),
                 {answer ? std::string(name_of(answer->error().code())) : "-", "-", "-", "-", "-"});
  }
  cells.push_back(port.holder.empty() ? "-" : printable(port.holder));
  return cells;
}

void write_rows(const std::vector<std::vector<std::string>>& rows, output& out) {
  std::vector<std::size_t> widths(rows[0].size());
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const auto& row : rows) out.write(line_of(row, widths));
}

void write_table(const std::vector<listed_port>& ports, bool probed, output& out) {
  std::vector<std::vector<std::string>> rows{port_columns()};
  if (probed) rows[0].insert(rows[0].end(), {"ANSWER", "SERIAL", "FIRMWARE", "BAUD", "OR"});
  rows[0].emplace_back("HOLDER");
  for (const listed_port& each : ports) rows.push_back(cells_of(each, probed));
  write_rows(rows, out);
}

/// The table of models.
void write_models(bool as_json, output& out) {
  std::vector<std::vector<std::string>> rows(1);
  for (const model& each : models) {
    nlohmann::ordered_json object;
    auto& row = rows.emplace_back();
    for (const auto& [name, text] : facts_of(each)) {
      if (&each == models.data()) rows[0].emplace_back(name);
      row.push_back(text);
      object[std::string(name)] = text;
    }
    if (as_json) out.write(json_line(object));
  }
  if (!as_json) write_rows(rows, out);
}

nlohmann::ordered_json object_of(const listed_port& listed) {
  const auto& [port, answer] = listed;
  nlohmann::ordered_json all = port_object(port);
  all["device"] = nullptr;
  all["lidar"] = nullptr;
  if (answer && *answer) {
    const recognised_lidar& lidar = **answer;
    if (lidar.device.model != 0) all["device"] = json_of(std::optional(lidar.device));
    all["lidar"] = json_of(lidar.candidates);
    all["lidar"]["baud"] = lidar.baud;
  }
  all["problem"] = nullptr;
  if (answer && !*answer) {
    all["problem"] = {{"name", name_of(answer->error().code())},
                      {"message", in_tool_words(answer->error().message())}};
  }
  return all;
}

/// 0 if a lidar (without probing: the bridge of a G4) was found; else the reason.
exit_code verdict_on(const std::vector<listed_port>& ports, bool probed) {
  const bool found = std::any_of(ports.begin(), ports.end(), [probed](const listed_port& each) {
    return probed ? each.answer && *each.answer : is_g4_bridge(each.port);
  });
  if (found) return exit_code::ok;
  for (const auto& [port, answer] : ports) {
    if (is_g4_bridge(port) && answer) return exit_code_for(answer->error());
  }
  logger::info(ports.empty() ? "no serial port found\n"
                             : "no serial port has the USB bridge of a lidar (10c4:ea60)\n");
  return exit_code::no_device;
}

std::vector<listed_port> ports_with_holders() {
  auto found = value_of(list_ports());
  find_holders(found);
  std::vector<listed_port> ports;
  ports.reserve(found.size());
  for (port_info& port : found) ports.push_back({.port = std::move(port)});
  return ports;
}

int list(const list_options& options) {
  output out(options.common.output);
  if (options.models) {
    write_models(options.common.json, out);
    out.commit();
    return static_cast<int>(exit_code::ok);
  }
  std::vector<listed_port> ports = ports_with_holders();
  const bool probed = options.probe || options.all;
  if (probed) probe(ports, options);
  if (options.common.json) {
    for (const listed_port& each : ports) out.write(json_line(object_of(each)));
  } else if (!ports.empty()) {
    write_table(ports, probed, out);
  }
  out.commit();
  return static_cast<int>(verdict_on(ports, probed));
}

constexpr const char* list_details =
    R"(A line for each serial port, sorted by PATH; unknown values are -:

  PATH, USB  the port, and its place on the USB bus; as SOURCE: usb:1-1.4
  ID         USB vendor and product
  DRIVER     kernel driver
  BRIDGE     g4: a CP2102, as in a G4, an X4 and many other devices; other; -: not a USB device
  OPEN       whether this user may open it
  BY-ID      the link made by udev
  ANSWER     with --probe: the model (g4, x4, ...), or the problem (busy, silence, ...); -: not
             probed
  SERIAL     with --probe: serial number of the lidar; as SOURCE: serial:NUMBER
  FIRMWARE   with --probe
  BAUD       with --probe: baud rate of the lidar
  OR         with --probe: other models that send the same bytes; name yours with --model
  HOLDER     the process that has it open, if this user may see it; may contain blanks

With --json: an object for each port, with path, usb, id, driver, is_g4_bridge, may_open, by_id,
holder, manufacturer, product, usb_serial, device (model, serial, firmware, hardware), lidar
(model, baud, candidates) and problem (name, message); unknown values are null.

--probe listens at each port with such a bridge that no process has open. Where it is silent,
it asks with two bytes, at each baud rate that lidars have; --baud: at this one only. It stops a
lidar that is scanning, if that has commands. It takes at most 4 s a port. The exit code is 3 if
no port has that bridge; with --probe, if no lidar was found, that of the problem at the first
such port.)";

}  // namespace

void write_ports(output& out) {
  const std::vector<listed_port> ports = ports_with_holders();
  if (ports.empty()) return out.write("no serial port found\n");
  write_table(ports, false, out);
}

int print_overview() {
  output out("-");
  std::vector<listed_port> ports = ports_with_holders();
  std::erase_if(ports, [](const listed_port& each) { return !is_g4_bridge(each.port); });
  if (ports.empty()) {
    out.write("No serial port has the USB bridge of a lidar. A simulated one: g4-dump view sim:\n");
  } else {
    out.write("Ports with the USB bridge of a lidar (g4-dump list --probe asks who answers):\n\n");
    write_table(ports, false, out);
  }
  out.write("\nCommands (g4-dump COMMAND --help explains one, g4-dump --help the sources):\n\n");
  for (const verb& each : all_verbs()) {
    out.write(fmt::format("  {:<9} {}\n", each.name, each.summary));
  }
  out.commit();
  return static_cast<int>(exit_code::ok);
}

verb make_list_verb() {
  const auto options = std::make_shared<list_options>();
  return {
      .name = "list",
      .summary = "List serial ports and the lidars attached to them",
      .options = joined(
          flag_row("--probe", "Search a lidar at each port with such a bridge", options->probe),
          flag_row("--all", "Query every port but consoles: sends bytes to any device",
                   options->all),
          flag_row("--models", "List the models that can be read, and no ports", options->models),
          json_row(options->common), output_rows(options->common),
          rows_of("Device", {"baud"}, options->common.expected)),
      .details = list_details,
      .examples = {{"g4-dump list", "The serial ports"},
                   {"g4-dump list --probe", "The lidars, their models and baud rates"}},
      .exits = {0, 2, 3, 4, 5, 6, 7, 8, 10, 11, 130},
      .run = [options] { return list(*options); }};
}

}  // namespace g4_tool
