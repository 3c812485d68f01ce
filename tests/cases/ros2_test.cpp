// SPDX-License-Identifier: MIT
// The cases through g4-ros2, as readers of its scans and clouds see them: in real time.
#include <csignal>
#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include "cli/program.hpp"
#include "g4lidar/options/option_table.hpp"
#include "ros2/subscriber.hpp"
#include "table.hpp"

namespace cases {
namespace {

using namespace ros2;

std::string flag(const std::string& name) {
  const g4lidar::parameter* const row = g4lidar::find_parameter(name);
  if (row != nullptr && row->kind == g4lidar::parameter_kind::device) return "--set=" + name;
  return row == nullptr ? "--" + name : g4lidar::flag_of(*row);
}

class Ros2 : public testing::TestWithParam<json> {
 protected:
  static void read(const cloud_message& cloud, outcome& seen) {
    seen.hits.clear();
    std::size_t intensity_at = 0;
    for (std::size_t i = 0; i < cloud.fields._length; ++i) {
      if (std::string(cloud.fields._buffer[i].name) == "intensity")
        intensity_at = cloud.fields._buffer[i].offset;
    }
    for (std::size_t at = 0; at < cloud.data._length; at += cloud.point_step) {
      float xy[2];
      float intensity = 0;
      std::memcpy(xy, cloud.data._buffer + at, sizeof xy);
      if (intensity_at != 0)
        std::memcpy(&intensity, cloud.data._buffer + at + intensity_at, sizeof intensity);
      seen.add(xy[0], xy[1], static_cast<unsigned>(intensity));
    }
    seen.samples =
        static_cast<double>(seen.hits.size());  // the room has no direction without a return
  }
  test_domain domain_;
};

TEST_P(Ros2, DoesIt) {
  std::vector<std::string> words = words_of(GetParam(), flag);
  words.push_back(source_of(GetParam()));
  if (GetParam().contains("error")) {
    const cli::outcome end = cli::run(words);
    return check(GetParam(), "ros2", {std::to_string(end.code), end.err});
  }
  if (!is_simulated(GetParam())) words.emplace_back("--loop");
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  subscriber<cloud_message> clouds(domain_, "/points", dds::point_cloud2);
  cli::program tool(words);
  outcome seen;
  std::size_t taken = 0;
  EXPECT_TRUE(comes_true([&] {
    scans.take([&](const scan_message& scan) {
      seen.shortest_m = static_cast<double>(scan.range_min);
      seen.longest_m = static_cast<double>(scan.range_max);
    });
    taken += clouds.take([&](const cloud_message& cloud) { read(cloud, seen); });
    // A message does not state whether its revolution is whole: a busy machine loses bytes.
    const double samples = GetParam().at("expect").value("samples", seen.samples.value_or(0));
    return taken >= 12 && seen.longest_m &&
           std::fabs(*seen.samples - samples) <= 2 + 0.01 * samples;
  }));
  tool.send(SIGTERM);
  EXPECT_EQ(tool.wait().code, 128 + SIGTERM);
  check(GetParam(), "ros2", seen);
}

INSTANTIATE_TEST_SUITE_P(Case, Ros2, testing::ValuesIn(of_door("ros2")), name_in_test);

}  // namespace
}  // namespace cases
