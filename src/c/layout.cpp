// SPDX-License-Identifier: MIT
// The layout of what crosses the border: equal to that of the C++ library where memory is shared, and
// the same for every caller. Nothing is compiled here but assertions.
#include <g4lidar.h>

#include <cstddef>
#include <type_traits>

#include "g4lidar/cartesian.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "g4lidar/version.hpp"  // a different version would be a macro that is defined twice
#include "versioned_options.hpp"

namespace g4lidar {
namespace {

// The size of a pointer is the only difference between processors.
constexpr std::size_t word = sizeof(void*);
constexpr std::size_t aligned(std::size_t offset) { return (offset + 7) / 8 * 8; }
// Options may grow behind this size, which programs of the first version have them with.
using c::first_size;

// ---- memory that both languages use ---------------------------------------------------------------
static_assert(sizeof(g4lidar_point) == sizeof(point) && alignof(g4lidar_point) == alignof(point));
static_assert(offsetof(g4lidar_point, angle_deg) == offsetof(point, angle_deg));
static_assert(offsetof(g4lidar_point, range_mm) == offsetof(point, range_mm));
static_assert(offsetof(g4lidar_point, time_ns) == offsetof(point, time_ns));
static_assert(offsetof(g4lidar_point, revolution) == offsetof(point, revolution));
static_assert(offsetof(g4lidar_point, flags) == offsetof(point, flags));
static_assert(offsetof(g4lidar_point, sample_flags) == offsetof(point, sample_flags));
static_assert(offsetof(g4lidar_point, intensity) == offsetof(point, intensity));
static_assert(static_cast<int>(point_flags::veiling) == G4LIDAR_VEILING);
static_assert(static_cast<int>(point_flags::may_be_too_near) == G4LIDAR_MAY_BE_TOO_NEAR);
static_assert(static_cast<int>(deskewing::by_scans) == G4LIDAR_DESKEW_BY_SCANS);
static_assert(static_cast<int>(no_return_as::max) == G4LIDAR_NO_RETURN_AS_MAX);
static_assert(static_cast<int>(point_flags::not_deskewed) == G4LIDAR_NOT_DESKEWED);
static_assert(sizeof(g4lidar_xy) == sizeof(xy_point));
static_assert(offsetof(g4lidar_xy, time_ns) == offsetof(xy_point, time_ns));
static_assert(sizeof(g4lidar_polar) == sizeof(polar));
static_assert(offsetof(g4lidar_polar, range_m) == offsetof(polar, range_m));
static_assert(sizeof(g4lidar_corner) == sizeof(corner));
static_assert(offsetof(g4lidar_corner, y_m) == offsetof(corner, y_m));
static_assert(sizeof(g4lidar_stamped_pose) == sizeof(stamped_pose));
static_assert(offsetof(g4lidar_stamped_pose, pose) == offsetof(stamped_pose, pose));
static_assert(offsetof(g4lidar_pose, yaw_rad) == offsetof(pose_2d, yaw_rad));

// ---- what programs were compiled with: never change a line, only add some -------------------------
static_assert(sizeof(g4lidar_point) == 24 && offsetof(g4lidar_point, time_ns) == 8);
static_assert(offsetof(g4lidar_point, flags) == 20);
static_assert(sizeof(g4lidar_error) == 624 && offsetof(g4lidar_error, subject) == 16);
static_assert(offsetof(g4lidar_error, message) == 112 && offsetof(g4lidar_error, advice) == 368);
static_assert(sizeof(g4lidar_event) == 16 && sizeof(g4lidar_health) == 8);
static_assert(sizeof(g4lidar_identity) == 24);
static_assert(sizeof(g4lidar_playback) == 40 && offsetof(g4lidar_playback, is_paused) == 32);
static_assert(sizeof(g4lidar_odometry) == 56 && sizeof(g4lidar_mounting) == 32);
static_assert(sizeof(g4lidar_twist_estimate) == 104 &&
              offsetof(g4lidar_twist_estimate, status) == 100);
static_assert(sizeof(g4lidar_truth) == 64);

static_assert(offsetof(g4lidar_options, recorder) == 2 * word);
static_assert(offsetof(g4lidar_options, transport_delay_ns) == aligned(3 * word));
static_assert(offsetof(g4lidar_options, reconnect) == aligned(3 * word) + 56);
static_assert(first_size<g4lidar_options> == aligned(3 * word) + 64);
static_assert(offsetof(g4lidar_options, device_wait_ms) == aligned(3 * word) + 64);
static_assert(offsetof(g4lidar_options, model) == aligned(3 * word) + 64 + word);
static_assert(offsetof(g4lidar_options, is_cancelled) == aligned(3 * word) + 64 + 2 * word);
static_assert(offsetof(g4lidar_options, zero_angle_cdeg) == aligned(3 * word) + 64 + 4 * word);
static_assert(offsetof(g4lidar_options, has_zero_angle) == aligned(3 * word) + 68 + 4 * word);
static_assert(offsetof(g4lidar_options, probe_all_ports) == aligned(3 * word) + 72 + 4 * word);
static_assert(offsetof(g4lidar_options, insist_on_model) == aligned(3 * word) + 74 + 4 * word);
static_assert(offsetof(g4lidar_options, leave_dtr) == aligned(3 * word) + 75 + 4 * word);
static_assert(offsetof(g4lidar_scan, time_ns) == 2 * word);
static_assert(offsetof(g4lidar_scan, is_piece) == 2 * word + 61);
static_assert(offsetof(g4lidar_scan, turn_deg) == 2 * word + 62);
static_assert(offsetof(g4lidar_scan, model) == 2 * word + 72);
static_assert(offsetof(g4lidar_counts, largest_gap_ns) == 144);
static_assert(offsetof(g4lidar_counts, extras) == 152);
static_assert(offsetof(g4lidar_counts, extras.empty_packets) == 176);
static_assert(first_size<g4lidar_grid_options> == word + 16);
static_assert(offsetof(g4lidar_grid_options, near_is_minus_infinity) == word + 20);
static_assert(offsetof(g4lidar_grid_options, longest_range_mm) == word + 28);
static_assert(offsetof(g4lidar_shaper_options, deskew) == 6 * word);
static_assert(offsetof(g4lidar_shaper_options, model) == 6 * word + 8);
static_assert(first_size<g4lidar_shaper_options> == 6 * word + 8);
static_assert(first_size<g4lidar_near_options> == word + 16);
static_assert(offsetof(g4lidar_filter_options, field_of_view) == aligned(5 * word));
static_assert(first_size<g4lidar_filter_options> == aligned(5 * word) + 40);
static_assert(first_size<g4lidar_outlier_options> == word + 32);
static_assert(first_size<g4lidar_find_options> == word + 16);
static_assert(offsetof(g4lidar_port, vendor_id) == 8 * word);
static_assert(offsetof(g4lidar_port, lidar) == 8 * word + 7);
static_assert(sizeof(g4lidar_polygon) == 2 * word);
static_assert(offsetof(g4lidar_recorder_options, rotate_bytes) == aligned(5 * word));
static_assert(first_size<g4lidar_recorder_options> == aligned(5 * word) + 24);
static_assert(offsetof(g4lidar_recorder_options, near_options) == aligned(5 * word) + 32);
static_assert(offsetof(g4lidar_recorder_options, model) == aligned(5 * word) + 32 + word);
static_assert(offsetof(g4lidar_playback_options, from_ns) == aligned(word) + 8);
static_assert(first_size<g4lidar_playback_options> == aligned(word) + 32);
static_assert(offsetof(g4lidar_playback_options, is_cancelled) == aligned(word) + 32);
static_assert(first_size<g4lidar_reader_options> == 3 * word + 8);
static_assert(offsetof(g4lidar_item, odometry) == aligned(16 + 3 * word));
static_assert(offsetof(g4lidar_recording_info, identity) == 50);
static_assert(first_size<g4lidar_simulator_options> == 5 * word + 8);

}  // namespace
}  // namespace g4lidar
