// SPDX-License-Identifier: MIT
// A computer with USB ports into which a test plugs bridges.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

typedef struct _UMockdevTestbed UMockdevTestbed;

namespace g4lidar::test {

/// A USB bridge. By default that of a G4, with the usual serial number.
struct bridge {
  std::string name = "ttyUSB0";
  std::string place = "1-1.4";
  std::string vendor = "10c4";
  std::string product = "ea60";
  std::string serial = "0001";
  std::string driver = "cp210x";
};

/// Whether this process sees the devices of a test bed. Without them its tests are skipped.
[[nodiscard]] bool is_preloaded();

class testbed {
 public:
  testbed();
  testbed(const testbed&) = delete;
  testbed& operator=(const testbed&) = delete;
  ~testbed();

  /// Adds it to sysfs, which sends the event; the test creates the node in /dev.
  void plug(const bridge& what);
  void unplug(const bridge& what);

  /// A tty that is not a USB device; `type` as in its sysfs attribute.
  void add_builtin(std::string_view name, std::string_view type);
  /// A tty without hardware.
  void add_console(std::string_view name);

  /// The terminals of the system's console, as the kernel lists them: "tty0 ttyS0".
  void add_active_consoles(std::string_view names);

  /// Where the link of /dev/<name> must be.
  [[nodiscard]] std::string dev(std::string_view name) const;

 private:
  void add(const std::string& record);
  void remove(const std::string& path);

  UMockdevTestbed* bed_;
  std::string root_;
  bool has_platform_ = false;
};

}  // namespace g4lidar::test
