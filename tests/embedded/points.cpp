// SPDX-License-Identifier: MIT
// Packets to points, and points in both frames, compared with numbers computed elsewhere.
#include <array>
#include <cstddef>
#include <cstdint>

#include "check.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/point.hpp"

namespace self_test {
namespace {

using namespace g4lidar;

/// From 358.5 to 1.25 degrees: across zero, and back and forth across it by the corrections.
constexpr std::array<std::uint16_t, 12> samples{0,   1,    3,    40,    399,   400,
                                                621, 1120, 4000, 32000, 64000, 65535};
/// From the formula in double precision.
constexpr std::array<double, 12> expected_deg{350.5094037, 350.7594037, 351.0094037, 63.1319411,
                                              3.9698866,   4.1887710,   0.0025903,   356.6727337,
                                              353.7378140, 352.9125748, 353.0859750, 353.3341812};
constexpr made_packet::angles over_zero{22944, 80};

template <class Form>
void test_decode(const Form& form, double tolerance_deg) {
  const made_packet made(0, over_zero, samples);
  const auto packet = packet_view::from(made.data());
  if (!check(packet.has_value())) return;
  const decoded got = decode(*packet, form, 7, room);
  check(!got.suspect && !got.starts_revolution && got.span_64ths == 176);
  if (!check(got.points.size() == samples.size())) return;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const point& p = got.points[i];
    check(near(p.angle_deg, expected_deg[i], tolerance_deg));
    const bool is_return = samples[i] >= 4;  // 1 to 3: no return, with flags
    check(p.range_mm == (is_return ? static_cast<float>(samples[i]) / 4.0F : 0.0F));
    check(p.is_no_return() == !is_return);
    check(p.is_too_near() == (is_return && samples[i] < 400));
    check(p.revolution == 7 && p.time_ns == 0);
  }
}

void test_suspect() {
  const made_packet made(1, {6400, 6390}, samples);
  const auto packet = packet_view::from(made.data());
  if (!check(packet.has_value())) return;
  const decoded got = decode(*packet, compact_correction{}, 0, room);
  check(got.suspect && got.starts_revolution && got.points.empty());
  check(got.sample_count == samples.size());
}

void test_longest_packet() {
  std::array<std::uint16_t, max_samples> ranges{};
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    ranges[i] = static_cast<std::uint16_t>(500 * i + 4);
  }
  const made_packet made(1, {64 * 64, (64 + 79) * 64}, ranges);
  const auto packet = packet_view::from(made.data());
  if (!check(packet.has_value())) return;
  const packet_room& exact = room;
  const packet_room& compact = other_room;
  check(decode(*packet, exact_correction{}, 0, room).points.size() == max_samples);
  check(decode(*packet, compact_correction{}, 0, other_room).points.size() == max_samples);
  for (std::size_t i = 0; i < max_samples; ++i) {
    const double expected = 64.0 + static_cast<double>(i) + exact_correction{}(ranges[i]);
    check(near(exact[i].angle_deg, expected, 1e-5));
    check(near(compact[i].angle_deg, expected, 1e-4));
    check(compact[i].is_revolution_start() == (i == 0));
  }
}

/// No sum rounds to 360: neither slightly below 0, nor for any range near 0.
void test_never_360() {
  check(wrap_once_deg(unknown(-1e-9F)) == 0.0F);
  check(wrap_once_deg(unknown(359.99998F)) < 360.0F);
  for (std::uint16_t angle_64ths = 0; angle_64ths < 16; ++angle_64ths) {
    for (std::uint16_t raw = 617; raw < 625; ++raw) {
      const std::array<std::uint16_t, 1> sample{raw};
      const made_packet made(0, {angle_64ths, angle_64ths}, sample);
      const auto packet = packet_view::from(made.data());
      if (!check(packet.has_value())) return;
      const decoded got = decode(*packet, compact_correction{}, 0, room);
      check(got.points[0].angle_deg >= 0.0F && got.points[0].angle_deg < 360.0F);
    }
  }
}

void test_coordinate_frames() {
  point p;
  p.angle_deg = unknown(30.0F);
  p.range_mm = unknown(2000.0F);
  const xy_point vendor = to_xy(p, frame::vendor);
  check(near(vendor.x_m, 1.7320508, 1e-6));
  check(near(vendor.y_m, 1.0, 1e-6));
  const xy_point robot = to_xy(p, frame::robot);
  check(near(robot.x_m, -1.7320508, 1e-6));
  check(near(robot.y_m, 1.0, 1e-6));
  const polar bearing = to_polar(p, frame::robot);
  check(near(bearing.bearing_rad, 2.6179939, 1e-6));
  check(near(bearing.range_m, 2.0, 1e-6));

  p.flags = point_flags::no_return;
  p.range_mm = 0.0F;
  const xy_point nowhere = to_xy(p, frame::robot);
  check(nowhere.x_m != nowhere.x_m && nowhere.y_m != nowhere.y_m);
  p.angle_deg = 22.0094037F;
  check(near(raw_angle_deg(p), 30.0, 1e-4));
}

}  // namespace

void test_points() {
  test_decode(exact_correction{}, 2e-5);
  test_decode(compact_correction{}, 1e-4);
  test_suspect();
  test_longest_packet();
  test_never_360();
  test_coordinate_frames();
}

}  // namespace self_test
