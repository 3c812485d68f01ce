// SPDX-License-Identifier: MIT
#include "g4lidar/message/ros_messages.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "cdr.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "schema_text.hpp"

namespace g4lidar {
namespace schema {
namespace {

constexpr std::string_view laser_scan = R"(std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities
)";

constexpr std::string_view point_cloud2 = R"(std_msgs/Header header
uint32 height
uint32 width
sensor_msgs/PointField[] fields
bool is_bigendian
uint32 point_step
uint32 row_step
uint8[] data
bool is_dense
)";
constexpr std::string_view point_field = R"(MSG: sensor_msgs/PointField
uint8 INT8    = 1
uint8 UINT8   = 2
uint8 INT16   = 3
uint8 UINT16  = 4
uint8 INT32   = 5
uint8 UINT32  = 6
uint8 FLOAT32 = 7
uint8 FLOAT64 = 8
string name
uint32 offset
uint8 datatype
uint32 count
)";

constexpr std::string_view odometry = R"(std_msgs/Header header
string child_frame_id
geometry_msgs/PoseWithCovariance pose
geometry_msgs/TwistWithCovariance twist
)";
constexpr std::string_view pose_with_covariance = R"(MSG: geometry_msgs/PoseWithCovariance
geometry_msgs/Pose pose
float64[36] covariance
)";
constexpr std::string_view pose = R"(MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
)";
constexpr std::string_view place = R"(MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
)";
constexpr std::string_view quaternion = R"(MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
)";
constexpr std::string_view twist_with_covariance = R"(MSG: geometry_msgs/TwistWithCovariance
geometry_msgs/Twist twist
float64[36] covariance
)";
constexpr std::string_view twist = R"(MSG: geometry_msgs/Twist
geometry_msgs/Vector3 linear
geometry_msgs/Vector3 angular
)";
constexpr std::string_view vector3 = R"(MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
)";

constexpr std::string_view transforms = R"(geometry_msgs/TransformStamped[] transforms
)";
constexpr std::string_view transform_stamped = R"(MSG: geometry_msgs/TransformStamped
std_msgs/Header header
string child_frame_id
geometry_msgs/Transform transform
)";
constexpr std::string_view transform = R"(MSG: geometry_msgs/Transform
geometry_msgs/Vector3 translation
geometry_msgs/Quaternion rotation
)";

}  // namespace
}  // namespace schema

namespace {

void put_all(cdr_writer& message, std::span<const double> values) {
  for (const double value : values) message.put(value);
}

/// The vector or point, and the quaternion.
void put_place(cdr_writer& message, const mounting& place) {
  put_all(message, std::array{place.pose.x_m, place.pose.y_m, 0.0});
  put_all(message, quaternion_of(place));
}

/// The codes are those of sensor_msgs/PointField.
constexpr std::uint8_t uint32_code = 6;
constexpr std::uint8_t float32_code = 7;
constexpr std::array<cloud_field, 7> all_cloud_fields{{{"x", 0, float32_code},
                                                       {"y", 4, float32_code},
                                                       {"z", 8, float32_code},
                                                       {"t", 12, uint32_code},
                                                       {"range", 16, float32_code},
                                                       {"angle", 20, float32_code},
                                                       {"intensity", 24, float32_code}}};

void append(std::vector<std::uint8_t>& out, std::uint32_t value) {
  for (unsigned i = 0; i < 32; i += 8) out.push_back(static_cast<std::uint8_t>(value >> i));
}
void append(std::vector<std::uint8_t>& out, float value) {
  append(out, std::bit_cast<std::uint32_t>(value));
}

}  // namespace

message_schema laser_scan_schema() noexcept {
  using namespace schema;
  return {"sensor_msgs/msg/LaserScan", text<laser_scan, header, time>};
}
message_schema point_cloud2_schema() noexcept {
  using namespace schema;
  return {"sensor_msgs/msg/PointCloud2", text<point_cloud2, header, time, point_field>};
}
message_schema odometry_schema() noexcept {
  using namespace schema;
  return {"nav_msgs/msg/Odometry", text<odometry, header, time, pose_with_covariance, pose, place,
                                        quaternion, twist_with_covariance, twist, vector3>};
}
message_schema tf_message_schema() noexcept {
  using namespace schema;
  return {"tf2_msgs/msg/TFMessage",
          text<transforms, transform_stamped, header, time, transform, vector3, quaternion>};
}

std::span<const cloud_field> cloud_fields(const model& model) noexcept {
  const std::size_t count = all_cloud_fields.size() - (has_intensity(model) ? 0 : 1);
  return std::span(all_cloud_fields).first(count);
}

std::uint32_t cloud_point_size(const model& model) noexcept {
  return cloud_fields(model).back().offset + 4;
}

std::int64_t cloud_time_ns(std::span<const point> points) noexcept {
  std::int64_t earliest_ns = 0;
  for (const point& p : points) {
    const bool is_earlier = earliest_ns == 0 || p.time_ns < earliest_ns;
    if (p.time_ns != 0 && is_earlier) earliest_ns = p.time_ns;
  }
  return earliest_ns;
}

void put_cloud_points(std::span<const point> points, const message_header& header,
                      std::vector<std::uint8_t>& out) {
  const bool with_intensity = has_intensity(*header.model);
  const float left = header.order == scan_order::time ? -1.0F : 1.0F;  // the y axis
  const std::int64_t begin_ns = cloud_time_ns(points);
  for (const point& p : points) {
    if (p.is_no_return()) continue;
    const xy_point place = to_xy(p, frame::robot, header.model->turn_deg);
    const std::int64_t since_ns = detail::saturating_sub(p.time_ns, begin_ns);
    append(out, place.x_m);
    append(out, left * place.y_m);
    append(out, 0.0F);
    append(out, static_cast<std::uint32_t>(std::clamp<std::int64_t>(
                    since_ns, 0, std::numeric_limits<std::uint32_t>::max())));
    const polar measured = to_polar(p, frame::robot, header.model->turn_deg);
    append(out, measured.range_m);
    append(out, left * measured.bearing_rad);
    if (with_intensity) append(out, static_cast<float>(p.intensity));
  }
}

void put_point_cloud2(std::span<const point> points, const message_header& header,
                      std::vector<std::uint8_t>& out) {
  const std::uint32_t point_size = cloud_point_size(*header.model);
  const auto count = static_cast<std::uint32_t>(std::count_if(
      points.begin(), points.end(), [](const point& p) { return !p.is_no_return(); }));
  cdr_writer message(out);
  put_header(message, header.stamp_ns, header.frame_id);
  message.put(std::uint32_t{1});
  message.put(count);
  const auto fields = cloud_fields(*header.model);
  message.put(static_cast<std::uint32_t>(fields.size()));
  for (const cloud_field& each : fields) {
    message.put(each.name);
    message.put(each.offset);
    message.put(each.datatype);
    message.put(std::uint32_t{1});
  }
  message.put(std::uint8_t{0});  // little-endian
  message.put(point_size);
  message.put(count * point_size);
  message.put(count * point_size);  // the length of `data`, whose numbers are at multiples of 4
  put_cloud_points(points, header, out);
  message.put(std::uint8_t{1});
}

std::array<double, 4> quaternion_of(const mounting& place) noexcept {
  const auto [sine, cosine] = rotation_by(wrap_rad(place.pose.yaw_rad) / 2.0);
  return place.upside_down ? std::array{cosine, sine, 0.0, 0.0}
                           : std::array{0.0, 0.0, sine, cosine};
}

void put_odometry(const odometry_message& message, std::vector<std::uint8_t>& out) {
  const auto& [forward, leftward, turn] = message.twist;
  cdr_writer text(out);
  put_header(text, message.stamp_ns, message.frame_id);
  text.put(message.child_frame_id);
  put_place(text, {message.pose, false});
  put_all(text, message.pose_covariance);
  put_all(text, std::array{forward, leftward, 0.0, 0.0, 0.0, turn});
  put_all(text, message.twist_covariance);
}

std::optional<stamped_odometry> planar_odometry(std::int64_t time_ns,
                                                const std::array<double, 7>& pose,
                                                const std::array<double, 6>& twist) noexcept {
  const auto& [x, y, z, qx, qy, qz, qw] = pose;
  const double yaw = std::atan2(2.0 * (qw * qz + qx * qy), qw * qw + qx * qx - qy * qy - qz * qz);
  const std::array used{x, y, yaw, twist[0], twist[1], twist[5]};
  const bool is_possible = std::ranges::all_of(
      used, [](double value) { return std::fabs(value) <= max_odometry_value; });
  if (!is_possible) return std::nullopt;
  return stamped_odometry{time_ns, {x, y, yaw}, {twist[0], twist[1], twist[5]}};
}

void put_tf_message(const transform_message& message, std::vector<std::uint8_t>& out) {
  cdr_writer text(out);
  text.put(std::uint32_t{1});
  put_header(text, message.stamp_ns, message.frame_id);
  text.put(message.child_frame_id);
  put_place(text, message.place);
}

void put_clock(std::int64_t now_ns, std::vector<std::uint8_t>& out) {
  cdr_writer message(out);
  put_time(message, now_ns);
}

}  // namespace g4lidar
