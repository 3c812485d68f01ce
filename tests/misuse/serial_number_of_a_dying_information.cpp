// SPDX-License-Identifier: MIT
// The serial number is seen in the structure that holds it: of one that dies with the expression it
// does not compile.
// expect: deleted function.*serial_number|call to deleted member function 'serial_number'
#include <string_view>

#include "g4lidar/response.hpp"

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
