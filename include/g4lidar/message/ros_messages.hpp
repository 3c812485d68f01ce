// SPDX-License-Identifier: MIT
// ROS 2 messages of scans and points, in CDR: for recordings, and for nodes that publish serialized
// messages. Does not need ROS.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

/// The order of the ranges of a LaserScan, and with it its frame.
enum class scan_order : std::uint8_t {
  /// Counter-clockwise from behind, in the lidar's own frame (frame::robot): x forward, y to the left.
  /// The device turns the other way, so the times of the ranges are not known: time_increment is 0.
  angle,
  /// In the order in which they were measured, with their real time_increment, in a frame with z
  /// down: the lidar's own, turned by half a turn about x, so y is to the right. angle_min changes from
  /// scan to scan. Not for slam_toolbox, which uses that of the first scan, and takes the angles of a frame
  /// with z down as symmetrical about 0: its maps would be wrong.
  time,
};

/// The header of a message, and the duration of the revolution.
struct message_header {
  std::int64_t stamp_ns = 0;     ///< Of the first point, nanoseconds since 1970.
  std::string_view frame_id{};   ///< The coordinate frame, such as "laser".
  std::int64_t duration_ns = 0;  ///< From the first point to the first one of the next revolution.
  scan_order order = scan_order::angle;  ///< See scan_order; also of a PointCloud2, for its frame.
  std::size_t first_bin = 0;             ///< In the order of time: where the revolution begins.
  /// The model of the lidar, for the limits of its ranges, its turn, and whether the points of a
  /// PointCloud2 have an intensity. Not null.
  const g4lidar::model* model = &g4_model;
  /// Of a LaserScan: as many as there are ranges, in the same order; empty: it has none.
  std::span<const float> intensities{};
  /// range_max of a LaserScan, in millimetres; 0: the longest range of the model by the manufacturer.
  float longest_mm = 0.0F;
};

/// The name and the definition of a message, as recordings contain them. Valid forever.
struct message_schema {
  std::string_view name;
  std::string_view text;
};
[[nodiscard]] G4LIDAR_API message_schema laser_scan_schema() noexcept;    ///< LaserScan.
[[nodiscard]] G4LIDAR_API message_schema point_cloud2_schema() noexcept;  ///< PointCloud2.
[[nodiscard]] G4LIDAR_API message_schema odometry_schema() noexcept;      ///< Odometry.
[[nodiscard]] G4LIDAR_API message_schema tf_message_schema() noexcept;    ///< TFMessage.

/// Fills `ranges_m`, not empty, with `points` for a LaserScan in the order of time, as fill_grid() does
/// in the vendor's frame, and returns its first_bin: that of the mean direction from which the
/// returns began. Points at the begin or the end of the revolution whose bin is at the other end, so that
/// its time would be wrong by a revolution, are left out. `options`, but for its frame, and
/// `intensities` are as for fill_grid(). *Never allocates.*
[[nodiscard]] G4LIDAR_API std::size_t fill_time_grid(std::span<const point> points,
                                                     std::int64_t duration_ns,
                                                     std::span<float> ranges_m,
                                                     grid_options options = {},
                                                     std::span<float> intensities = {}) noexcept;
/// The same for the points of a scan, with its duration and the longest range of its model.
[[nodiscard]] inline std::size_t fill_time_grid(const scan& source, std::span<float> ranges_m,
                                                const grid_options& options = {},
                                                std::span<float> intensities = {}) noexcept {
  return fill_time_grid(source.points, source.duration_ns, ranges_m, options.with(*source.model),
                        intensities);
}

/// Fills `ranges_m` and `intensities` for a LaserScan of `source` in header.order: with `bins` ranges, at least one, as
/// fill_grid() or fill_time_grid() does, and with as many intensities if the model has them. Sets header.first_bin,
/// header.longest_mm to that of `options`, limited by the model, and header.intensities, which views `intensities`.
/// Allocates beyond the capacities.
G4LIDAR_API void fill_laser_scan(const scan& source, message_header& header, std::size_t bins,
                                 const grid_options& options, std::vector<float>& ranges_m,
                                 std::vector<float>& intensities);

/// The numbers of a LaserScan beside its ranges and intensities, for programs that fill a message of ROS themselves.
struct laser_scan_numbers {
  float angle_min_rad = 0.0F;
  float angle_max_rad = 0.0F;
  float angle_increment_rad = 0.0F;
  float time_increment_s = 0.0F;
  float scan_time_s = 0.0F;
  float range_min_m = 0.0F;
  float range_max_m = 0.0F;
  std::size_t first =
      0;  ///< The index of the range with which the message begins; those before it follow the last one.
};
/// Those that put_laser_scan() writes for `bins` ranges, at least one. *Pure.*
[[nodiscard]] G4LIDAR_API laser_scan_numbers numbers_of(const message_header& header,
                                                        std::size_t bins) noexcept;

/// Appends a sensor_msgs/msg/LaserScan to `out`. range_min is the shortest range of the model (0.1 m
/// for a G4; ranges below are not reliable), range_max header.longest_mm (16 m for a G4; a sample may contain
/// more), angle_increment 2 pi / bins.
/// +infinity is not free space: a target nearer than the shortest range of the lidar
/// (0.28 m at 9 kHz, more than range_min) may give no return; see filter/too_near.hpp and grid_options. Allocates beyond the capacity of `out`.
///
/// By angle, `ranges_m` are the bins that fill_grid() fills in the robot's frame, at least one:
/// angle_min is -pi. By time, they are those that fill_time_grid() fills, and the message
/// begins with `first_bin`: angle_min is the angle of this bin, time_increment duration_ns / bins. SLAM programs compute the number of ranges from the angles; they get it.
G4LIDAR_API void put_laser_scan(std::span<const float> ranges_m, const message_header& header,
                                std::vector<std::uint8_t>& out);

/// Appends a sensor_msgs/msg/PointCloud2 of the returns among `points`, in their order, as measured:
/// float32 x, y, z in metres (z is 0), uint32 t, nanoseconds since cloud_time_ns(), float32
/// range in metres and float32 angle in radians, counter-clockwise from x; of
/// models that have it also float32 intensity, point::intensity. One row, is_dense. Allocates beyond the capacity of `out`.
G4LIDAR_API void put_point_cloud2(std::span<const point> points, const message_header& header,
                                  std::vector<std::uint8_t>& out);

/// The earliest time of `points` that is known, that of the first one in a scan of one lidar: what the stamp of their
/// PointCloud2 states. 0 if none is known. *Pure.*
[[nodiscard]] G4LIDAR_API std::int64_t cloud_time_ns(std::span<const point> points) noexcept;

/// A sensor_msgs/PointField with one number.
struct cloud_field {
  std::string_view name;
  std::uint32_t offset;  ///< In a point, bytes.
  std::uint8_t datatype;
};
/// The fields of put_point_cloud2() for points of this model. *Pure.* Valid forever.
[[nodiscard]] G4LIDAR_API std::span<const cloud_field> cloud_fields(const model& model) noexcept;
/// The bytes of a point with these fields. *Pure.*
[[nodiscard]] G4LIDAR_API std::uint32_t cloud_point_size(const model& model) noexcept;
/// Appends the `data` of put_point_cloud2() to `out`. Allocates beyond the capacity of `out`.
G4LIDAR_API void put_cloud_points(std::span<const point> points, const message_header& header,
                                  std::vector<std::uint8_t>& out);

/// The quaternion x, y, z, w of a frame that is turned so: about z, and upside down after half a turn about x. *Pure.*
[[nodiscard]] G4LIDAR_API std::array<double, 4> quaternion_of(const mounting& place) noexcept;

/// A message of odometry. Covariances are those of x, y, z, and of the rotations about x, y, z, row
/// by row; 0: not known.
struct odometry_message {
  std::int64_t stamp_ns = 0;                      ///< Nanoseconds since 1970.
  std::string_view frame_id = "odom";             ///< The fixed frame, that of the pose.
  std::string_view child_frame_id = "base_link";  ///< The robot's frame, that of the twist.
  pose_2d pose{};                                 ///< Of the robot.
  twist_2d twist{};                               ///< Of the robot.
  std::array<double, 36> pose_covariance{};       ///< Of `pose`.
  std::array<double, 36> twist_covariance{};      ///< Of `twist`.
};
/// Appends a nav_msgs/msg/Odometry to `out`. Allocates beyond the capacity of `out`.
G4LIDAR_API void put_odometry(const odometry_message& message, std::vector<std::uint8_t>& out);
/// The contents of a nav_msgs/msg/Odometry in the plane. `pose`: x, y, z, and the quaternion x, y, z, w;
/// `twist`: along and about x, y, z. Nothing if a number that is used is above max_odometry_value in
/// magnitude, or is none. *Pure.*
[[nodiscard]] G4LIDAR_API std::optional<stamped_odometry> planar_odometry(
    std::int64_t time_ns, const std::array<double, 7>& pose,
    const std::array<double, 6>& twist) noexcept;

/// The place of one frame in another.
struct transform_message {
  std::int64_t stamp_ns = 0;                  ///< Nanoseconds since 1970.
  std::string_view frame_id = "base_link";    ///< The frame in which the place is.
  std::string_view child_frame_id = "laser";  ///< The frame whose place it is.
  mounting place{};                           ///< The place.
};
/// Appends a tf2_msgs/msg/TFMessage with this transform to `out`. Allocates beyond the capacity of
/// `out`.
G4LIDAR_API void put_tf_message(const transform_message& message, std::vector<std::uint8_t>& out);

/// Appends a rosgraph_msgs/msg/Clock to `out`; `now_ns` is in nanoseconds since 1970. Allocates beyond
/// the capacity of `out`.
G4LIDAR_API void put_clock(std::int64_t now_ns, std::vector<std::uint8_t>& out);

/// The levels of a DiagnosticStatus.
enum class diagnostic_level : std::uint8_t { ok = 0, warn = 1, error = 2, stale = 3 };

/// One diagnostic_msgs/msg/DiagnosticStatus.
struct diagnostic_status {
  diagnostic_level level = diagnostic_level::ok;
  std::string name{};         ///< "g4lidar: rate".
  std::string message{};      ///< Cause and advice; "ok" where there is no diagnosis.
  std::string hardware_id{};  ///< The serial number of the lidar.
  std::vector<std::pair<std::string, std::string>> values{};  ///< Names with units, and values.
};

/// The schema of DiagnosticArray.
[[nodiscard]] G4LIDAR_API message_schema diagnostic_array_schema() noexcept;
/// Appends a diagnostic_msgs/msg/DiagnosticArray to `out`; `stamp_ns` is in nanoseconds since 1970.
/// Allocates beyond the capacity of `out`.
G4LIDAR_API void put_diagnostic_array(std::span<const diagnostic_status> statuses,
                                      std::int64_t stamp_ns, std::vector<std::uint8_t>& out);

}  // namespace g4lidar
