// SPDX-License-Identifier: MIT
#include "port_row.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/logger.hpp"

namespace g4_tool {
namespace {

/// A word without blanks.
std::string cell(std::string text) {
  if (text.empty()) return "-";
  std::ranges::replace_if(text, [](char c) { return c == ' ' || c == '\t' || c == '\n'; }, '_');
  return printable(text);
}

std::string usb_id(const port_info& port) {
  if (port.vendor_id == 0) return {};
  return fmt::format("{:04x}:{:04x}", port.vendor_id, port.product_id);
}

const char* bridge(const port_info& port) {
  if (is_g4_bridge(port)) return "g4";
  return port.vendor_id == 0 ? "-" : "other";
}

nlohmann::ordered_json text_or_null(const std::string& text) {
  if (text.empty()) return nullptr;
  return text;
}

}  // namespace

std::vector<std::string> port_columns() {
  return {"PATH", "USB", "ID", "DRIVER", "BRIDGE", "OPEN", "BY-ID"};
}

std::vector<std::string> port_cells(const port_info& port) {
  return {cell(port.path), cell(port.bus_path),          cell(usb_id(port)), cell(port.driver),
          bridge(port),    port.may_open ? "yes" : "no", cell(port.by_id)};
}

nlohmann::ordered_json port_object(const port_info& port) {
  return {{"path", port.path},
          {"usb", text_or_null(port.bus_path)},
          {"id", text_or_null(usb_id(port))},
          {"driver", text_or_null(port.driver)},
          {"is_g4_bridge", is_g4_bridge(port)},
          {"may_open", port.may_open},
          {"by_id", text_or_null(port.by_id)},
          {"holder", text_or_null(port.holder)},
          {"manufacturer", text_or_null(port.manufacturer)},
          {"product", text_or_null(port.product)},
          {"usb_serial", text_or_null(port.usb_serial)}};
}

std::string line_of(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths) {
  std::string line;
  for (std::size_t i = 0; i + 1 < cells.size(); ++i) {
    line += fmt::format("{:<{}}  ", cells[i], widths[i]);
  }
  return line + cells.back() + "\n";
}

}  // namespace g4_tool
