// SPDX-License-Identifier: MIT
// Text from values, as printf makes it.
#pragma once

#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <string>

namespace g4lidar::simulation {

/// At most 399 characters.
[[gnu::format(printf, 1, 2)]] inline std::string text_of(const char* form, ...) {
  char text[400];
  std::va_list values;
  va_start(values, form);
  std::vsnprintf(text, sizeof text, form, values);
  va_end(values);
  return text;
}

inline double in_seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

}  // namespace g4lidar::simulation
