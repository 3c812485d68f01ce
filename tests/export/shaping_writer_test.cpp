// SPDX-License-Identifier: MIT
// What a shaping_writer passes on: filtered points, other times, a range of time, a number of records.
#include "g4lidar/export/shaping_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace g4lidar::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using times = std::vector<std::int64_t>;

/// Keeps the times of what it is given.
class listener final : public point_writer {
 public:
  listener(times& heard, bool scans) : heard_(heard), scans_(scans) {}
  [[nodiscard]] bool takes_scans() const noexcept override { return scans_; }
  void write_points(std::span<const point> points, text_sink&) override {
    for (const point& p : points) heard_.push_back(p.time_ns);
  }
  void write_scan(const scan_record& record, text_sink&) override {
    heard_.push_back(record.time_ns);
  }

 private:
  times& heard_;
  bool scans_;
};

/// Ten points, one each microsecond from 1000 us on, the n-th at n degrees and n metres.
std::vector<point> ten_points() {
  std::vector<point> points(10);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].angle_deg = static_cast<float>(i);
    points[i].range_mm = static_cast<float>(i) * 1000.0F;
    points[i].time_ns = 1'000'000 + static_cast<std::int64_t>(i) * 1000;
  }
  return points;
}

class ShapingWriter : public ::testing::Test {
 protected:
  /// Writes the points in two pieces, or as two revolutions of five.
  bool write(const shaping_options& options, bool scans = false) {
    heard_.clear();
    shaping_writer writer(std::make_unique<listener>(heard_, scans), options);
    const std::vector<point> points = ten_points();
    for (const std::size_t from : {std::size_t{0}, std::size_t{5}}) {
      const auto part = std::span(points).subspan(from, 5);
      if (scans) {
        scan_record record;
        record.scan.points = part;
        record.time_ns = part.front().time_ns;
        writer.write_scan(record, sink_);
      } else {
        writer.write_points(part, sink_);
      }
    }
    return writer.is_done();
  }

  times heard_;

 private:
  struct ignore {
    void operator()(std::string_view) const {}
  };
  callback_sink<ignore> sink_{ignore{}};
};

TEST_F(ShapingWriter, ChangesNothingByDefault) {
  EXPECT_FALSE(write({}));
  EXPECT_THAT(heard_, ElementsAre(1'000'000, 1'001'000, 1'002'000, 1'003'000, 1'004'000, 1'005'000,
                                  1'006'000, 1'007'000, 1'008'000, 1'009'000));
}

TEST_F(ShapingWriter, FiltersAndCountsTimesFromTheFirstPoint) {
  shaping_options options;
  options.filter.least_range_mm = 2000.0F;
  options.filter.greatest_range_mm = 6000.0F;
  const std::array<sector, 1> ignored{sector(3.0, 4.0)};
  options.filter.ignored_sectors = ignored;
  options.time = time_style::zero;
  EXPECT_FALSE(write(options));
  EXPECT_THAT(heard_, ElementsAre(2000, 5000, 6000));
}

TEST_F(ShapingWriter, EndsAfterTheLastRecord) {
  EXPECT_TRUE(write({.count = 6}));
  EXPECT_THAT(heard_,
              ElementsAre(1'000'000, 1'001'000, 1'002'000, 1'003'000, 1'004'000, 1'005'000));
  EXPECT_TRUE(write({.count = 1}, true));
  EXPECT_THAT(heard_, ElementsAre(1'000'000));
}

TEST_F(ShapingWriter, WritesARangeOfTime) {
  EXPECT_TRUE(write({.from_ns = 3000, .to_ns = 6000}));
  EXPECT_THAT(heard_, ElementsAre(1'003'000, 1'004'000, 1'005'000));
  EXPECT_TRUE(write({.to_ns = 9000}, true)) << "the last point is at the end";
  EXPECT_THAT(heard_, ElementsAre(1'000'000));
  EXPECT_FALSE(write({.from_ns = 1}, true));
  EXPECT_THAT(heard_, ElementsAre(1'005'000));
  EXPECT_FALSE(write({.from_ns = 20'000}));
  EXPECT_THAT(heard_, IsEmpty());
}

TEST_F(ShapingWriter, LeavesOutPiecesIfRequested) {
  times heard;
  shaping_writer writer(std::make_unique<listener>(heard, true), {.partial_scans = false});
  callback_sink sink([](std::string_view) {});
  scan_record piece;
  piece.scan.flags = scan_flags::start_missing;
  writer.write_scan(piece, sink);
  writer.write_scan({.scan = {}, .time_ns = 7}, sink);
  EXPECT_THAT(heard, ElementsAre(7));
  EXPECT_EQ(writer.pieces_left_out(), 1U);
}

}  // namespace
}  // namespace g4lidar::test
