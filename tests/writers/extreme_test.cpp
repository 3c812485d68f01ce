// SPDX-License-Identifier: MIT
// Writers and readers of points, with extreme numbers.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "export/digits.hpp"
#include "export/pcd.hpp"
#include "export/point_file.hpp"
#include "export/point_writer.hpp"
#include "export/protocol_log.hpp"
#include "export/shaping_writer.hpp"
#include "export/slam_text.hpp"
#include "export/svg.hpp"
#include "export/text_points.hpp"
#include "export/time_shift.hpp"
#include "extreme/any_scan.hpp"
#include "extreme/number_texts.hpp"
#include "extreme/numbers.hpp"
#include "io/odometry_text.hpp"

namespace g4lidar::extreme {
namespace {

using namespace g4_tool;

/// Counts what is written.
class counting_sink final : public text_sink {
 public:
  std::size_t size = 0;

 private:
  void take(std::string_view text) override { size += text.size(); }
};

TEST(ExtremeWriters, Writers) {
  counting_sink sink;
  many_times(
      [&](test::dice& random) {
        const std::vector<point> points = several<point>(random, 30);
        const text_style style{
            any<text_format>(random),   any<bool>(random),        any<frame>(random),
            any<std::uint16_t>(random), any<length_unit>(random), any<bool>(random),
            any<bool>(random),          any<bool>(random),        any<unsigned>(random) % 1000};
        const scan_record record{any_scan(random, points), any<std::int64_t>(random),
                                 any<double>(random), any<pose_2d>(random)};
        std::array<std::unique_ptr<point_writer>, 4> writers{
            make_point_writer(style),
            make_grid_writer(style, 1 + random.below(20), any_grid(random)),
            make_carmen_writer(2 + random.below(20), any<mounting>(random)), make_tum_writer()};
        for (auto& writer : writers) {
          writer->begin(sink);
          writer->takes_scans() ? writer->write_scan(record, sink)
                                : writer->write_points(points, sink);
        }
        for (const auto format : values<point_file_format>()) {
          const auto writer = make_point_file_writer(format, any<frame>(random));
          writer->begin(sink);
          writer->write_points(points, sink);
          writer->end(sink);
          use(writer->first_bytes());
        }
        write_pcd(points, any<frame>(random), any<pcd_data>(random), sink);
        write_svg(points, sink, any<std::uint16_t>(random));
        write_tum_pose(any<stamped_pose>(random), sink);
        const std::vector<float> ranges_m(2 + random.below(9), any<float>(random));
        write_carmen_scan({ranges_m, any<float>(random), any<pose_2d>(random), any<pose_2d>(random),
                           any<std::int64_t>(random)},
                          sink);
        sink.flush();
      },
      1000);
}

TEST(ExtremeWriters, Shaping) {
  counting_sink sink;
  many_times(
      [&](test::dice& random) {
        writing_options how;
        how.shape.marks.speckle = speckle_limits{.window = any<std::size_t>(random)};
        how.sample_rate_hz = any<std::uint32_t>(random);
        how.time = any<time_style>(random);
        how.wall_ahead_ns = any<std::int64_t>(random);
        how.from_ns = any<std::int64_t>(random);
        how.to_ns = any<std::int64_t>(random);
        how.count = any<std::uint64_t>(random);
        shaping_writer writer(make_point_writer({.scans = any<bool>(random)}), how);
        writer.begin(sink);
        for (int i = 0; i < 5; ++i) {
          const std::vector<point> points = several<point>(random, 30);
          const scan_record record{any_scan(random, points), any<std::int64_t>(random),
                                   any<double>(random)};
          writer.takes_scans() ? writer.write_scan(record, sink)
                               : writer.write_points(points, sink);
        }
        writer.finish(sink);
      },
      1000);
}

TEST(ExtremeWriters, Bytes) {
  counting_sink sink;
  many_times(
      [&](test::dice& random) {
        std::vector<std::uint8_t> data(random.below(400));
        for (std::uint8_t& each : data) each = random.structural_byte();
        protocol_log log({.lines = any<std::uint64_t>(random)}, time_shift(time_style::delta, 0),
                         sink);
        log.from_device(data, any<std::int64_t>(random));
        log.to_device(std::array<std::uint8_t, 2>{0xA5, random.byte()}, any<std::int64_t>(random));
        log.remark("opened", any<std::int64_t>(random));
        log.finish();
        use(word_for_command(random.byte()));
      },
      1000);
}

TEST(ExtremeWriters, Digits) {
  std::array<char, 128> text{};
  with_extremes<double>([&](double x) {
    use(digits::put_fixed<1>(text.data(), x) - text.data());
    use(digits::put_fixed<6>(text.data(), x) - text.data());
    use(digits::put_angle<6>(text.data(), x) - text.data());
    use(digits::put_signed_angle<6>(text.data(), x) - text.data());
    use(digits::nearest(x));
  });
  with_extremes<std::uint64_t>([&](std::uint64_t number) {
    EXPECT_LE(digits::put_number(text.data(), number) - text.data(), 20);
    EXPECT_LE(digits::put_scaled<1>(text.data(), number) - text.data(), 21);
    EXPECT_LE(digits::put_scaled<6>(text.data(), number) - text.data(), 21);
  });
  with_extremes<std::int64_t>([&](std::int64_t number) {
    EXPECT_LE(digits::put_number(text.data(), number) - text.data(), 20);
  });
}

TEST(ExtremeWriters, Points) {
  std::string written;
  callback_sink sink([&](std::string_view text) { written += text; });
  many_times([&](test::dice& random) {
    const bool is_csv = any<bool>(random);
    const bool is_m = any<bool>(random);
    const std::string unit = is_m ? "range_m" : "range_mm";
    std::string text = is_csv ? "scan,angle_deg," + unit + ",time_ns,intensity,sample_flags\n" : "";
    for (int i = 0; i < 3; ++i) {
      text += is_csv ? any_numbers(random, 6, ",") + "\n"
                     : R"({"scan":)" + any_number(random) + R"(,"angle_deg":)" +
                           any_number(random) + ",\"" + unit + "\":" + any_number(random) +
                           R"(,"time_ns":)" + any_number(random) + "}\n";
    }
    const auto writer = make_point_writer({.scans = any<bool>(random)});
    text_points reader(is_csv ? text_source::csv : text_source::jsonl, any<frame>(random), *writer,
                       sink);
    reader.take(text);
    reader.finish();
    sink.flush();
  });
  // What a writer can write: see point_writer.
  point_lines lines(text_source::jsonl, frame::vendor);
  EXPECT_TRUE(lines.read(R"({"angle_deg":1,"range_m":99999})"));
  EXPECT_FALSE(lines.read(R"({"angle_deg":1,"range_m":100000})"));
  EXPECT_FALSE(lines.read(R"({"angle_deg":1,"range_m":99999999})"));
  EXPECT_FALSE(lines.read(R"({"angle_deg":1,"range_mm":1e8})"));
  EXPECT_FALSE(lines.read(R"({"angle_deg":nan,"range_mm":1})"));
  EXPECT_FALSE(lines.read(R"({"angle_deg":1,"range_mm":inf})"));
}

TEST(ExtremeWriters, Odometry) {
  many_times([](test::dice& random) {
    std::string text;
    for (int i = 0; i < 3; ++i) text += any_numbers(random, 4, " ") + "\n";
    const auto read = parse_odometry(text);
    if (const auto* const path = std::get_if<std::vector<stamped_pose>>(&read)) {
      use(pose_at(*path, any<std::int64_t>(random)));
    }
  });
}

TEST(ExtremeWriters, TimeShifts) {
  many_times([](test::dice& random) {
    time_shift shift(any<time_style>(random), any<std::int64_t>(random));
    shift.arrived(any<std::int64_t>(random));
    for (int i = 0; i < 5; ++i) {
      use(shift.of(any<std::int64_t>(random)));
      shift.set_wall_ahead(any<std::int64_t>(random));
      use(shift.changes_nothing());
    }
  });
}

}  // namespace
}  // namespace g4lidar::extreme
