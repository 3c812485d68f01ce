// SPDX-License-Identifier: MIT
// Packets that were lost without a trace, by an overflow that ends where it began, and packets with
// wrong angles. Only the angles show them.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "support/packet_maker.hpp"

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
  while (const auto scan = device->try_scan(1s)) {
    const bool full = scan->points.size() > 1280;
    EXPECT_EQ(scan->is_whole(), full) << scan->revolution << ": " << scan->points.size();
    ++(full ? whole : damaged);
  }
  EXPECT_EQ(damaged, 2);
  EXPECT_GE(whole, 7);
  EXPECT_EQ(device->counts().samples_lost, lost);
}

/// Adds the ranges of the points that are flagged unlikely.
void add_unlikely(std::span<const point> points, std::vector<float>& ranges_mm) {
  for (const point& p : points) {
    if ((p.flags & point_flags::unlikely) != point_flags::none) ranges_mm.push_back(p.range_mm);
  }
}

// Of two packets in turn the first half is lost, and one as a whole, without a trace: then the one
// after it is flagged, too.
TEST_F(LostPackets, OnlyAPacketWithWrongAnglesIsUnlikely) {
  file_.open(path_, std::ios::binary);
  sim::scanner scanner(sim::built_in_world(), {});
  std::vector<float> after_loss;
  std::vector<float> expected;
  write(sim::scan_start_reply());
  for (int i = 0; i < 400; ++i) {
    const sim::sent_packet packet = scanner.next();
    bytes data = packet.data;
    const packet_view view = *packet_view::from(data);
    made::packet turned(view.ct(), (view.first_angle_64ths() + 640) % turn_64ths,
                        (view.last_angle_64ths() + 640) % turn_64ths, view.sample_count());
    for (std::size_t k = 0; k < view.sample_count(); ++k) {
      turned.set(k, view.sample(k));
      const float range_mm = static_cast<float>(view.sample(k)) * 0.25F;
      if (i == 151) after_loss.push_back(range_mm);
      if (i == 200) expected.push_back(range_mm);
    }
    if (i == 200) data = turned.data();
    if (i == 220 || i == 221) data = data.last(data.size() / 2);
    if (i != 150) write(data);
  }
  file_.close();
  ASSERT_EQ(expected.size(), 40U);
  auto device = lidar::open("file:" + path_.string());
  ASSERT_TRUE(device) << device.error().message();
  ASSERT_TRUE(device->start());
  std::vector<float> found;
  while (const auto scan = device->try_scan(1s)) add_unlikely(scan->points, found);
  after_loss.insert(after_loss.end(), expected.begin(), expected.end());
  EXPECT_EQ(found, after_loss);
}

}  // namespace
}  // namespace g4lidar
