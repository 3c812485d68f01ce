// SPDX-License-Identifier: MIT
// Points from lines of text: each value, and which one is wrong.
#include "export/text_points.hpp"

#include <gtest/gtest.h>

#include <string>

#include "written.hpp"

namespace g4lidar::test {
namespace {

using namespace g4_tool;

/// The line of csv below this header.
std::optional<read_point> csv(point_lines& lines, const char* header, const char* line) {
  EXPECT_FALSE(lines.read(header));
  return lines.read(line);
}

TEST(PointLines, HaveIntensityAndFlags) {
  point_lines lines(text_source::csv, frame::vendor, *model_named("t-mini"));
  const auto read = csv(lines, "sample_flags,range_mm,intensity,angle_deg", "3,500,65535,10");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->point.intensity, 65'535);
  EXPECT_EQ(read->point.sample_flags, 3);
  EXPECT_TRUE(lines.has_intensity() && lines.has_sample_flags());
  EXPECT_EQ(lines.unexpected(), "");
  point_lines json(text_source::jsonl, frame::vendor, *model_named("t-mini"));
  const auto object =
      json.read(R"({"angle_deg":10,"range_mm":500,"intensity":300, "sample_flags": 2})");
  ASSERT_TRUE(object);
  EXPECT_EQ(object->point.intensity, 300);
  EXPECT_EQ(object->point.sample_flags, 2);
}

TEST(PointLines, WithoutThem_HaveNone) {
  point_lines lines(text_source::csv, frame::vendor, *model_named("t-mini"));
  const auto read = csv(lines, "angle_deg,range_mm", "10,500");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->point.intensity, 0);
  EXPECT_EQ(read->point.sample_flags, 0);
  EXPECT_FALSE(lines.has_intensity() || lines.has_sample_flags());
}

TEST(PointLines, StateWhatTheModelDoesNotHave) {
  const auto unexpected = [](const char* model, const char* header) {
    point_lines lines(text_source::csv, frame::vendor, *model_named(model));
    EXPECT_FALSE(lines.read(header));
    return lines.unexpected();
  };
  EXPECT_EQ(unexpected("g4", "angle_deg,range_mm,intensity"), "intensity");
  EXPECT_EQ(unexpected("g4", "angle_deg,range_mm,sample_flags"), "sample_flags");
  EXPECT_EQ(unexpected("x4", "angle_deg,range_mm,sample_flags"), "");
  EXPECT_EQ(unexpected("x4", "angle_deg,range_mm,intensity,sample_flags"), "intensity");
  EXPECT_EQ(unexpected("g2", "angle_deg,range_mm,intensity"), "");
  EXPECT_EQ(unexpected("g2", "angle_deg,range_mm,intensity,sample_flags"), "sample_flags");
}

TEST(PointLines, StateTheColumnWithoutAValidValue) {
  const auto bad = [](const char* line) {
    point_lines lines(text_source::csv, frame::vendor, *model_named("t-mini"));
    EXPECT_FALSE(csv(lines, "scan,angle_deg,range_mm,time_ns,intensity,sample_flags", line))
        << line;
    return lines.bad_column();
  };
  EXPECT_EQ(bad("-1,10,500,0,1,1"), "scan");
  EXPECT_EQ(bad("0,361,500,0,1,1"), "angle_deg");
  EXPECT_EQ(bad("0,10,-5,0,1,1"), "range_mm");
  EXPECT_EQ(bad("0,10,500,soon,1,1"), "time_ns");
  EXPECT_EQ(bad("0,10,500,0,65536,1"), "intensity");
  EXPECT_EQ(bad("0,10,500,0,1,4"), "sample_flags");
  point_lines metres(text_source::csv, frame::vendor);
  EXPECT_FALSE(csv(metres, "angle_deg,range_m", "1,far"));
  EXPECT_EQ(metres.bad_column(), "range_m");
}

class counting final : public point_writer {
 public:
  [[nodiscard]] bool takes_scans() const noexcept override { return false; }
  void write_points(std::span<const point> points, text_sink&) override { count += points.size(); }
  std::size_t count = 0;
};

TEST(TextPoints, CountTheLinesWithoutAPoint_FromTheFirstOneOn) {
  counting writer;
  static_cast<void>(written([&](text_sink& out) {
    text_points way(text_source::csv, frame::vendor, writer, out);
    way.take("angle_deg,range_mm\n1,500\n\n" + std::string(70'000, '1'));
    way.take("\n2,far\n");
    way.take("3,500\n4,");
    way.finish();
    EXPECT_EQ(way.points(), 2U);
    EXPECT_EQ(way.bad_lines(), 3U);
    EXPECT_EQ(way.first_bad_line().number, 4U);
    EXPECT_EQ(way.first_bad_line().column, "") << "it is too long";
  }));
  EXPECT_EQ(writer.count, 2U);
  static_cast<void>(written([&](text_sink& out) {
    text_points way(text_source::csv, frame::vendor, writer, out);
    way.take("angle_deg,range_mm\r\n1,500\r\n\r\n2,far\r\n");
    way.finish();
    EXPECT_EQ(way.first_bad_line().number, 4U);
    EXPECT_EQ(way.first_bad_line().column, "range_mm");
  }));
}

TEST(TextPoints, EndWhereTheWriterOfTheModelWouldLoseValues) {
  counting writer;
  static_cast<void>(written([&](text_sink& out) {
    text_points way(text_source::jsonl, frame::vendor, writer, out);
    way.take("{\"angle_deg\":1,\"range_mm\":500}\n");
    EXPECT_EQ(way.unexpected(), "");
    way.take(
        "{\"angle_deg\":1,\"range_mm\":500,\"intensity\":7}\n{\"angle_deg\":1,\"range_mm\":500}\n");
    way.finish();
    EXPECT_EQ(way.unexpected(), "intensity");
    EXPECT_EQ(way.points(), 1U);
    EXPECT_EQ(way.bad_lines(), 0U);
  }));
}

}  // namespace
}  // namespace g4lidar::test
