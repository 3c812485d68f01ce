// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "g4lidar/discovery.hpp"
#include "sim/host/claim.hpp"
#include "transport/port_holder.hpp"
#include "udev_port.hpp"

namespace g4lidar {
namespace {

/// Appends the simulated lidars in the directory that the environment variable G4LIDAR_SIM_DIR names:
/// each symbolic link in it that leads to a pseudo-terminal which a running simulator serves. Without the
/// variable there are none.
void append_simulated_ports(std::vector<port_info>& ports) {
  namespace fs = std::filesystem;
  const std::string directory = sim::registry();
  if (directory.empty()) return;
  std::error_code wrong;
  fs::directory_iterator each(directory, wrong);
  for (; !wrong && each != fs::directory_iterator(); each.increment(wrong)) {
    std::error_code none;
    const fs::path target = fs::read_symlink(each->path(), none);
    // Anything else may be the terminal of a person or another program: it is not to be written to.
    if (none || !target.native().starts_with("/dev/pts/")) continue;
    if (!fs::exists(target, none) || !sim::claim(target.native()).is_held()) continue;
    port_info port;
    port.path = each->path().native();
    port.bus_path = "sim-" + each->path().filename().native();
    port.driver = "sim";
    port.vendor_id = 0x10c4;  // like the USB bridge of a G4, so that discovery finds it
    port.product_id = 0xea60;
    ports.push_back(std::move(port));
  }
}

}  // namespace

bool is_g4_bridge(const port_info& port) noexcept {
  return port.vendor_id == 0x10c4 && port.product_id == 0xea60;
}

result<std::vector<port_info>> list_ports() {
  const udev_owner<udev> context(udev_new());
  if (!context) return failure(task::finding, problem::system, "udev", errno);
  const udev_owner<udev_enumerate> list(udev_enumerate_new(context.get()));
  if (!list) return failure(task::finding, problem::system, "udev", errno);
  udev_enumerate_add_match_subsystem(list.get(), "tty");
  const int scanned = udev_enumerate_scan_devices(list.get());
  if (scanned < 0) return failure(task::finding, problem::system, "udev", -scanned);

  std::vector<port_info> ports;
  udev_list_entry* entry = udev_enumerate_get_list_entry(list.get());
  for (; entry != nullptr; entry = udev_list_entry_get_next(entry)) {
    // A port that disappears at this moment is not listed.
    const udev_owner<udev_device> device(
        udev_device_new_from_syspath(context.get(), udev_list_entry_get_name(entry)));
    if (!device) continue;
    if (auto port = port_of(device.get())) ports.push_back(*std::move(port));
  }
  append_simulated_ports(ports);
  for (port_info& port : ports) port.may_open = may_open(port.path);
  std::ranges::sort(ports, {}, &port_info::path);
  return ports;
}

void find_holders(std::span<port_info> ports) {
  const auto holders = device_holders();
  for (port_info& port : ports) {
    const auto holder = holders.find(port.path);
    port.holder = holder != holders.end() ? holder->second : std::string();
  }
}

}  // namespace g4lidar
