// SPDX-License-Identifier: MIT
#include "slam_text.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "g4lidar/grid.hpp"
#include "value_text.hpp"

namespace g4_tool {
namespace {

/// Seconds with six decimals.
std::string seconds_of(std::int64_t time_ns) {
  const std::int64_t whole_us = time_ns / 1000;
  return with_decimals(static_cast<double>(whole_us) / 1e6, 6);
}

std::string numbers_of(const pose_2d& pose) {
  return with_decimals(pose.x_m, 6) + " " + with_decimals(pose.y_m, 6) + " " +
         with_decimals(pose.yaw_rad, 6);
}

class carmen_writer final : public point_writer {
 public:
  carmen_writer(std::size_t bins, const mounting& mount) : ranges_m_(bins), mount_(mount) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }
  void write_scan(const scan_record& record, text_sink& out) override {
    fill_grid(record.scan, ranges_m_, {.pick = grid_pick::minimum});
    // Seen from above the angles of a lidar that hangs upside down grow clockwise; the first bin is behind it.
    if (mount_.upside_down) std::reverse(ranges_m_.begin() + 1, ranges_m_.end());
    const float longest_m = longest_range_mm(record.scan.model->samples.layout) * 0.001F;
    write_carmen_scan({.ranges_m = ranges_m_,
                       .max_range_m = std::max(carmen_scan{}.max_range_m, std::ceil(longest_m)),
                       .robot = record.robot,
                       .mount = mount_.pose,
                       .stamp_ns = record.time_ns},
                      out);
  }

 private:
  std::vector<float> ranges_m_;
  mounting mount_;
};

class tum_writer final : public point_writer {
 public:
  [[nodiscard]] bool takes_scans() const noexcept override { return true; }
  void write_scan(const scan_record& record, text_sink& out) override {
    write_tum_pose({record.time_ns, record.robot}, out);
  }
};

}  // namespace

std::unique_ptr<point_writer> make_carmen_writer(std::size_t bins, const mounting& mount) {
  return std::make_unique<carmen_writer>(bins, mount);
}

std::unique_ptr<point_writer> make_tum_writer() { return std::make_unique<tum_writer>(); }

void write_carmen_scan(const carmen_scan& scan, text_sink& out) {
  const std::size_t bins = scan.ranges_m.size();
  assert(bins >= 2);
  const double bin_rad = 2.0 * std::numbers::pi / static_cast<double>(bins);
  const double view_rad = bin_rad * static_cast<double>(bins - 1);
  const std::string max = with_decimals(static_cast<double>(scan.max_range_m), 2);
  // Type, first angle, field of view, step, maximum, accuracy, kind of intensities, then the ranges.
  out.write("ROBOTLASER1 0 " + with_decimals(-view_rad / 2.0, 8) + " " +
            with_decimals(view_rad, 8) + " " + with_decimals(bin_rad, 8) + " " + max + " 0.01 0 " +
            std::to_string(bins));
  for (const float range_m : scan.ranges_m) {
    const bool is_range = range_m > 0.0F && range_m < scan.max_range_m;
    out.write(" " + (is_range ? with_decimals(static_cast<double>(range_m), 4) : max));
  }
  const pose_2d laser = scan.robot * scan.mount * pose_2d{0.0, 0.0, -bin_rad / 2.0};
  const std::string stamp = seconds_of(scan.stamp_ns);
  out.write(" 0 " + numbers_of(laser) + " " + numbers_of(scan.robot) + " 0 0 0 0 0 " + stamp +
            " g4lidar " + stamp + "\n");
}

void write_tum_pose(const stamped_pose& pose, text_sink& out) {
  const rotation half = rotation_by(pose.pose.yaw_rad / 2.0);
  out.write(seconds_of(pose.time_ns) + " " + with_decimals(pose.pose.x_m, 6) + " " +
            with_decimals(pose.pose.y_m, 6) + " 0 0 0 " + with_decimals(half.sine, 9) + " " +
            with_decimals(half.cosine, 9) + "\n");
}

}  // namespace g4_tool
