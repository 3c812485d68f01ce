// SPDX-License-Identifier: MIT
// The USB plug of a simulated G4: pulled by a fault or by hand.
#pragma once

#include <cstdint>

namespace g4lidar::sim {

class usb_plug {
 public:
  /// Somebody keeps it unplugged, or does not any more.
  void hold_unplugged(bool held) noexcept { is_held_ = held; }
  /// Returns whether the plug was pulled or put in.
  [[nodiscard]] bool update(bool pulled_by_fault) noexcept {
    const bool is_in = !is_held_ && !pulled_by_fault;
    if (is_in == is_in_) return false;
    is_in_ = is_in;
    if (is_in) ++replugs_;
    return true;
  }
  [[nodiscard]] bool is_in() const noexcept { return is_in_; }
  [[nodiscard]] std::uint64_t replugs() const noexcept { return replugs_; }

 private:
  bool is_in_ = true;
  bool is_held_ = false;
  std::uint64_t replugs_ = 0;
};

}  // namespace g4lidar::sim
