// SPDX-License-Identifier: MIT
// The arithmetic of the bulk decoder, one packet at a time, one version for each instruction set.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/sensor_clock.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/recording/bulk_decoder.hpp"

namespace g4lidar::bulk {

/// They write the samples of a packet that is not suspect to the front of `out`. The memory behind
/// them in `out` may be overwritten. Returns below `shortest_mm`, at least 1, are too near.
struct kernels {
  void (*to_points)(packet_view packet, std::uint32_t revolution, std::uint16_t shortest_mm,
                    const packet_times& times, std::span<point, max_samples> out) noexcept;
  /// `turn_deg` is that of the model.
  void (*to_xy)(packet_view packet, frame to, std::uint16_t turn_deg,
                std::span<xy_point, max_samples> out) noexcept;
};

/// The kernels of `Kernels` for a combination of layout and correction that models have; null for
/// another one.
template <template <sample_layout, correction_kind> class Kernels>
[[nodiscard]] constexpr const kernels* find_kernels(sample_format format) noexcept {
  struct entry {
    sample_layout layout;
    correction_kind correction;
    const kernels* found;
  };
  using enum sample_layout;
  using enum correction_kind;
  constexpr std::array all{
      entry{quarter_mm, triangle, &Kernels<quarter_mm, triangle>::all},
      entry{flagged_mm, triangle, &Kernels<flagged_mm, triangle>::all},
      entry{half_mm, triangle, &Kernels<half_mm, triangle>::all},
      entry{half_mm, correction_kind::none, &Kernels<half_mm, correction_kind::none>::all},
      entry{whole_mm, correction_kind::none, &Kernels<whole_mm, correction_kind::none>::all},
      entry{intensity_10, triangle, &Kernels<intensity_10, triangle>::all},
      entry{intensity_8, triangle, &Kernels<intensity_8, triangle>::all},
      entry{intensity_8, scl, &Kernels<intensity_8, scl>::all},
      entry{intensity_8, correction_kind::none, &Kernels<intensity_8, correction_kind::none>::all},
      entry{intensity_16, correction_kind::none,
            &Kernels<intensity_16, correction_kind::none>::all},
  };
  for (const entry& each : all) {
    if (each.layout == format.layout && each.correction == format.correction) return each.found;
  }
  return nullptr;
}

/// Only on architectures that can have them.
#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define G4LIDAR_HAS_AVX2_KERNELS 1
[[nodiscard]] const kernels& avx2_kernels_of(sample_format format) noexcept;
#else
#define G4LIDAR_HAS_AVX2_KERNELS 0
#endif

/// The kernels of an instruction set that this processor has, for the samples of a model. Another
/// combination of layout and correction than those of the models is an assertion.
[[nodiscard]] const kernels& kernels_of(instruction_set set,
                                        sample_format format = g4_format) noexcept;

}  // namespace g4lidar::bulk
