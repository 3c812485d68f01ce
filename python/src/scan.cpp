// SPDX-License-Identifier: MIT
#include "kept_scan.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include <optional>
#include <string>
#include <vector>

#include "enumeration_words.hpp"
#include "errors.hpp"
#include "g4lidar/message/ros_messages.hpp"

namespace g4lidar::python {

kept_scan::kept_scan(const scan& scan, std::int64_t wall_minus_monotonic_ns)
    : about(scan),
      points(array_of(scan.points)),
      time_ns(scan.time_ns()),
      end_ns(scan.end_ns()),
      wall_ahead_ns(wall_minus_monotonic_ns),
      measured_sample_rate_hz(scan.measured_sample_rate_hz()),
      measured_frequency_hz(scan.measured_frequency_hz()) {
  about.points = {};
}

array<float> to_xy_array(const array<point>& points, frame to, std::uint16_t turn_deg) {
  const elements<point> from(points);
  const std::span<const point> all = from.span();
  array<float> made{new_array(element::single, all.size(), 2)};
  const buffer memory(made.object, true);
  const std::span<float> out = memory.as<float>();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const xy_point place = to_xy(all[i], to, turn_deg);
    out[2 * i] = place.x_m;
    out[2 * i + 1] = place.y_m;
  }
  return made;
}

array<float> to_ranges(const array<point>& points, std::size_t bins, const grid_options& options,
                       std::span<float> intensities) {
  if (bins < 1 || bins > 65536) raise_impossible("a grid has 1 to 65536 ranges", bins);
  const elements<point> from(points);
  if (from.span().size() > (std::size_t{1} << 24))
    throw nb::value_error("more than 16777216 points");
  return make_array<float>(
      bins, [&](std::span<float> out) { fill_grid(from.span(), out, options, intensities); });
}

namespace {

/// The header of its messages.
message_header header_of(const kept_scan& scan, const std::string& frame_id) {
  return {.stamp_ns = scan.time_ns + scan.wall_ahead_ns,
          .frame_id = frame_id,
          .duration_ns = scan.about.duration_ns,
          .model = scan.about.model};
}

/// Turned, and with the number of ranges, of its model.
array<float> ranges_of(const kept_scan& scan, std::optional<std::size_t> bins,
                       const grid_options& options, std::span<float> intensities = {}) {
  const model& of = *scan.about.model;
  return to_ranges(scan.points, bins.value_or(default_bins(of)), options.with(of), intensities);
}

nb::bytes laser_scan(const kept_scan& scan, std::optional<std::size_t> bins,
                     const std::string& frame_id, no_return_as no_return) {
  const std::size_t count = bins.value_or(default_bins(*scan.about.model));
  std::vector<float> intensities(has_intensity(*scan.about.model) ? count : 0);
  const array<float> ranges = ranges_of(scan, count, {.no_return = no_return}, intensities);
  message_header header = header_of(scan, frame_id);
  header.intensities = intensities;
  std::vector<std::uint8_t> out;
  put_laser_scan(elements<float>(ranges).span(), header, out);
  return nb::bytes(out.data(), out.size());
}

nb::bytes point_cloud2(const kept_scan& scan, const std::string& frame_id) {
  std::vector<std::uint8_t> out;
  put_point_cloud2(elements<point>(scan.points).span(), header_of(scan, frame_id), out);
  return nb::bytes(out.data(), out.size());
}

void bind_revolution(nb::class_<kept_scan>& made) {
  made.def_ro("points", &kept_scan::points,
              "The points in the order of measurement: a structured array with the dtype "
              "POINT_DTYPE. `angle_deg`: "
              "clockwise degrees in [0, 360) from the cable exit; `range_mm`: millimetres, 0 for "
              "no return; `time_ns`: "
              "nanoseconds of the monotonic clock, 0 if unknown; `revolution`; `flags`: bits of "
              "PointFlag.")
      .def_prop_ro(
          "revolution", [](const kept_scan& s) { return s.about.revolution; },
          "The number of zero packets before it.")
      .def_prop_ro(
          "flags", [](const kept_scan& s) { return static_cast<int>(s.about.flags); },
          "Why it is not one whole revolution: bits of ScanFlag.")
      .def_prop_ro(
          "is_whole", [](const kept_scan& s) { return s.about.is_whole(); },
          "Whether it is one revolution from zero packet to zero packet without known loss.")
      .def_prop_ro(
          "is_piece", [](const kept_scan& s) { return s.about.is_piece(); },
          "Whether it is only a part of a turn. All other scans are revolutions, although data may "
          "be lost.");
}

void bind_measurement(nb::class_<kept_scan>& made) {
  made.def_prop_ro(
          "model", [](const kept_scan& s) { return s.about.model->word; },
          "The model of the lidar: 'g4', 'x4', ...")
      .def_prop_ro(
          "turn_deg", [](const kept_scan& s) { return s.about.model->turn_deg; },
          "The turn from the frame 'vendor' to 'robot': 180 for a G4, 0 for an X4.")
      .def_ro("time_ns", &kept_scan::time_ns,
              "When its first point was measured, in nanoseconds of the monotonic clock "
              "(time.monotonic_ns); 0 if "
              "not known.")
      .def_ro("end_ns", &kept_scan::end_ns,
              "When the next scan began; if there is none, when the last point was measured. As "
              "time_ns.")
      .def_prop_ro(
          "stamp",
          [](const kept_scan& s) {
            return static_cast<double>(s.time_ns + s.wall_ahead_ns) * 1e-9;
          },
          "When its first point was measured, in seconds since 1970 (time.time); of a recording, "
          "the time at which "
          "it was recorded; of a simulation in virtual time, seconds since its start.")
      .def_prop_ro(
          "duration",
          [](const kept_scan& s) { return static_cast<double>(s.about.duration_ns) * 1e-9; },
          "The time for its turn, in seconds; 0 if not known.")
      .def_prop_ro(
          "turned_deg", [](const kept_scan& s) { return s.about.turned_deg; },
          "The turn from the first point to the first one of the next scan, in degrees: about 360.")
      .def_prop_ro(
          "reported_frequency_hz",
          [](const kept_scan& s) { return s.about.reported_frequency_chz / 100.0; },
          "The rotation frequency that the device reported with this revolution, in Hz; 0 if it "
          "did not.")
      .def_ro("measured_frequency_hz", &kept_scan::measured_frequency_hz,
              "The measured rotation frequency, in Hz; 0 if it cannot be determined.")
      .def_ro("measured_sample_rate_hz", &kept_scan::measured_sample_rate_hz,
              "Samples per second.");
}

void bind_conversions(nb::class_<kept_scan>& made) {
  using namespace nb::literals;
  made.def(
          "xy",
          [](const kept_scan& s, frame to) {
            return to_xy_array(s.points, to, s.about.model->turn_deg);
          },
          "frame"_a = frame::robot,
          "x and y of each point in metres, an array of two columns. 'robot': x ahead (of a G4 "
          "opposite the cable exit), y to "
          "the left. 'vendor': x at 0 degrees, y at 90 degrees clockwise. Both are NaN for a point "
          "without return.")
      .def(
          "ranges",
          [](const kept_scan& s, std::optional<std::size_t> n, frame to, grid_pick pick,
             bool keep_too_near, no_return_as no_return) {
            return ranges_of(s, n, {to, pick, keep_too_near, no_return});
          },
          "n"_a = nb::none(), "frame"_a = frame::robot, "pick"_a = grid_pick::nearest,
          "keep_too_near"_a = false, "no_return"_a = no_return_as::infinity,
          "The scan on a grid of `n` directions (1 to 65536; by default by the model, 720 for a "
          "G4), in metres: inf where nothing came back (or `no_return`: 'nan', 'max' for the "
          "longest range of the model, 16 for a G4), NaN where nothing is known. inf is "
          "not free space: what is nearer than 0.28 m may give no return; see ScanShaper. In the "
          "frame 'robot' range 0 is at -180 degrees, and the next ones follow "
          "counter-clockwise; in "
          "'vendor' range 0 is at 0 degrees, and the next ones follow clockwise. Of several points "
          "in a bin it takes "
          "the 'nearest' to the middle of the bin, or the one with the 'minimum' range.")
      .def("laser_scan", &laser_scan, "bins"_a = nb::none(), "frame_id"_a = "laser",
           "no_return"_a = no_return_as::infinity,
           "The scan as a sensor_msgs/msg/LaserScan in CDR, with the ranges of ranges(bins): for "
           "ROS 2, zenoh and MCAP.")
      .def("point_cloud2", &point_cloud2, "frame_id"_a = "laser",
           "The returns as a sensor_msgs/msg/PointCloud2 in CDR: x, y, z in metres, t in "
           "nanoseconds since the stamp.");
}

}  // namespace

void bind_scan(nb::module_& module) {
  nb::class_<kept_scan> made(module, "Scan",
                             "One revolution, or a piece of one, with its points. It owns its "
                             "points: it is valid as long as it is kept.");
  bind_revolution(made);
  bind_measurement(made);
  bind_conversions(made);
  made.def("__len__", [](const kept_scan& s) { return nb::len(s.points.object); })
      .def("__repr__", [](const kept_scan& s) {
        return "<g4lidar.Scan of revolution " + std::to_string(s.about.revolution) + ": " +
               std::to_string(nb::len(s.points.object)) + " points" +
               (s.about.is_whole() ? ">" : ", not whole>");
      });
}

}  // namespace g4lidar::python
