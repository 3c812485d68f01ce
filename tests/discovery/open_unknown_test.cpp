// SPDX-License-Identifier: MIT
// lidar::open() at the path of a port, without a model: the search, and its open port in the hands of the
// driver.
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

class OpenUnknown : public testing::TestWithParam<std::string_view> {};

TEST_P(OpenUnknown, ScansAsItsModel) {
  sim::device_options options;
  ASSERT_TRUE(sim::use_model(options, GetParam()));
  auto served = sim::background_pty::open(sim::device(sim::built_in_world(), options));
  ASSERT_TRUE(served);
  auto opened = lidar::open(served->path());
  ASSERT_TRUE(opened) << opened.error().message();
  ASSERT_TRUE(opened->start());
  const auto got = opened->next_scan(patience);
  ASSERT_TRUE(got) << got.error().message();
  EXPECT_EQ(got->model->word, GetParam());
  EXPECT_GT(got->points.size(), 100U);
}

INSTANTIATE_TEST_SUITE_P(Models, OpenUnknown,
                         testing::Values("g4", "t-mini-pro", "x4", "x2", "tg15"),
                         [](const auto& of) {
                           std::string name(of.param);
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace g4lidar::test
