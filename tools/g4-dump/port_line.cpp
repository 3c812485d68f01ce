// SPDX-License-Identifier: MIT
#include "port_line.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace g4_dump {
namespace {

/// A word of its own in a line of words.
std::string cell(std::string text) {
  if (text.empty()) return "-";
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ' ' || c == '\t' || c == '\n'; }, '_');
  return text;
}

std::string usb_id(const g4lidar::port_info& port) {
  if (port.vendor_id == 0) return {};
  return fmt::format("{:04x}:{:04x}", port.vendor_id, port.product_id);
}

const char* bridge(const g4lidar::port_info& port) {
  if (g4lidar::is_g4_bridge(port)) return "g4";
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

std::vector<std::size_t> usual_port_widths() { return {12, 8, 9, 8, 6, 4, 0}; }

std::vector<std::string> port_cells(const g4lidar::port_info& port) {
  return {cell(port.path), cell(port.bus_path),          cell(usb_id(port)), cell(port.driver),
          bridge(port),    port.may_open ? "yes" : "no", cell(port.by_id)};
}

nlohmann::ordered_json port_object(const g4lidar::port_info& port) {
  nlohmann::ordered_json all;
  all["path"] = port.path;
  all["usb"] = text_or_null(port.bus_path);
  all["id"] = text_or_null(usb_id(port));
  all["driver"] = text_or_null(port.driver);
  all["is_g4_bridge"] = g4lidar::is_g4_bridge(port);
  all["may_open"] = port.may_open;
  all["by_id"] = text_or_null(port.by_id);
  all["holder"] = text_or_null(port.holder);
  all["manufacturer"] = text_or_null(port.manufacturer);
  all["product"] = text_or_null(port.product);
  all["usb_serial"] = text_or_null(port.usb_serial);
  return all;
}

std::string line_of(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool is_last = i + 1 == cells.size();
    line +=
        is_last ? cells[i] : fmt::format("{:<{}}  ", cells[i], i < widths.size() ? widths[i] : 0);
  }
  return line + "\n";
}

}  // namespace g4_dump
