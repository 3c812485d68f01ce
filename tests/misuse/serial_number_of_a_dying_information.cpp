// SPDX-License-Identifier: MIT
// The serial number is a view of the structure: that of a temporary structure does not compile.
// expect: deleted function.*serial_number|call to deleted member function 'serial_number'
#include <string_view>

#include "g4lidar/core/response.hpp"

g4lidar::device_information ask();

bool misuse() {
#ifdef MISUSE
  const std::string_view serial = ask().serial_number();
#else
  const g4lidar::device_information info = ask();
  const std::string_view serial = info.serial_number();
#endif
  return serial.empty();
}
