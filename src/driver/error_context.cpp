// SPDX-License-Identifier: MIT
#include "error_context.hpp"

namespace g4lidar {
namespace {

// In the order of the enumeration; start and stop are in the task already.
constexpr std::array<std::string_view, 16> request_words{"device information",
                                                         "health",
                                                         "low power",
                                                         "low power",
                                                         "direction",
                                                         "direction",
                                                         "scan frequency",
                                                         "scan frequency",
                                                         "scan frequency",
                                                         "constant frequency",
                                                         "ranging frequency",
                                                         "ranging frequency",
                                                         "power-down protection",
                                                         "restart",
                                                         "",
                                                         ""};
static_assert(request_words.size() == static_cast<std::size_t>(ask::stop) + 1);

constexpr std::array<std::string_view, 3> ranging_words{" 4 kHz", " 8 kHz", " 9 kHz"};

}  // namespace

error_context& error_context::add(const request& wanted) noexcept {
  const std::string_view what = request_words[static_cast<std::size_t>(wanted.what)];
  if (what.empty()) return *this;
  add(", ").add(what);
  if (wanted.what == ask::set_scan_frequency) return add(" ").add(scan_frequency{wanted.value});
  if (wanted.what == ask::set_ranging && wanted.value < ranging_words.size()) {
    return add(ranging_words[wanted.value]);
  }
  return *this;
}

}  // namespace g4lidar
