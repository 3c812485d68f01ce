// SPDX-License-Identifier: MIT
// Round lines that are a part of any function.
#include <array>
#include <cstdio>

#include <g4lidar/sim/virtual_port.hpp>

int main() {
  using namespace g4lidar;
@fragment@
  std::puts("So far, so good.");
}
