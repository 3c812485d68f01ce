// SPDX-License-Identifier: MIT
// The names of ports that need no search.
#include <gtest/gtest.h>

#include <string_view>

#include "g4lidar/discovery.hpp"

namespace g4lidar::test {
namespace {

TEST(SelectPort, Path_IsUsedUnchanged) {
  const auto port = select_port("/dev/no-such-port");
  ASSERT_TRUE(port);
  EXPECT_EQ(port->path, "/dev/no-such-port");
}

TEST(SelectPort, WrongForms_AreRefused) {
  for (const std::string_view wrong :
       {"serial:", "serial:123", "serial:20211010000700733", "serial:202110100007007x", "usb:"}) {
    const auto port = select_port(wrong);
    ASSERT_FALSE(port) << wrong;
    EXPECT_EQ(port.error().code(), problem::bad_option) << wrong;
    EXPECT_TRUE(port.error().subject().starts_with(wrong)) << port.error().subject();
  }
}

}  // namespace
}  // namespace g4lidar::test
