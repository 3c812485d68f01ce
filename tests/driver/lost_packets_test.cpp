// SPDX-License-Identifier: MIT
// Packets that were lost without a trace, by an overflow that ends where it began. Only the angles
// show them.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/scanner.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;

class LostPackets : public testing::Test {
 protected:
  LostPackets() {
    std::string name = (std::filesystem::temp_directory_path() / "g4lidar.XXXXXX").string();
    const int file = ::mkstemp(name.data());
    EXPECT_GE(file, 0);
    path_ = name;
  }
  ~LostPackets() override { std::filesystem::remove(path_); }

  void write(g4lidar::bytes data) {
    for (const std::uint8_t byte : data) file_.put(static_cast<char>(byte));
  }

  std::filesystem::path path_;
  std::ofstream file_;
};

TEST_F(LostPackets, NoScanWithALostPacketIsWhole) {
  file_.open(path_, std::ios::binary);
  sim::scanner scanner(sim::built_in_world(), {});
  write(sim::scan_start_reply());
  std::uint64_t lost = 0;
  for (int i = 0; i < 400; ++i) {
    const sim::sent_packet packet = scanner.next();
    if (i == 150 || (i >= 250 && i < 255)) {
      lost += packet.samples.size();
    } else {
      write(packet.data);
    }
  }
  file_.close();
  auto device = lidar::open("file:" + path_.string());
  ASSERT_TRUE(device) << device.error().message();
  ASSERT_TRUE(device->start());
  int whole = 0;
  int damaged = 0;
  while (const auto scan = device->next_scan(1s)) {
    const bool full = scan->points.size() > 1280;
    EXPECT_EQ(scan->is_whole(), full) << scan->revolution << ": " << scan->points.size();
    ++(full ? whole : damaged);
  }
  EXPECT_EQ(damaged, 2);
  EXPECT_GE(whole, 7);
  EXPECT_EQ(device->counts().samples_lost, lost);
}

}  // namespace
}  // namespace g4lidar
