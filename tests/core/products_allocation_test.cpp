// SPDX-License-Identifier: MIT
// Points, the ring, revolutions, the grid and coordinates need no heap.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>

#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/point_ring.hpp"
#include "g4lidar/core/scan_assembler.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/merge.hpp"
#include "g4lidar/motion/deskew.hpp"
#include "support/allocation_count.hpp"
#include "support/packet_bytes.hpp"

namespace g4lidar {
namespace {

using test::allocations_in;
using test::append;
using test::buffer;
using test::packet_bytes;
using test::some_samples;
using test::wire_angle;

/// Three revolutions of 24 packets with 40 samples, and a suspect packet in each.
buffer three_revolutions() {
  buffer stream;
  for (unsigned turn = 0; turn < 3; ++turn) {
    append(stream, packet_bytes(0x8D, wire_angle(0), wire_angle(0), some_samples(1)));
    for (unsigned i = 0; i < 24; ++i) {
      append(stream,
             packet_bytes(0, wire_angle(i * 960), wire_angle(i * 960 + 936), some_samples(40)));
    }
    append(stream, packet_bytes(0, wire_angle(22900), wire_angle(22800), some_samples(40)));
  }
  return stream;
}

TEST(Allocation, NoneFromPacketsToScans) {
  const buffer stream = three_revolutions();
  static point_ring<1024> ring;
  static point_ring<64, std::uint32_t> narrow_ring;
  static std::array<point, 2000> storage;
  static std::array<point, 100> small_storage;
  static std::array<xy_point, 2000> coordinates;
  static std::array<float, 720> ranges_m;
  static table_correction table;
  std::size_t scans = 0;
  std::uint64_t read = 0;
  stream_counter counts;

  const std::size_t allocations = allocations_in([&] {
    stream_parser parser;
    revolution_counter revolutions;
    scan_assembler assembler(storage);
    scan_assembler small_assembler(small_storage);
    auto reader = ring.make_reader();
    auto narrow_reader = narrow_ring.make_reader();
    std::array<point, max_samples> points;
    const auto use = [&](const scan& whole) {
      ++scans;
      static_cast<void>(whole.measured_frequency_hz());
      static_cast<void>(to_xy(whole.points, frame::robot, coordinates));
      fill_grid(whole.points, ranges_m, {frame::robot, grid_pick::minimum, true});
      fill_grid(whole.points, ranges_m);
    };
    const auto take = [&](const event& found) {
      counts.add(found);
      const auto* const packet = std::get_if<packet_view>(&found);
      if (packet == nullptr) return;
      const std::uint32_t revolution = revolutions.count(*packet);
      static_cast<void>(decode(*packet, exact_correction{}, revolution, points));
      static_cast<void>(decode(*packet, compact_correction{}, revolution, points));
      decoded got = decode(*packet, table, revolution, points);
      ring.push(got.points);
      narrow_ring.push(got.points);
      decoded again = got;
      while (const auto whole = assembler.next(got)) use(*whole);
      while (const auto piece = small_assembler.next(again)) use(*piece);
    };
    parser.feed(stream, take);
    while (const auto found = parser.finish()) take(*found);
    assembler.lost();
    while (const auto last = assembler.finish()) use(*last);
    read += reader.read(storage).points;
    read += narrow_reader.read(small_storage).points;
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(counts.packets, 78U);
  EXPECT_EQ(counts.suspect, 3U);
  EXPECT_EQ(read, 1024U + 64U);
  EXPECT_GT(scans, 20U);
}

TEST(Allocation, NoneInDeskewingAndMerging) {
  static std::array<point, 1000> points;
  std::int64_t time_ns = 0;
  for (point& p : points) {
    p.range_mm = 3000.0F;
    p.time_ns = time_ns += 111'111;
  }
  const std::array<stamped_pose, 3> path{
      {{0, {}}, {50'000'000, {0.1, 0, 0.1}}, {100'000'000, {0.2, 0, 0}}}};
  const auto motion = [&](std::int64_t at_ns) { return pose_at(path, at_ns); };
  static std::array<point, 2000> merged_points;
  const std::array<mounted_scan, 2> lidars{{{points, {}}, {points, {{0.1, 0, 0}, true}}}};
  std::size_t outside = 0;
  const std::size_t allocations = allocations_in([&] {
    outside += deskew(points, twist_2d{1, 0, 1}, 1).outside;
    outside += deskew(points, path, 1).outside;
    outside += deskew(points, motion, 1).outside;
    outside += merge_scans(lidars, path, 100'000'000, merged_points).outside;
  });
  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(outside, 400U);  // 100 of 1000 are later than the path
}

}  // namespace
}  // namespace g4lidar
