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

/// What follows "udp:" and the like, without "//".
std::string_view address_in(std::string_view name, std::string_view low) noexcept {
  constexpr std::array<std::string_view, 8> schemes{
      "udp:", "socket:", "rfc2217:", "telnet:", "net:", "network:", "ip:", "http:"};
  for (const std::string_view scheme : schemes) {
    if (!low.starts_with(scheme)) continue;
    name.remove_prefix(scheme.size());
    return name.starts_with("//") ? name.substr(2) : name;
  }
  return {};
}

/// "10.0.0.2:4000", "robot:4000", "[::1]:4000", "10.0.0.2"
bool is_address(std::string_view name) noexcept {
  if (name.find('/') != std::string_view::npos) return false;
  const std::size_t colon = name.rfind(':');
  if (colon == std::string_view::npos) {
    return is_digits(name, ".") && std::ranges::count(name, '.') == 3;
  }
  const std::string_view host = name.substr(0, colon);
  const bool is_host = host.find(':') == std::string_view::npos || host.starts_with('[');
  return is_host && !host.empty() && is_digits(name.substr(colon + 1));
}

std::string tcp_name(std::string_view address) {
  const bool has_port = address.find(':') != std::string_view::npos;
  return std::string(tcp_prefix).append(address).append(has_port ? "" : ":PORT");
}

/// "ttyUSB0", "/ttyUSB0", "dev/ttyUSB0", "lidar" where there is a /dev/lidar.
std::string port_meant_by(std::string_view name) {
  std::string_view node = name.starts_with('/') ? name.substr(1) : name;
  if (node.starts_with("dev/")) node.remove_prefix(4);
  if (node.empty() || node.find('/') != std::string_view::npos || name.starts_with("/dev/"))
    return {};
  std::string path = "/dev/" + std::string(node);
  const bool is_usual = (node.starts_with("tty") && node.size() > 3) ||
                        (node.starts_with("serial") && is_digits(node.substr(6)));
  return is_usual || ::access(path.c_str(), F_OK) == 0 ? path : "";
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

std::string meant_by(std::string_view name) {
  const std::string given(name);
  if (::access(given.c_str(), F_OK) == 0) return {};
  const std::string low = lowered(name);
  for (const std::string_view prefix : {serial_prefix, usb_prefix, tcp_prefix,
                                        std::string_view("file:"), std::string_view("sim:")}) {
    if (!low.starts_with(prefix)) continue;
    const std::string_view rest = name.substr(prefix.size());
    if (!name.starts_with(prefix)) return std::string(prefix).append(rest);
    const bool is_port = prefix == serial_prefix || prefix == usb_prefix;
    if (is_port && rest.starts_with("/dev/")) return std::string(rest);
    return is_port ? port_meant_by(rest) : "";
  }
  if (low == "sim" || low.starts_with("sim?")) return "sim:" + given.substr(3);
  if (const std::string_view address = address_in(name, low); !address.empty()) {
    return tcp_name(address);
  }
  const std::string_view windows =
      low.starts_with("\\\\.\\com") ? std::string_view(low).substr(4) : low;
  if (windows.starts_with("com") && is_digits(windows.substr(3, windows.find(':') - 3))) {
    return "/dev/ttyUSB0";
  }
  if (is_address(name)) return tcp_name(name);
  if (is_digits(name) && name.size() == 16) return std::string(serial_prefix).append(name);
  const std::size_t dash = name.find('-');
  if (dash != std::string_view::npos && is_digits(name.substr(0, dash)) &&
      is_digits(name.substr(dash + 1), ".")) {
    return std::string(usb_prefix).append(name);
  }
  return port_meant_by(name);
}

std::optional<error> misspelled(std::string_view name) {
  const std::string meant = meant_by(name);
  if (meant.empty()) return std::nullopt;
  const bool is_scheme = !address_in(name, lowered(name)).empty();
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
