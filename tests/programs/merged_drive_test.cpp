// SPDX-License-Identifier: MIT
// Merged scans of a drive are those of merge_scans() by the twist of the leading lidar, bit for bit.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/merge.hpp"
#include "program.hpp"
#include "service/scan_merger.hpp"
#include "support/cloud_rows.hpp"
#include "support/shaped_drive.hpp"

namespace {

using g4lidar::deskewing;
using g4lidar::mounted_scan;
using g4lidar::mounting;
using g4lidar::point;
using g4lidar::scan_merger;
using g4lidar::scan_shaper;
using g4lidar::stamped_pose;

class MergedDrive : public cli::scratch {};

TEST_F(MergedDrive, IsThatOfMergeScans_BitForBit) {
  const g4lidar::test::shaped_drive drive(G4_DUMP, path("."));
  const mounting front{{0.25, 0.125, 0.5}, false};
  const mounting rear{{-0.5, 0.0, 3.0}, true};
  scan_merger merger(deskewing::by_scans, {{"front", front}, {"rear", rear}});
  const auto no_path = [](std::int64_t) { return std::span<const stamped_pose>(); };
  scan_shaper of_rear(g4lidar::test::drive_shaping());
  std::vector<point> memory(8192);
  int deskewed = 0;
  bool is_first = true;
  // The rear lidar measures the same: at once before the front one, which leads.
  g4lidar::test::shape_drive(
      drive, false, deskewing::by_scans, [&](scan_shaper& ahead, const g4lidar::scan& scan) {
        of_rear.shape(scan);
        const auto alone = merger.add(1, of_rear, scan.time_ns(), scan.duration_ns, true, no_path);
        const auto joined = merger.add(0, ahead, scan.time_ns(), scan.duration_ns, true, no_path);
        ASSERT_TRUE(joined);
        EXPECT_EQ(alone.has_value(), is_first) << "the front one leads, as soon as it has a scan";
        is_first = false;
        const std::array<mounted_scan, 2> lidars{
            {{ahead.kept().points, front}, {of_rear.kept().points, rear}}};
        const std::int64_t end_ns = scan.time_ns() + scan.duration_ns;
        const auto twist = ahead.twist();
        const g4lidar::merged all =
            twist ? merge_scans(lidars, seen_from(inverse(front.pose), *twist), end_ns, memory)
                  : merge_scans(lidars, std::span<const stamped_pose>{}, end_ns, memory);
        deskewed += twist ? 1 : 0;
        ASSERT_TRUE(g4lidar::test::rows_of(joined->kept.points, joined->reference_ns) ==
                    g4lidar::test::rows_of(all.points, end_ns))
            << scan.revolution;
      });
  EXPECT_GT(deskewed, 25);
}

}  // namespace
