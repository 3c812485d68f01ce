// SPDX-License-Identifier: MIT
#include <atomic>
#include <cstdint>
#include <deque>
#include <utility>

#include "g4lidar/odometry_feed.hpp"
#include "io/far_times.hpp"
#include "io/place_tracker.hpp"
#include "io/scan_merger.hpp"
#include "io/shape_files.hpp"
#include "scan_maker.hpp"

namespace g4_tool {
namespace {

/// How the motion is known: by the options, else by the path of a simulated robot.
deskewing deskewing_of(const serve_options& options, const std::vector<named_source>& lidars) {
  const bool is_known = has_simulated_robot(lidars.front().source);
  const deskewing wanted = options.common.deskew;
  return wanted == deskewing::none && is_known ? deskewing::by_path : wanted;
}

class merged_scans final : public scan_maker {
 public:
  merged_scans(const serve_options& options, const std::vector<named_source>& lidars,
               scan_sender& to)
      : sender_(to),
        deskew_(deskewing_of(options, lidars)),
        mask_(mask_in(options.common.mask)),
        shapers_(lidars.size()),
        merger_(deskew_, lidars, "of the first lidar") {
    shaping_options shape = shape_of(options.common, mask_);
    shape.deskew = deskew_;
    shape.for_merging = true;
    for (scan_shaper& each : shapers_) each.set_options(shape);
  }

  void open(served_lidar& from, g4lidar::lidar& /*device*/) override {
    // They are on one robot: that of the first lidar.
    if (from.index() == 0) feed_.follow(from.source().simulation());
  }

  void add(served_lidar& from, const g4lidar::scan& found) override {
    if (from.index() == 0) {
      feed_.follow(found.points, [&](const stamped_odometry& at) {
        merger_.add(at);
        from.recorder().add(at);
      });
      begun_ = feed_.begun();
    }
    if (found.is_piece()) return;
    scan_shaper& shaper = shapers_[from.index()];
    shaper.shape(found);
    const client_registry::demand wanted = sender_.wanted();
    const scan_times when{found.time_ns(), found.duration_ns, from.reader().wall_ns(0)};
    merger_.add(from.index(), shaper, when, wanted.page || wanted.wants(channel::points),
                [&](const merged_scan& all) { send(all, found.revolution, wanted); });
  }

  [[nodiscard]] std::vector<std::function<g4lidar::diagnostic_status()>> reports() override {
    return merger_.reports();
  }

 private:
  /// One call at a time.
  void send(const merged_scan& all, std::uint32_t revolution,
            const client_registry::demand& wanted) {
    const scan_stamp when{sum_ns(all.when.first_ns, all.when.ahead_ns), all.when.duration_ns};
    std::optional<lidar_place> place;
    if (deskew_ == deskewing::by_path) {
      place = tracker_.by_path(all.moved.path, {}, all.when.first_ns, begun_);
    }
    if (deskew_ == deskewing::by_scans) {
      place = tracker_.by_twist(all.moved.twist, all.when.first_ns);
    }
    if (wanted.page) {
      g4lidar::scan kept = all.kept;
      kept.revolution = revolution;
      sender_.send_page({.revolution = kept,
                         .stamp_s = static_cast<double>(when.stamp_ns) * 1e-9,
                         .place = place,
                         .points_of_each = all.kept_of_each});
    }
    if (wanted.wants(channel::scan)) sender_.send_ranges(all.for_grid, when);
    if (wanted.wants(channel::points)) sender_.send_points(all.kept, when, all.when.first_ns);
  }

  scan_sender& sender_;
  const deskewing deskew_;
  const g4lidar::mask mask_;
  std::deque<scan_shaper> shapers_;  // each of the thread of its lidar
  scan_merger merger_;
  odometry_feed feed_;  // of the thread of the first lidar
  std::atomic<std::uint64_t> begun_ = 0;
  place_tracker tracker_;
};

}  // namespace

std::unique_ptr<scan_maker> make_merged_scans(const serve_options& options,
                                              const std::vector<named_source>& lidars,
                                              scan_sender& to) {
  return std::make_unique<merged_scans>(options, lidars, to);
}

}  // namespace g4_tool
