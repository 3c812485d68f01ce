// SPDX-License-Identifier: MIT
// Prints errors, points and scans to a std::ostream. An optional header.
#pragma once

#include <ostream>

#include "g4lidar/detail/text.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

/// The name, such as "permission".
inline std::ostream& operator<<(std::ostream& out, problem code) { return out << name_of(code); }
/// The name, such as "opening".
inline std::ostream& operator<<(std::ostream& out, task doing) { return out << name_of(doing); }
/// The message.
inline std::ostream& operator<<(std::ostream& out, const error& why) {
  return out << why.message();
}
/// "12.345 deg, 1234.5 mm", or "no return" in place of the range.
inline std::ostream& operator<<(std::ostream& out, const point& p) {
  const auto text = detail::text_of(p);
  return out << text.view();
}
/// "scan 12: 1286 points", and its flags.
inline std::ostream& operator<<(std::ostream& out, const scan& s) {
  const auto text = detail::text_of(s);
  return out << text.view();
}

}  // namespace g4lidar
