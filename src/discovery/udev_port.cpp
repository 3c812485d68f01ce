// SPDX-License-Identifier: MIT
#include "udev_port.hpp"

#include <unistd.h>

#include <charconv>
#include <string_view>
#include <utility>

#include "transport/directory.hpp"

namespace g4lidar {
namespace {

std::string text_or_empty(const char* text) { return text != nullptr ? text : ""; }

std::uint16_t hexadecimal(const std::string& digits) noexcept {
  std::uint16_t value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  return value;
}

std::string_view file_name(std::string_view path) noexcept {
  return path.substr(path.rfind('/') + 1);
}

/// Looked up at the path where udevd creates it, and not in its data base, which a container may
/// lack.
std::string by_id_link(const std::string& node) {
  const std::string links = "/dev/serial/by-id/";
  std::string found;
  each_entry(links, [&](std::string_view name) {
    std::string link = links + std::string(name);
    if (file_name(link_target(link)) == file_name(node)) found = std::move(link);
  });
  return found;
}

/// Of the device or of its parent: a tty itself has none.
std::string driver_of(udev_device* device) {
  for (; device != nullptr; device = udev_device_get_parent(device)) {
    if (const char* driver = udev_device_get_driver(device)) return driver;
  }
  return {};
}

/// ttyS4 and similar: names that the kernel reserves for hardware that does not exist.
bool is_empty_place(udev_device* device) noexcept {
  const char* type = udev_device_get_sysattr_value(device, "type");
  return type != nullptr && std::string_view(type) == "0";
}

}  // namespace

bool may_open(const std::string& path) noexcept { return ::access(path.c_str(), R_OK | W_OK) == 0; }

std::optional<port_info> port_of(udev_device* device) {
  const std::string path = text_or_empty(udev_device_get_devnode(device));
  udev_device* carrier = udev_device_get_parent(device);  // belongs to `device`
  if (path.empty() || carrier == nullptr || is_empty_place(device)) return std::nullopt;
  port_info port;
  port.path = path;
  port.by_id = by_id_link(path);
  port.driver = driver_of(carrier);
  udev_device* usb = udev_device_get_parent_with_subsystem_devtype(device, "usb", "usb_device");
  if (usb == nullptr) return port;
  // From sysfs, which has it with and without udevd.
  port.bus_path = text_or_empty(udev_device_get_sysname(usb));
  const auto attribute_of = [&](const char* attribute) {
    return text_or_empty(udev_device_get_sysattr_value(usb, attribute));
  };
  port.vendor_id = hexadecimal(attribute_of("idVendor"));
  port.product_id = hexadecimal(attribute_of("idProduct"));
  port.usb_serial = attribute_of("serial");
  port.manufacturer = attribute_of("manufacturer");
  port.product = attribute_of("product");
  return port;
}

}  // namespace g4lidar
