// SPDX-License-Identifier: MIT
// Messages and decoders of bytes, with extreme numbers.
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "any_scan.hpp"
#include "g4lidar/background_reader.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/options/option_table.hpp"
#include "g4lidar/ostream.hpp"
#include "g4lidar/recording/bulk_decoder.hpp"
#include "g4lidar/recording/contents.hpp"
#include "g4lidar/recording/raw_bytes.hpp"
#include "numbers.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::extreme;

TEST(ExtremeOutput, Messages) {
  many_times([](test::dice& random) {
    const std::vector<point> points = several<point>(random, 30);
    const std::vector<float> values(random.below(20), any<float>(random));
    std::vector<float> ranges_m(random.below(20), any<float>(random));
    message_header header{any<std::int64_t>(random),
                          "laser",
                          any<std::int64_t>(random),
                          any<scan_order>(random),
                          any<std::size_t>(random),
                          &models[random.below(models.size())],
                          values,
                          any<float>(random)};
    std::vector<std::uint8_t> out;
    use(numbers_of(header, any<std::size_t>(random)));
    put_laser_scan(ranges_m, header, out);
    put_point_cloud2(points, header, out);
    put_cloud_points(points, header, out);
    use(cloud_fields(*header.model).size() + cloud_point_size(*header.model));
    use(quaternion_of(any<mounting>(random)));
    odometry_message odometry;
    odometry.stamp_ns = any<std::int64_t>(random);
    odometry.pose = any<pose_2d>(random);
    odometry.twist = any<twist_2d>(random);
    put_odometry(odometry, out);
    put_tf_message({any<std::int64_t>(random), "a", "b", any<mounting>(random)}, out);
    put_clock(any<std::int64_t>(random), out);
    put_recorded_bytes(std::array<std::uint8_t, 3>{}, any<std::int64_t>(random), out);
    put_diagnostic_array(std::array{diagnostic_status{.level = any<diagnostic_level>(random)}},
                         any<std::int64_t>(random), out);
    std::array<double, 7> pose{};
    std::array<double, 6> twist{};
    for (double& each : pose) each = any<double>(random);
    for (double& each : twist) each = any<double>(random);
    const auto planar = planar_odometry(any<std::int64_t>(random), pose, twist);
    EXPECT_TRUE(!planar || std::abs(planar->pose.x_m) <= max_odometry_value);
    use(fill_time_grid(points, any<std::int64_t>(random), ranges_m, any_grid(random)));
    std::vector<float> intensities;
    const scan source = any_scan(random, points);
    use(fill_time_grid(source, ranges_m, any_grid(random)));
    fill_laser_scan(source, header, 1 + random.below(20), any_grid(random), ranges_m, intensities);
  });
}

TEST(ExtremeOutput, Stamps) {
  // 32 bits of seconds end in 2038 and begin in 1901: a stamp beyond is the nearest one.
  const auto seconds_of = [](std::int64_t time_ns) {
    std::vector<std::uint8_t> out;
    put_clock(time_ns, out);
    return static_cast<std::int32_t>(load_u32(out, 4));
  };
  EXPECT_EQ(seconds_of(-1), -1);
  EXPECT_EQ(seconds_of(std::numeric_limits<std::int64_t>::max()),
            std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(seconds_of(std::numeric_limits<std::int64_t>::min()),
            std::numeric_limits<std::int32_t>::min());
}

TEST(ExtremeOutput, TextsAndDigests) {
  many_times(
      [](test::dice& random) {
        const std::vector<point> points = several<point>(random, 30);
        for (const point& p : points) use(detail::text_of(p));
        use(detail::text_of(any_scan(random, points)));
        point_digest digest;
        digest.add(points);
        payload_digest payload;
        payload.add(any<direction>(random), std::array<std::uint8_t, 3>{});
      },
      1000);
}

TEST(ExtremeOutput, Bytes) {
  many_times(
      [](test::dice& random) {
        std::vector<std::uint8_t> data(random.below(400));
        for (std::uint8_t& each : data) each = random.structural_byte();
        bulk_decoder decoder(any<instruction_set>(random));
        bytes rest = data;
        std::array<point, max_samples> made{};
        std::array<xy_point, max_samples> places{};
        use(decoder.decode(rest, made));
        use(decoder.decode_xy(rest, any<frame>(random), places));
        use(decoder.finish(made));
        use(decoder.finish_xy(any<frame>(random), places));
        use(name_of(any<instruction_set>(random)));
        stream_head head(any<std::int64_t>(random));
        head.take(data, any<std::int64_t>(random));
        use(head.is_complete(any<std::int64_t>(random)));
      },
      1000);
}

TEST(ExtremeOutput, Names) {
  with_extremes<diagnosis>([](diagnosis what) { use(describe(what)); });
  with_extremes<diagnostic_stage>([](diagnostic_stage where) { use(name_of(where)); });
  with_extremes<stage_verdict>([](stage_verdict how) { use(name_of(how)); });
  with_extremes<problem>([](problem what) {
    use(diagnosis_of(what));
    use(name_of(what));
  });
  with_extremes<reader_state>([](reader_state state) { use(name_of(state)); });
  with_extremes<lidar_event::kind>([](lidar_event::kind what) { use(name_of(what)); });
  with_extremes<task>([](task doing) { use(name_of(doing)); });
  with_extremes<recorded_event::kind>([](recorded_event::kind what) { use(name_of(what)); });
  many_times([](test::dice& random) {
    stream_counter counts;
    counts.add(skipped{any<std::size_t>(random), any<skip_reason>(random)});
    use(counts.skipped(any<skip_reason>(random)));
    counts.packets = any<std::uint64_t>(random);
    counts.parsed_bytes = any<std::uint64_t>(random);
    use(diagnosis_of(counts, any<std::uint64_t>(random)));
    use(evidence{"slowest_ms", any<double>(random)}.text());
    use(make_evidence("slowest_ms", any<std::int64_t>(random)).text());
    const error made(any<task>(random), any<problem>(random), "subject", any<int>(random));
    use(made.message());
  });
}

TEST(ExtremeOutput, Settings) {
  many_times([](test::dice& random) {
    lidar_options options;
    for (const setting_info& each : all_settings()) {
      if (const auto value = value_of(each, any<std::int32_t>(random))) {
        use(number_of(*value));
        use(change_to(*value));
        set_option(options, *value);
      }
      const answer odd[]{answer(any<low_power>(random)), answer(any<sample_rate>(random)),
                         answer(scan_frequency{any<std::uint16_t>(random)}),
                         answer(zero_angle{any<std::int32_t>(random)})};
      for (const answer& value : odd) {
        use(setting_of(value));
        use(find_value(value));
        use(number_of(value));
        use(change_to(value));
        set_option(options, value);
      }
    }
    options.frequency = scan_frequency{any<std::uint16_t>(random)};
    options.sample_rate = any<sample_rate>(random);
    options.direction = any<motor_direction>(random);
    options.idle = any<low_power>(random);
    options.baud = any<std::uint32_t>(random);
    options.device_wait = any<std::chrono::milliseconds>(random);
    options.raw_sample_rate_hz = any<std::uint32_t>(random);
    options.tuning = {
        any<std::chrono::milliseconds>(random), any<std::chrono::milliseconds>(random),
        any<std::chrono::milliseconds>(random), any<read_pace>(random),
        any<std::chrono::milliseconds>(random), any<std::chrono::nanoseconds>(random)};
    options.playback = {any<double>(random), any<bool>(random), any<std::int64_t>(random),
                        any<std::int64_t>(random)};
    use(problem_with(options).has_value());
  });
}

}  // namespace
