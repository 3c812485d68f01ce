// SPDX-License-Identifier: MIT
#include "testbed.hpp"

#include <gtest/gtest.h>
#include <umockdev.h>

#include <cstdlib>
#include <filesystem>
#include <utility>

namespace g4lidar::test {
namespace {

const std::string controller = "/devices/pci0000:00/0000:00:14.0/usb1";

std::string usb_path(const bridge& what) { return controller + "/" + what.place; }
std::string interface_path(const bridge& what) {
  return usb_path(what) + "/" + what.place + ":1.0";
}
std::string port_path(const bridge& what) { return interface_path(what) + "/" + what.name; }
std::string tty_path(const bridge& what) { return port_path(what) + "/tty/" + what.name; }

}  // namespace

bool is_preloaded() { return umockdev_in_mock_environment() != FALSE; }

testbed::testbed() : bed_(umockdev_testbed_new()) {
  gchar* root = umockdev_testbed_get_root_dir(bed_);
  root_ = root;
  g_free(root);
  std::filesystem::create_directories(root_ + "/dev");
}

testbed::~testbed() { g_object_unref(bed_); }

void testbed::add(const std::string& record) {
  GError* why = nullptr;
  EXPECT_TRUE(umockdev_testbed_add_from_string(bed_, record.c_str(), &why))
      << (why != nullptr ? why->message : "");
}

void testbed::remove(const std::string& path) {
  const std::string whole = "/sys" + path;
  umockdev_testbed_uevent(bed_, whole.c_str(), "remove");
  umockdev_testbed_remove_device(bed_, whole.c_str());
}

void testbed::plug(const bridge& what) {
  add("P: " + usb_path(what) + "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nA: idVendor=" +
      what.vendor + "\nA: idProduct=" + what.product + "\nA: serial=" + what.serial +
      "\nA: manufacturer=Silicon Labs\nA: product=USB to UART\n");
  add("P: " + interface_path(what) + "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nE: DRIVER=" +
      what.driver + "\nL: driver=../../../../../../bus/usb/drivers/" + what.driver + "\n");
  add("P: " + port_path(what) + "\nE: SUBSYSTEM=usb-serial\nE: DRIVER=" + what.driver +
      "\nL: driver=../../../../../../../bus/usb-serial/drivers/" + what.driver + "\n");
  // Without a line "N:" for the node: such a name could be used once only.
  add("P: " + tty_path(what) + "\nE: SUBSYSTEM=tty\nE: DEVNAME=/dev/" + what.name +
      "\nE: MAJOR=188\nE: MINOR=0\n");
}

void testbed::unplug(const bridge& what) {
  remove(tty_path(what));
  remove(port_path(what));
  remove(interface_path(what));
  remove(usb_path(what));
}

void testbed::add_builtin(std::string_view name, std::string_view type) {
  const std::string path = "/devices/platform/serial8250/tty/" + std::string(name);
  if (!std::exchange(has_platform_, true)) {
    add("P: /devices/platform/serial8250\nE: SUBSYSTEM=platform\nE: DRIVER=serial8250\nL: "
        "driver=../../../bus/platform/drivers/serial8250\n");
  }
  add("P: " + path + "\nE: SUBSYSTEM=tty\nE: DEVNAME=/dev/" + std::string(name) +
      "\nA: type=" + std::string(type) + "\n");
}

void testbed::add_console(std::string_view name) {
  const std::string text(name);
  add("P: /devices/virtual/tty/" + text + "\nE: SUBSYSTEM=tty\nE: DEVNAME=/dev/" + text + "\n");
}

void testbed::add_active_consoles(std::string_view names) {
  add("P: /devices/virtual/tty/console\nE: SUBSYSTEM=tty\nE: DEVNAME=/dev/console\nA: active=" +
      std::string(names) + "\\n\n");
}

std::string testbed::dev(std::string_view name) const {
  return root_ + "/dev/" + std::string(name);
}

}  // namespace g4lidar::test
