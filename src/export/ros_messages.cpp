// SPDX-License-Identifier: MIT
#include "g4lidar/export/ros_messages.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>
#include <utility>

#include "cdr.hpp"
#include "g4lidar/cartesian.hpp"

namespace g4lidar {
namespace {

constexpr std::string_view laser_scan_text =
    R"(std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
)";

constexpr std::string_view point_cloud2_text =
    R"(std_msgs/Header header
uint32 height
uint32 width
sensor_msgs/PointField[] fields
bool is_bigendian
uint32 point_step
uint32 row_step
uint8[] data
bool is_dense
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: sensor_msgs/PointField
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

/// Reliable ranges, in metres: the maximum is that of 16 bits.
constexpr float least_range_m = too_near_mm * 0.001F;
constexpr float greatest_range_m = 16.38375F;

constexpr std::int64_t second_ns = 1'000'000'000;

void put_header(cdr_writer& message, const message_header& header) {
  // The nanoseconds count from the previous second, also before 1970.
  const std::int64_t rest_ns = (header.stamp_ns % second_ns + second_ns) % second_ns;
  message.put(static_cast<std::int32_t>((header.stamp_ns - rest_ns) / second_ns));
  message.put(static_cast<std::uint32_t>(rest_ns));
  message.put(header.frame_id);
}

/// x, y, z, t; the codes are those of sensor_msgs/PointField.
void put_fields(cdr_writer& message) {
  constexpr std::uint8_t uint32_code = 6;
  constexpr std::uint8_t float32_code = 7;
  constexpr std::array<std::pair<std::string_view, std::uint8_t>, 4> fields{
      {{"x", float32_code}, {"y", float32_code}, {"z", float32_code}, {"t", uint32_code}}};
  message.put(static_cast<std::uint32_t>(fields.size()));
  std::uint32_t offset = 0;
  for (const auto& [name, code] : fields) {
    message.put(name);
    message.put(std::exchange(offset, offset + 4));
    message.put(code);
    message.put(std::uint32_t{1});
  }
}

}  // namespace

message_schema laser_scan_schema() noexcept {
  return {"sensor_msgs/msg/LaserScan", laser_scan_text};
}
message_schema point_cloud2_schema() noexcept {
  return {"sensor_msgs/msg/PointCloud2", point_cloud2_text};
}

void put_laser_scan(std::span<const float> ranges_m, const message_header& header,
                    std::vector<std::uint8_t>& out) {
  constexpr float pi = std::numbers::pi_v<float>;
  const float increment = 2 * pi / static_cast<float>(ranges_m.size());
  cdr_writer message(out);
  put_header(message, header);
  message.put(-pi);
  message.put(-pi + increment * static_cast<float>(ranges_m.size() - 1));
  message.put(increment);
  message.put(0.0F);
  message.put(static_cast<float>(header.duration_ns) * 1e-9F);
  message.put(least_range_m);
  message.put(greatest_range_m);
  message.put(static_cast<std::uint32_t>(ranges_m.size()));
  for (const float range_m : ranges_m) message.put(range_m);
  message.put(std::uint32_t{0});
}

void put_point_cloud2(std::span<const point> points, const message_header& header,
                      std::vector<std::uint8_t>& out) {
  constexpr std::uint32_t point_size = 16;
  const auto count = static_cast<std::uint32_t>(std::count_if(
      points.begin(), points.end(), [](const point& p) { return !p.is_no_return(); }));
  cdr_writer message(out);
  put_header(message, header);
  message.put(std::uint32_t{1});
  message.put(count);
  put_fields(message);
  message.put(std::uint8_t{0});  // little-endian
  message.put(point_size);
  message.put(count * point_size);
  message.put(count * point_size);  // the length of `data`, whose numbers are at multiples of 4
  for (const point& p : points) {
    if (p.is_no_return()) continue;
    const xy_point place = to_xy(p, frame::robot);
    const std::int64_t since_ns = p.time_ns - points.front().time_ns;
    message.put(place.x_m);
    message.put(place.y_m);
    message.put(0.0F);
    message.put(static_cast<std::uint32_t>(
        std::clamp<std::int64_t>(since_ns, 0, std::numeric_limits<std::uint32_t>::max())));
  }
  message.put(std::uint8_t{1});
}

}  // namespace g4lidar
