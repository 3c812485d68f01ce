// SPDX-License-Identifier: MIT
#include "udev_port.hpp"

#include <unistd.h>

#include <charconv>
#include <string_view>

namespace g4lidar {
namespace {

std::string text_or_empty(const char* text) { return text != nullptr ? text : ""; }

/// What udevd knows under this name, else what sysfs does.
std::string property_or_attribute(udev_device* device, const char* property, udev_device* parent,
                                  const char* attribute) {
  const char* known = udev_device_get_property_value(device, property);
  if (known == nullptr && parent != nullptr) {
    known = udev_device_get_sysattr_value(parent, attribute);
  }
  return text_or_empty(known);
}

std::uint16_t hexadecimal(const std::string& digits) noexcept {
  std::uint16_t value = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  return value;
}

std::string by_id_link(udev_device* device) {
  udev_list_entry* link = udev_device_get_devlinks_list_entry(device);
  for (; link != nullptr; link = udev_list_entry_get_next(link)) {
    std::string name = text_or_empty(udev_list_entry_get_name(link));
    if (name.starts_with("/dev/serial/by-id/")) return name;
  }
  return {};
}

/// Of the device, or of what it hangs on: a tty itself has none.
std::string driver_of(udev_device* device) {
  for (; device != nullptr; device = udev_device_get_parent(device)) {
    if (const char* driver = udev_device_get_driver(device)) return driver;
  }
  return {};
}

/// ttyS4 and its like: the kernel keeps a name for hardware that nobody has found.
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
  port.by_id = by_id_link(device);
  port.driver = driver_of(carrier);
  udev_device* usb = udev_device_get_parent_with_subsystem_devtype(device, "usb", "usb_device");
  if (usb != nullptr) port.bus_path = text_or_empty(udev_device_get_sysname(usb));
  port.vendor_id = hexadecimal(property_or_attribute(device, "ID_USB_VENDOR_ID", usb, "idVendor"));
  port.product_id = hexadecimal(property_or_attribute(device, "ID_USB_MODEL_ID", usb, "idProduct"));
  if (usb == nullptr) return port;
  const auto says = [&](const char* attribute) {
    return text_or_empty(udev_device_get_sysattr_value(usb, attribute));
  };
  port.usb_serial = says("serial");
  port.manufacturer = says("manufacturer");
  port.product = says("product");
  return port;
}

}  // namespace g4lidar
