// SPDX-License-Identifier: MIT
// A computer with chosen serial ports: stands in for libudev, whose functions it has.
#pragma once

#include <string>
#include <vector>

namespace g4lidar::test {

/// A USB bridge as it comes with a G4.
struct fake_bridge {
  std::string bus_path;  ///< "1-1.4"
  std::string path;      ///< Where its port is.
};

/// What is plugged in, as long as this lives. One at a time.
class fake_computer {
 public:
  explicit fake_computer(std::vector<fake_bridge> bridges, bool answers = true);
  fake_computer(const fake_computer&) = delete;
  fake_computer& operator=(const fake_computer&) = delete;
  ~fake_computer();
};

}  // namespace g4lidar::test
