// SPDX-License-Identifier: MIT
#include "port_words.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>
#include <vector>

#include "transport/text_file.hpp"

namespace g4lidar {
namespace {

bool is_digits(std::string_view text, std::string_view also = "") noexcept {
  return !text.empty() && std::ranges::all_of(text, [also](char c) {
    return (c >= '0' && c <= '9') || also.find(c) != std::string_view::npos;
  });
}

std::string lowered(std::string_view text) {
  std::string low(text);
  for (char& c : low) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return low;
}

/// `name` without blanks and quotes around it, and with "/" for each "\\".
std::string plain(std::string_view name) {
  constexpr std::string_view around = " \t\"'";
  const std::size_t first = name.find_first_not_of(around);
  if (first == std::string_view::npos) return {};
  std::string text(name.substr(first, name.find_last_not_of(around) + 1 - first));
  std::ranges::replace(text, '\\', '/');
  return text;
}

/// What follows one of `prefixes` in `name`, without slashes before it; empty if none begins it.
template <std::size_t Count>
std::string_view behind(std::string_view name, std::string_view low,
                        const std::array<std::string_view, Count>& prefixes) noexcept {
  for (const std::string_view prefix : prefixes) {
    if (!low.starts_with(prefix)) continue;
    name.remove_prefix(std::min(name.find_first_not_of('/', prefix.size()), name.size()));
    return name;
  }
  return {};
}

/// Not those of a library: "tcp/" is a slip for "tcp:".
constexpr std::array<std::string_view, 12> network_schemes{
    "udp:", "socket:", "rfc2217:", "telnet:", "net:",     "network:",
    "ip:",  "http:",   "https:",   "ws:",     "ser2net:", "tcp/"};
constexpr std::array<std::string_view, 4> port_schemes{"tty:", "device:", "port:", "port="};

/// "10.0.0.2:4000", "robot:4000", "[::1]:4000", "10.0.0.2", "localhost", "robot.local"
bool is_address(std::string_view name) noexcept {
  if (name.find('/') != std::string_view::npos) return false;
  const std::size_t colon = name.rfind(':');
  if (colon == std::string_view::npos) {
    const bool is_number = is_digits(name, ".") && std::ranges::count(name, '.') == 3;
    return is_number || name == "localhost" || (name.ends_with(".local") && name.size() > 6);
  }
  const std::string_view host = name.substr(0, colon);
  const bool is_host = host.find(':') == std::string_view::npos || host.starts_with('[');
  return is_host && !host.empty() && is_digits(name.substr(colon + 1));
}

std::string tcp_name(std::string_view address) {
  while (address.ends_with('/')) address.remove_suffix(1);
  const bool has_port = address.find(':') != std::string_view::npos;
  return std::string(tcp_prefix).append(address).append(has_port ? "" : ":PORT");
}

constexpr std::string_view usual_port = "/dev/ttyUSB0";

/// "COM3", "com12:", "//./COM10", "/dev/cu.usbserial-10": of other systems.
bool is_port_elsewhere(std::string_view low) noexcept {
  if (low.starts_with("//./")) low.remove_prefix(4);
  if (low.starts_with("com")) return is_digits(low.substr(3, low.find(':') - 3));
  if (low.starts_with("/dev/")) low.remove_prefix(5);
  return low.starts_with("cu.") || low.starts_with("tty.");
}

/// Behind "tty" in the names of ports, with a number behind it.
constexpr std::array<std::string_view, 9> kinds_of_ports{"USB", "ACM", "AMA", "THS",  "S",
                                                         "O",   "SC",  "mxc", "XRUSB"};
constexpr std::size_t certain_kind = 3;  // characters that need no "tty"

/// "ttyUSB0" for "TTYusb0", "USB0"; "serial0" for "Serial0"; empty for others.
std::string usual_node(std::string_view node) {
  const std::string low = lowered(node);
  const bool has_tty = low.starts_with("tty");
  const std::string_view rest = std::string_view(low).substr(has_tty ? 3 : 0);
  if (rest.starts_with("serial") && is_digits(rest.substr(6))) return std::string(rest);
  for (const std::string_view kind : kinds_of_ports) {
    if (!has_tty && kind.size() < certain_kind) continue;
    const bool is_kind = rest.starts_with(lowered(kind)) && is_digits(rest.substr(kind.size()));
    if (is_kind) return std::string("tty").append(kind).append(rest.substr(kind.size()));
  }
  return {};
}

/// "ttyUSB0", "/ttyUSB0", "dev/ttyUSB0", "USB0", "/dev/ttyusb0", "ttyUSB0:", "ttyUSB0,230400"; "lidar" where there is a
/// /dev/lidar. Empty if `given` is that already.
std::string port_meant_by(std::string_view name, std::string_view given) {
  std::string node(name);
  std::erase(node, ' ');
  node.erase(0, node.find_first_not_of('/'));
  if (lowered(node).starts_with("dev/")) node.erase(0, node.find_first_not_of('/', 4));
  const std::size_t end = node.find_first_of(":,@");
  if (end != std::string::npos && (end + 1 == node.size() || is_digits(node.substr(end + 1))))
    node.erase(end);  // a baud rate behind it
  if (node.empty()) return {};
  if (node.starts_with("by-id/") || node.starts_with("by-path/")) node.insert(0, "serial/");
  if (!node.starts_with("serial/") && node.find('/') != std::string::npos) return {};
  std::string usual = usual_node(node);
  const std::string path = "/dev/" + (usual.empty() ? node : usual);
  const bool is_known = !usual.empty() || node.starts_with("serial/") ||
                        (node.starts_with("tty") && node.size() > 3) ||
                        ::access(path.c_str(), F_OK) == 0;
  const bool is_new = path != given && (!usual.empty() || !name.starts_with("/dev/"));
  return is_known && is_new ? path : "";
}

struct known_bridge {
  std::uint16_t vendor;
  std::uint16_t product;  // 0: any
  std::string_view name;
};
constexpr std::array<known_bridge, 18> known_bridges{{{0x10c4, 0xea60, "CP2102"},
                                                      {0x10c4, 0xea70, "CP2105"},
                                                      {0x0403, 0x6001, "FT232R"},
                                                      {0x0403, 0x6010, "FT2232"},
                                                      {0x0403, 0x6014, "FT232H"},
                                                      {0x0403, 0x6015, "FT231X"},
                                                      {0x1a86, 0x7523, "CH340"},
                                                      {0x1a86, 0x5523, "CH341"},
                                                      {0x1a86, 0x55d3, "CH343"},
                                                      {0x1a86, 0x55d4, "CH9102"},
                                                      {0x1a86, 0x8010, "WCH-Link"},
                                                      {0x1a86, 0x8012, "WCH-Link"},
                                                      {0x067b, 0, "PL2303"},
                                                      {0x0483, 0x5740, "STM32"},
                                                      {0x0483, 0, "ST-Link"},
                                                      {0x2341, 0, "Arduino"},
                                                      {0x303a, 0, "ESP32"},
                                                      {0x2e8a, 0, "RP2040"}}};

}  // namespace

std::string bridge_of(const port_info& port) {
  if (port.vendor_id == 0) return "UART";
  for (const known_bridge& each : known_bridges) {
    const bool is_it = each.product == 0 || each.product == port.product_id;
    if (each.vendor == port.vendor_id && is_it) return std::string(each.name);
  }
  return port.product.empty() ? "USB" : port.product;
}

bool is_reserved(const port_info& port) {
  const std::string_view name = std::string_view(port.path).substr(port.path.rfind('/') + 1);
  const bool is_terminal = name.starts_with("tty") && is_digits(name.substr(3));  // a screen
  if (name.starts_with("rfcomm") || name == "console" || is_terminal) return true;
  for (const std::string_view login : {"agetty", "getty", "nvgetty", "login", "sulogin"}) {
    if (port.holder.starts_with(login)) return true;
  }
  std::string consoles = " ";
  static_cast<void>(read_text_file("/sys/class/tty/console/active", consoles));
  std::ranges::replace(consoles, '\n', ' ');
  return (consoles + " ").find(" " + std::string(name) + " ") != std::string::npos;
}

std::string meant_by(std::string_view given) {
  if (::access(std::string(given).c_str(), F_OK) == 0) return {};
  const std::string text = plain(given);
  const std::string low = lowered(text);
  const std::string_view name = text;
  for (const std::string_view prefix : {serial_prefix, usb_prefix, tcp_prefix,
                                        std::string_view("file:"), std::string_view("sim:")}) {
    if (!low.starts_with(prefix)) continue;
    const std::string_view rest = name.substr(prefix.size());
    if (!name.starts_with(prefix)) return std::string(prefix).append(rest);
    if (prefix == tcp_prefix && rest.starts_with('/') && !rest.starts_with("//"))
      return tcp_name(rest.substr(1));
    if (prefix != serial_prefix && prefix != usb_prefix) return {};
    const std::string_view port = rest.starts_with("//") ? rest.substr(2) : rest;
    return port.starts_with("/dev/") ? std::string(port) : port_meant_by(port, given);
  }
  if (low == "sim" || low.starts_with("sim?")) return "sim:" + text.substr(3);
  if (const auto address = behind(name, low, network_schemes); !address.empty())
    return tcp_name(address);
  if (const auto port = behind(name, low, port_schemes); !port.empty())
    return port_meant_by(port, given);
  if (is_port_elsewhere(low)) return std::string(usual_port);
  if (std::string port = port_meant_by(name, given); !port.empty()) return port;
  if (is_address(name)) return tcp_name(name);
  if (is_digits(name) && name.size() == 16) return std::string(serial_prefix).append(name);
  const std::size_t dash = name.find('-');
  if (dash != std::string_view::npos && is_digits(name.substr(0, dash)) &&
      is_digits(name.substr(dash + 1), ".")) {
    return std::string(usb_prefix).append(name);
  }
  const bool is_in_quotes = name != given && given.find(name) != std::string_view::npos;
  return is_in_quotes ? text : "";
}

std::optional<error> misspelled(std::string_view name) {
  const std::string meant = meant_by(name);
  if (meant.empty()) return std::nullopt;
  const bool is_scheme = !behind(name, lowered(name), network_schemes).empty();
  const std::string subject = std::string(name.substr(0, 60)) +
                              (is_scheme ? " (not supported; did" : " (did") + " you mean " +
                              meant + "?)";
  return error(task::finding, problem::bad_option, subject, 0, error_detail::bad_name);
}

error no_lidar(std::span<const port_info> others, bool has_looked) {
  std::vector<const port_info*> named;
  for (const port_info& port : others) {
    if (!is_reserved(port)) named.push_back(&port);
  }
  if (named.empty()) return {task::finding, problem::no_port};
  std::ranges::sort(named, {}, [](const port_info* port) {
    return std::pair(port->vendor_id == 0, std::string_view(port->path));
  });
  constexpr std::size_t longest = 150;
  std::string subject = "a lidar (not looked at: ";
  for (const port_info* const port : named) {
    const std::string one =
        (port == named.front() ? "" : "; ") + port->path + ", " + bridge_of(*port);
    if (subject.size() + one.size() > longest) {
      subject += " ...";
      break;
    }
    subject += one;
  }
  const auto why = has_looked ? error_detail::usual : error_detail::other_bridges;
  return {task::finding, problem::no_port, subject + ")", 0, why};
}

}  // namespace g4lidar
