// SPDX-License-Identifier: MIT
// The arithmetic of the bulk decoder, one packet at a time, one version for each instruction set.
#pragma once

#include <cstdint>
#include <span>

#include "g4lidar/bulk_decoder.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/sensor_clock.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar::bulk {

/// They write the samples of a packet that is not suspect to the front of `out`. The memory behind
/// them in `out` may be overwritten. Returns below `shortest_mm`, at least 1, are too near.
struct kernels {
  void (*to_points)(packet_view packet, std::uint32_t revolution, std::uint16_t shortest_mm,
                    std::span<point, max_samples> out) noexcept;
  /// With their times.
  void (*to_timed_points)(packet_view packet, std::uint32_t revolution, std::uint16_t shortest_mm,
                          const packet_times& times, std::span<point, max_samples> out) noexcept;
  /// `turn_deg` is that of the model.
  void (*to_xy)(packet_view packet, frame to, std::uint16_t turn_deg,
                std::span<xy_point, max_samples> out) noexcept;
};

/// Those of a G4's samples.
extern const kernels portable_kernels;

/// Only on architectures that can have them.
#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define G4LIDAR_HAS_AVX2_KERNELS 1
extern const kernels avx2_kernels;
#else
#define G4LIDAR_HAS_AVX2_KERNELS 0
#endif

/// The kernels of an instruction set that this processor has, for the samples of a model. Another
/// combination of layout and correction than those of the models is an assertion.
[[nodiscard]] const kernels& kernels_of(instruction_set set,
                                        sample_format format = g4_format) noexcept;

}  // namespace g4lidar::bulk
