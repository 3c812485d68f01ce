// SPDX-License-Identifier: MIT
// What a shaping_writer passes on: filtered points, other times, a range of time, a number of records.
#include "export/shaping_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace g4lidar::test {
namespace {

using namespace g4_tool;
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
  bool write(const writing_options& options, bool scans = false) {
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
  writing_options options;
  options.shape.filter.least_range_mm = 2000.0F;
  options.shape.filter.greatest_range_mm = 6000.0F;
  const std::array<sector, 1> ignored{sector(3.0, 4.0)};
  options.shape.filter.ignored_sectors = ignored;
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

/// 40 points at 4 m; numbers 0, 7, 20 and 39 are at 2 m, number 30 without return.
std::vector<point> wall_with_specks() {
  std::vector<point> points(40);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].angle_deg = static_cast<float>(i) * 0.25F;
    points[i].range_mm = i == 0 || i == 7 || i == 20 || i == 39 ? 2000.0F : 4000.0F;
    points[i].time_ns = static_cast<std::int64_t>(i);
  }
  points[30].range_mm = 0.0F;
  points[30].flags = point_flags::no_return;
  return points;
}

// The points of a stream come in any pieces, and neighbours may be in different ones.
TEST(ShapingWriterSpeckle, DoesNotDependOnThePieces) {
  const std::vector<point> points = wall_with_specks();
  callback_sink sink([](std::string_view) {});
  for (const std::size_t size : {1U, 2U, 3U, 7U, 39U, 40U}) {
    times heard;
    shaping_writer writer(
        std::make_unique<listener>(heard, false),
        {.shape = {.marks = {.speckle = speckle_limits{.window = 3}, .edges = edge_limits{}}}});
    for (std::size_t from = 0; from < points.size(); from += size) {
      writer.write_points(std::span(points).subspan(from, std::min(size, points.size() - from)),
                          sink);
      const std::size_t known =
          std::min(from + size, points.size()) - std::min<std::size_t>(from + size, 3);
      ASSERT_TRUE(heard.empty() || heard.back() < static_cast<std::int64_t>(known));
    }
    writer.finish(sink);
    writer.finish(sink);
    times expected;
    for (std::int64_t i = 0; i < 40; ++i) {
      if (i != 0 && i != 7 && i != 20 && i != 39) expected.push_back(i);
    }
    EXPECT_EQ(heard, expected) << size;
  }
}

TEST(ShapingWriterSpeckle, TheEndOfTheRangeOfTime_WritesWhatWaited) {
  times heard;
  callback_sink sink([](std::string_view) {});
  shaping_writer writer(std::make_unique<listener>(heard, false),
                        {.shape = {.marks = {.speckle = speckle_limits{}}}, .to_ns = 6});
  const std::vector<point> points = wall_with_specks();
  writer.write_points(std::span(points).first(5), sink);
  EXPECT_THAT(heard, ElementsAre(1, 2));
  writer.write_points(std::span(points).subspan(5), sink);
  EXPECT_THAT(heard, ElementsAre(1, 2, 3, 4, 5));
  EXPECT_TRUE(writer.is_done());
  writer.finish(sink);
  EXPECT_EQ(heard.size(), 5U);
}

// The ends of a whole revolution are neighbours, those of a piece are not.
TEST(ShapingWriterSpeckle, OfARevolution) {
  class counter final : public point_writer {
   public:
    explicit counter(std::vector<std::size_t>& sizes) : sizes_(sizes) {}
    [[nodiscard]] bool takes_scans() const noexcept override { return true; }
    void write_scan(const scan_record& record, text_sink&) override {
      sizes_.push_back(record.scan.size());
    }

   private:
    std::vector<std::size_t>& sizes_;
  };
  std::vector<point> points = wall_with_specks();
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i].angle_deg = static_cast<float>(i) * 9.0F;
  points.back().angle_deg = 359.75F;  // it and the first one are near each other
  callback_sink sink([](std::string_view) {});
  std::vector<std::size_t> sizes;
  shaping_writer writer(std::make_unique<counter>(sizes),
                        {.shape = {.marks = {.speckle = speckle_limits{.near_ratio = 0.05F}}}});
  scan_record record;
  record.scan.points = points;
  writer.write_scan(record, sink);
  record.scan.flags = scan_flags::start_missing;
  writer.write_scan(record, sink);
  writer.finish(sink);
  EXPECT_THAT(sizes, ElementsAre(3, 1)) << "with the point without return";
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

/// Keeps the points that it is given.
class keeper final : public point_writer {
 public:
  keeper(std::vector<point>& kept, bool scans) : kept_(kept), scans_(scans) {}
  [[nodiscard]] bool takes_scans() const noexcept override { return scans_; }
  void write_points(std::span<const point> points, text_sink&) override {
    kept_.insert(kept_.end(), points.begin(), points.end());
  }
  void write_scan(const scan_record& record, text_sink& out) override {
    write_points(record.scan.points, out);
  }

 private:
  std::vector<point>& kept_;
  bool scans_;
};

// Beams near each other: a return at 0.4 m, then nothing, in each of two revolutions. At 4 kHz a G4 has returns
// from 0.1 m on, and 0.4 m is not near.
TEST(ShapingWriterNear, FlagsAcrossRevolutions_OfScansAndOfPoints_AndLeavesNothingOut) {
  for (const bool scans : {true, false}) {
    for (const auto& [speckle, rate_hz] :
         {std::pair(true, 0U), std::pair(false, 9000U), std::pair(false, 4000U)}) {
      SCOPED_TRACE(testing::Message() << scans << speckle << rate_hz);
      std::vector<point> kept;
      writing_options options{.shape = {.marks = {.near = near_limits{}}},
                              .sample_rate_hz = rate_hz};
      if (speckle) options.shape.marks.speckle = speckle_limits{};
      shaping_writer writer(std::make_unique<keeper>(kept, scans), options);
      callback_sink sink([](std::string_view) {});
      for (std::uint32_t revolution = 0; revolution < 2; ++revolution) {
        std::vector<point> points(9);
        for (point& p : points) {
          p.angle_deg = 100.0F;
          p.range_mm = revolution == 0 ? 400.0F : 0.0F;
          // Without return, the same beam has a direction 3.1 degrees less.
          if (revolution == 1) p = {.angle_deg = 96.9F, .flags = point_flags::no_return};
          p.revolution = revolution;
        }
        scan_record record;
        record.scan.points = points;
        if (rate_hz != 0) record.scan.sample_rate_hz = rate_hz;
        if (scans) {
          writer.write_scan(record, sink);
        } else {
          writer.write_points(points, sink);
        }
      }
      writer.finish(sink);
      ASSERT_EQ(kept.size(), 18U);
      for (std::size_t i = 0; i < kept.size(); ++i) {
        EXPECT_EQ(kept[i].may_be_too_near(), i >= 9 && rate_hz != 4000) << i;
      }
    }
  }
}

}  // namespace
}  // namespace g4lidar::test
