// SPDX-License-Identifier: MIT
// A computer with chosen serial ports: replaces libudev, whose functions it defines.
#pragma once

#include <string>
#include <vector>

namespace g4lidar::test {

/// The USB bridge of a G4.
struct fake_bridge {
  std::string bus_path;  ///< "1-1.4"
  std::string path;      ///< The path of its port.
};

/// The attached bridges, as long as this object exists. One object at a time.
class fake_computer {
 public:
  explicit fake_computer(std::vector<fake_bridge> bridges, bool answers = true);
  fake_computer(const fake_computer&) = delete;
  fake_computer& operator=(const fake_computer&) = delete;
  ~fake_computer();
};

}  // namespace g4lidar::test
