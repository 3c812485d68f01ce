// SPDX-License-Identifier: MIT
#include <cstdint>

#include "io/shape_files.hpp"
#include "scan_maker.hpp"

namespace g4_tool {

single_scans::single_scans(const serve_options& options, scan_sender& to)
    : sender_(to),
      scans_(options.common, true) {  // nobody is to deskew the points of a message again
  const g4lidar::mask mask = mask_in(options.common.mask);
  const shaping_options shape = shape_of(options.common, mask);
  if (shape.deskew == deskewing::none) unmoved_.set_options(shape);
  if (shape.deskew != deskewing::none) report_.emplace(shape.deskew, "in the source");
}

void single_scans::open(served_lidar& from, g4lidar::lidar& device) {
  scans_.open(device, from.source().simulation());
}

void single_scans::add(served_lidar& from, const g4lidar::scan& found) {
  const client_registry::demand wanted = sender_.wanted();
  // A file that a client makes of them has no model, so it would be read as that of a G4.
  const bool wants_bytes = wanted.wants(channel::from_device) && *found.model == g4_model;
  if (auto bytes = from.take_bytes(wants_bytes); !bytes.empty()) {
    sender_.send_bytes(from.bytes_ns(), std::move(bytes));
  }
  scans_.add(found, [&from](const stamped_odometry& at) { from.recorder().add(at); });
  if (report_) report_->add(found.size(), scans_.shaper().outside());
  if (!report_) unmoved_.shape(found);
  scan_shaper& shaped = report_ ? scans_.shaper() : unmoved_;
  const scan_stamp when{from.reader().wall_ns(found.time_ns()), found.duration_ns};
  if (wanted.page) {
    sender_.send_page({.revolution = scans_.shaper().kept(),
                       .stamp_s = static_cast<double>(when.stamp_ns) * 1e-9,
                       .place = scans_.place(),
                       .is_upside_down = scans_.is_upside_down()});
  }
  if (wanted.wants(channel::scan)) sender_.send_ranges(shaped.for_grid(), when);
  if (wanted.wants(channel::points)) {
    sender_.send_points(shaped.kept(), when, found.time_ns());
  }
}

std::vector<std::function<g4lidar::diagnostic_status()>> single_scans::reports() {
  if (!report_) return {};
  return {[this] { return report_->status(); }};
}

}  // namespace g4_tool
