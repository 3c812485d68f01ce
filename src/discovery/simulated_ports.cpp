// SPDX-License-Identifier: MIT
#include "simulated_ports.hpp"

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "sim/host/claim.hpp"

namespace g4lidar {

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

}  // namespace g4lidar
