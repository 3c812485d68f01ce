// SPDX-License-Identifier: MIT
// Points that are written together with their times, with every available instruction set.
#include <gtest/gtest.h>

#include <array>

#include "core/bulk_kernels.hpp"
#include "support/packet_maker.hpp"

namespace g4lidar {
namespace {

constexpr std::array<packet_times, 4> all_times{
    {{1'000'000'000'000'007, 111'111.111, 0, 0},
     {-5, 123'456.789, 0, 0},
     {0, 0.75, 0, 0},
     {(std::int64_t{1} << 62) + 1, 999'999'999.9, 0, 0}}};

/// A packet with `nearest` among its samples: near samples use another code path.
made::packet packet_of(std::size_t samples, std::uint16_t nearest) {
  made::packet packet(0, 100 * 64, 110 * 64, samples);
  for (std::size_t i = 0; i < samples; ++i)
    packet.set(i, static_cast<std::uint16_t>(4'000 + 4 * i));
  packet.set(samples / 2, nearest);
  return packet;
}

TEST(TimedPoints, PointsHaveTheTimesOfThePacket) {
  for (const instruction_set set : {instruction_set::portable, best_instruction_set()}) {
    const bulk::kernels& kernels = bulk::kernels_of(set);
    for (std::size_t samples = 1; samples <= max_samples; ++samples) {
      for (const std::uint16_t nearest : std::array<std::uint16_t, 3>{0, 40, 4'000}) {
        const made::packet packet = packet_of(samples, nearest);
        for (const packet_times& times : all_times) {
          std::array<point, max_samples> expected{};
          std::array<point, max_samples> found{};
          kernels.to_points(packet.view(), 7, g4_model.range.min_mm, {}, expected);
          kernels.to_points(packet.view(), 7, g4_model.range.min_mm, times, found);
          for (std::size_t i = 0; i < samples; ++i) {
            expected[i].time_ns = times.at(i);
            ASSERT_EQ(found[i], expected[i]) << samples << " samples, " << nearest << ", at " << i;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace g4lidar
