// SPDX-License-Identifier: MIT
#include "g4lidar/error.hpp"

#include "core/printable_text.hpp"

namespace g4lidar {

std::string printable(std::string_view text) {
  std::string shown;
  each_printable(text, [&shown](std::string_view piece) {
    shown += piece == "\\" ? std::string_view("\\\\") : piece;
  });
  return shown;
}

}  // namespace g4lidar
