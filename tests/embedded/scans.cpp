// SPDX-License-Identifier: MIT
// Revolutions and the grid: every point is in exactly one scan, the right one.
#include "g4lidar/core/scan_assembler.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "check.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/grid.hpp"

namespace self_test {
namespace {

using namespace g4lidar;

/// A revolution here: a zero packet with one sample, then packets of ten samples, each two degrees
/// after the previous one, from 1 degree to 359.
constexpr std::size_t samples_a_turn = 181;
std::array<point, 190> storage;

struct heard {
  std::size_t scans = 0;
  std::size_t whole = 0;
  std::size_t points = 0;
  scan last;
};

class spinner {
 public:
  explicit spinner(std::span<point> room) : assembler_(room) {}

  void zero() {
    const std::array<std::uint16_t, 1> sample{8000};
    give(made_packet(0x8F, {0, 0}, sample));
  }
  void rest_of_turn() {
    std::array<std::uint16_t, 10> samples{};
    for (std::size_t i = 0; i < samples.size(); ++i) {
      samples[i] = static_cast<std::uint16_t>(8000 + 4 * i);
    }
    for (unsigned degrees = 0; degrees < 360; degrees += 20) {
      give(made_packet(0,
                       {static_cast<std::uint16_t>(degrees * 64 + 64),
                        static_cast<std::uint16_t>(degrees * 64 + 64 + 18 * 64)},
                       samples));
    }
  }
  void end() {
    while (const auto done = assembler_.finish()) hear(*done);
  }

  heard got;
  std::size_t given = 0;

 private:
  void give(const made_packet& made) {
    const auto packet = packet_view::from(made.data());
    if (!check(packet.has_value())) return;
    decoded points = decode(*packet, compact_correction{}, counter_.count(*packet), room);
    given += points.points.size();
    while (const auto done = assembler_.next(points)) hear(*done);
  }
  void hear(const scan& done) {
    ++got.scans;
    got.points += done.points.size();
    if (done.is_whole()) ++got.whole;
    got.last = done;
  }

  scan_assembler assembler_;
  revolution_counter counter_;
};

void test_revolutions() {
  spinner device(storage);
  device.rest_of_turn();  // the first one is partial
  for (int turn = 0; turn < 3; ++turn) {
    device.zero();
    device.rest_of_turn();
  }
  check(device.got.scans == 3 && device.got.whole == 2);
  check(device.got.last.points.size() == samples_a_turn);
  check(device.got.last.revolution == 2);
  check(device.got.last.reported_frequency_chz == 710);
  check(near(device.got.last.turned_deg, 360.0, 0.01));
  check(near(device.got.last.measured_frequency_hz(), 9000.0 / samples_a_turn, 0.01));
  device.end();
  check(device.got.scans == 4 && device.got.whole == 2);
  check(device.got.last.has(scan_flags::end_missing));
  check(device.got.points == device.given);
}

void test_lost_zero_packet() {
  spinner device(storage);
  device.zero();
  device.rest_of_turn();
  device.rest_of_turn();
  check(device.got.scans == 1 && device.got.whole == 0);
  check(device.got.last.has(scan_flags::end_by_angle));
  check(device.got.last.points.size() == samples_a_turn);
  device.zero();
  check(device.got.scans == 2 && device.got.whole == 0);
  check(device.got.last.has(scan_flags::start_by_angle));
  device.end();
  check(device.got.points == device.given);
}

void test_full_storage() {
  spinner device(std::span<point>(storage).first(50));
  for (int turn = 0; turn < 2; ++turn) {
    device.zero();
    device.rest_of_turn();
  }
  device.end();
  check(device.got.scans == 8 && device.got.whole == 0);
  check(device.got.points == device.given);
}

/// The content of the bin around 180 degrees.
float bin_of(std::span<const point> points, const grid_options& options) {
  std::array<float, 36> grid{};
  fill_grid(points, grid, options);
  return grid[18];
}

void test_grid() {
  // The first one is a direction without return.
  std::array<point, 7> points{};
  const std::array<float, 7> angles{179.9F, 180.1F, 180.2F, 180.3F, 90.0F, 270.0F, 50.0F};
  const std::array<float, 7> ranges_mm{0.0F, 50.0F, 1000.0F, 900.0F, 0.0F, 0.0F, 3000.0F};
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].angle_deg = unknown(angles[i]);
    points[i].range_mm = unknown(ranges_mm[i]);
    points[i].flags = flag_of(static_cast<std::uint16_t>(4.0F * ranges_mm[i]));
  }
  const grid_options nearest{frame::vendor, grid_pick::nearest, false};
  const grid_options minimum{frame::vendor, grid_pick::minimum, false};
  const std::span<const point> all = points;
  check(bin_of(all, nearest) == 1000.0F * 0.001F);
  check(bin_of(all, minimum) == 900.0F * 0.001F);
  check(bin_of(all, {frame::vendor, grid_pick::minimum, true}) == 50.0F * 0.001F);
  check(bin_of(all, {frame::robot, grid_pick::nearest, false}) == 1000.0F * 0.001F);  // ahead
  check(bin_of(all.first(1), nearest) > 1e30F);  // nothing came back
  const float too_near = bin_of(all.first(2), nearest);
  check(too_near != too_near);

  std::array<float, 36> grid{};
  fill_grid(points, grid, {frame::robot, grid_pick::nearest, false});
  check(grid[0] != grid[0]);  // not measured
  check(grid[31] == 3000.0F * 0.001F);
}

}  // namespace

void test_scans() {
  test_revolutions();
  test_lost_zero_packet();
  test_full_storage();
  test_grid();
}

}  // namespace self_test
