// SPDX-License-Identifier: MIT
// g4-ros2 at ports of lidars of each kind, when nobody names the model.
#include <gtest/gtest.h>

#include <csignal>
#include <cstddef>
#include <string>
#include <vector>

#include "cli/program.hpp"
#include "lidar.hpp"
#include "subscriber.hpp"

namespace ros2 {
namespace {

/// By the manuals, not by the table of the library. The longest range is that of a sample.
struct kind {
  std::string word;
  bool is_scanning;  ///< A dead host has left it scanning.
  bool has_intensity;
  float shortest_m;
  float longest_m;
};

class UnnamedModel : public cli::scratch, public testing::WithParamInterface<kind> {
 protected:
  test_domain domain_;
};

TEST_P(UnnamedModel, ScansHaveItsLimitsAndIntensities) {
  std::vector<sim::fault> faults;
  if (GetParam().is_scanning) faults.push_back(sim::make_fault(sim::fault_kind::scanning));
  const served_lidar lidar(GetParam().word, faults);
  subscriber<scan_message> scans(domain_, "/scan", dds::laser_scan);
  cli::program tool({lidar.path()});
  std::size_t count = 0;
  EXPECT_TRUE(comes_true([&] {
    scans.take([&](const scan_message& message) {
      ++count;
      EXPECT_EQ(message.intensities._length > 0, GetParam().has_intensity);
      EXPECT_FLOAT_EQ(message.range_min, GetParam().shortest_m);
      EXPECT_FLOAT_EQ(message.range_max, GetParam().longest_m);
    });
    return count >= 3;
  }));
  tool.send(SIGTERM);
  const cli::outcome end = tool.wait();
  EXPECT_EQ(end.code, 128 + SIGTERM) << end.err;
  EXPECT_EQ(end.err.find("--model names another one: x2l, x3") != std::string::npos,
            GetParam().word == "x2")
      << end.err;
}

INSTANTIATE_TEST_SUITE_P(Models, UnnamedModel,
                         testing::Values(kind{"x4", false, false, 0.12F, 10.0F},
                                         kind{"x2", false, false, 0.1F, 8.0F},
                                         kind{"t-mini-pro", false, true, 0.02F, 12.0F},
                                         kind{"tg15", false, false, 0.05F, 30.0F},
                                         kind{"g6", false, false, 0.1F, 25.0F},
                                         kind{"t-mini-plus-sh", false, true, 0.05F, 25.0F},
                                         kind{"g2", true, true, 0.1F, 16.0F}),
                         [](const auto& of) {
                           std::string name = of.param.word;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace ros2
