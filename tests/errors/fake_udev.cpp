// SPDX-License-Identifier: MIT
// The part of libudev that listing ports needs. This program exports these functions, so that dlsym() finds them before
// those of the library.
#include "fake_udev.hpp"

#include <libudev.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>
#include <utility>

struct udev {};
struct udev_enumerate {};
struct udev_list_entry {
  std::string name;  // the bridge's number
};
struct udev_device {
  const g4lidar::test::fake_bridge* bridge;
};

namespace g4lidar::test {
namespace {

std::vector<fake_bridge> plugged;
std::vector<udev_list_entry> entries;
std::vector<udev_device> devices;
udev context;
udev_enumerate enumeration;
bool is_answering = true;

}  // namespace

fake_computer::fake_computer(std::vector<fake_bridge> bridges, bool answers) {
  plugged = std::move(bridges);
  is_answering = answers;
  for (const fake_bridge& bridge : plugged) {
    entries.push_back({std::to_string(devices.size())});
    devices.push_back({&bridge});
  }
}

fake_computer::~fake_computer() {
  devices.clear();
  entries.clear();
  plugged.clear();
  is_answering = true;
}

}  // namespace g4lidar::test

using namespace g4lidar::test;

extern "C" {

udev* udev_new() {
  errno = ENOMEM;
  return is_answering ? &context : nullptr;
}
udev* udev_unref(udev*) { return nullptr; }

udev_enumerate* udev_enumerate_new(udev*) { return &enumeration; }
udev_enumerate* udev_enumerate_unref(udev_enumerate*) { return nullptr; }
int udev_enumerate_add_match_subsystem(udev_enumerate*, const char*) { return 0; }
int udev_enumerate_scan_devices(udev_enumerate*) { return 0; }
udev_list_entry* udev_enumerate_get_list_entry(udev_enumerate*) {
  return entries.empty() ? nullptr : entries.data();
}

udev_list_entry* udev_list_entry_get_next(udev_list_entry* entry) {
  return entry == &entries.back() ? nullptr : entry + 1;
}
const char* udev_list_entry_get_name(udev_list_entry* entry) { return entry->name.c_str(); }

udev_device* udev_device_new_from_syspath(udev*, const char* path) {
  std::size_t number = 0;
  std::from_chars(path, path + std::strlen(path), number);
  return &devices[number];
}
udev_device* udev_device_unref(udev_device*) { return nullptr; }
udev_device* udev_device_get_parent(udev_device* device) { return device; }
udev_device* udev_device_get_parent_with_subsystem_devtype(udev_device* device, const char*,
                                                           const char*) {
  return device;
}
const char* udev_device_get_devnode(udev_device* device) { return device->bridge->path.c_str(); }
const char* udev_device_get_sysname(udev_device* device) {
  return device->bridge->bus_path.c_str();
}
const char* udev_device_get_driver(udev_device*) { return "cp210x"; }
udev_list_entry* udev_device_get_devlinks_list_entry(udev_device*) { return nullptr; }
const char* udev_device_get_property_value(udev_device*, const char*) { return nullptr; }
const char* udev_device_get_sysattr_value(udev_device*, const char* attribute) {
  const std::string_view name = attribute;
  if (name == "idVendor") return "10c4";
  if (name == "idProduct") return "ea60";
  return name == "serial" ? "0001" : nullptr;
}
}
