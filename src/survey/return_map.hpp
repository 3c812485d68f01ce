// SPDX-License-Identifier: MIT
// In which directions a lidar has looked, and from which something came back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "g4lidar/core/model_record.hpp"
#include "g4lidar/core/packet.hpp"

namespace g4lidar {

/// Directions from `from_deg` on, clockwise in the frame of the device; may pass zero.
struct direction_arc {
  int from_deg = 0;  ///< In [0, 360).
  int width_deg = 0;
};

/// Counts in each degree. *Single thread.* Constant memory; some tens of instructions a sample.
class return_map {
 public:
  return_map() = default;
  /// `is_thinned`: it looks at the first revolution and at each 64th, for a diagnosis that always runs.
  explicit return_map(bool is_thinned) noexcept : is_thinned_(is_thinned) {}

  /// Adds a packet of such samples. A suspect packet adds nothing.
  void take(packet_view packet, const sample_format& format) noexcept;
  /// Adds what another one has counted.
  void add(const return_map& other) noexcept;

  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
  [[nodiscard]] std::uint64_t returns() const noexcept { return returns_; }
  /// Whether it has looked in each direction.
  [[nodiscard]] bool is_round() const noexcept;
  /// The arcs of at least `least_deg` degrees in which it has looked at least three times in each direction, a thinned
  /// one twice, and nothing came back. Returns are counted one degree wider on both sides. One arc of 360 degrees if nothing
  /// came back at all. `is_wanted`: whether a direction, the middle of a degree, counts. Allocates.
  template <class Wanted>
  [[nodiscard]] std::vector<direction_arc> without_return(int least_deg, Wanted is_wanted) const {
    const std::uint32_t enough_looks = is_thinned_ ? 2 : 3;
    std::array<bool, full_turn_deg> is_silent{};
    for (std::size_t at = 0; at < is_silent.size(); ++at) {
      is_silent[at] = looks_[at] >= enough_looks && returned_[at] == 0 &&
                      is_wanted(static_cast<float>(at) + 0.5F);
    }
    return arcs_of(is_silent, least_deg);
  }

 private:
  static constexpr int full_turn_deg = 360;
  using degree_counts = std::array<std::uint32_t, full_turn_deg>;

  [[nodiscard]] static std::vector<direction_arc> arcs_of(
      const std::array<bool, full_turn_deg>& is_silent, int least_deg);

  template <sample_layout Ranges>
  void take_as(packet_view packet, correction_kind kind) noexcept;
  static void mark(degree_counts& counts, double from_deg, double to_deg) noexcept;

  degree_counts looks_{};
  degree_counts returned_{};
  std::uint64_t samples_ = 0;
  std::uint64_t returns_ = 0;
  bool is_thinned_ = false;
  bool is_looking_ = true;  // at this revolution
  unsigned revolutions_ = 0;
};

}  // namespace g4lidar
