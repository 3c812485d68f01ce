// SPDX-License-Identifier: MIT
// Extreme numbers in texts and files: each parser refuses them, or what it gives can be used.
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/options/lidar_parameters.hpp"
#include "g4lidar/options/option_table.hpp"
#include "g4lidar/sim/odometry.hpp"
#include "g4lidar/sim/ray_caster.hpp"
#include "g4lidar/sim/setup.hpp"
#include "number_texts.hpp"
#include "numbers.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::extreme;

TEST(ExtremeText, Masks) {
  many_times([](test::dice& random) {
    use(parse_mask("polygon " + any_numbers(random, 6, " ")).index());
  });
}

TEST(ExtremeText, Worlds) {
  many_times([](test::dice& random) {
    std::string text = "lidar " +
                       (random.below(2) == 0 ? any_numbers(random, 3, " ") : std::string("0 0 0")) +
                       "\n";
    text += "wall " +
            (random.below(2) == 0 ? any_numbers(random, 4, " ") : std::string("1 0 1 1")) + "\n";
    if (random.below(2) == 0) text += "disc " + any_numbers(random, 3, " ") + "\n";
    if (random.below(2) == 0) text += "walker " + any_numbers(random, 6, " ") + "\n";
    const auto read = sim::parse_world(text);
    if (const auto* const scene = std::get_if<sim::world>(&read)) {
      sim::scene_caster caster(*scene);
      use(caster.cast(12.0, caster.lidar_at(5'000'000'000), 5'000'000'000, false));
    }
    std::string route;
    for (int i = 0; i < 3; ++i) {
      route += random.below(2) == 0 ? "pose " + any_numbers(random, 4, " ")
                                    : std::string("drive ") +
                                          std::vector<std::string>{"forward", "turn", "arc",
                                                                   "wait"}[random.below(4)] +
                                          " " + any_numbers(random, 1 + random.below(3), " ");
      route += "\n";
    }
    const auto way = sim::parse_path(route, {});
    if (const auto* const path = std::get_if<std::vector<sim::path_point>>(&way)) {
      use(sim::robot_at(*path, any<std::int64_t>(random)));
    }
  });
}

TEST(ExtremeText, Setups) {
  for (const char* const name : {"seed",
                                 "baud",
                                 "batch_min_ns",
                                 "batch_max_ns",
                                 "reaction_ns",
                                 "acceleration_mhz_per_s",
                                 "motor_drift_ppm",
                                 "motor_drift_period_ns",
                                 "time_packet_ns",
                                 "boot_ns",
                                 "highest_frequency_chz",
                                 "zero_angle_cdeg",
                                 "pitch_cdeg",
                                 "scan_frequency_chz",
                                 "sample_rate",
                                 "samples_per_packet",
                                 "zero_deg",
                                 "index_deg",
                                 "start_deg",
                                 "min_range_mm",
                                 "max_range_mm",
                                 "noise_mm",
                                 "noise_ratio",
                                 "dropout_ratio",
                                 "sample_rate_ratio",
                                 "sample_rate_drift_ppm",
                                 "model_id",
                                 "firmware",
                                 "ordinary_ct",
                                 "truth_capacity",
                                 "log_capacity"}) {
    for (const std::string& number : numbers) {
      sim::setup made;
      const std::string wrong = sim::set(made, std::string(name) + "=" + number);
      if (!wrong.empty() || !sim::problem_with(made.device).empty()) continue;
      made.device.truth_capacity = 100;
      made.device.log_capacity = 100;
      sim::device device(sim::world{}, made.device);
      std::array<std::uint8_t, 64> out{};
      device.write(std::array<std::uint8_t, 2>{0xA5, 0x60}, 1000);
      use(device.read(out, 1'000'000'000));
    }
  }
  many_times([](test::dice& random) {
    const std::string unit =
        std::vector<std::string>{"ns", "us", "ms", "s", "min", "%", ""}[random.below(7)];
    for (const std::string& text : {"batch=" + any_number(random) + unit + "@" +
                                        any_number(random) + "s+" + any_number(random) + unit,
                                    "flip*" + any_number(random) + unit,
                                    "burst=" + any_number(random) + "*" + any_number(random) +
                                        "%@" + any_number(random) + unit}) {
      const auto read = sim::parse_fault(text);
      if (const auto* const fault = std::get_if<sim::fault>(&read))
        use(sim::problem_with(*fault).size());
    }
  });
}

TEST(ExtremeText, FiltersAndMountings) {
  many_times(
      [](test::dice& random) {
        filter_settings settings;
        for (const std::string& name :
             {std::string("range"), std::string("fov"), std::string("ignore")}) {
          use(set_filter(settings, name, any_numbers(random, 2, ":")).size());
        }
        use(set_filter(settings, "speckle",
                       "window=" + any_number(random) + ",count=" + any_number(random) +
                           ",near=" + any_number(random) + ",ratio=" + any_number(random))
                .size());
        use(set_filter(settings, "edges",
                       "window=" + any_number(random) + ",angle=" + any_number(random))
                .size());
        use(set_filter(settings, "near",
                       "shortest=" + any_number(random) + ",revolutions=" + any_number(random))
                .size());
        for (const std::string_view name : {"speckle", "edges", "near"}) {
          for (const std::string_view word : filter_words(name))
            use(set_filter(settings, name, std::string(word) + "=" + any_number(random)).size());
        }
        use(settings.filter.keeps(any<point>(random)));
        const auto mount = mounting_in(any_numbers(random, 3, ","));
        if (const auto* const place = std::get_if<mounting>(&mount)) use(quaternion_of(*place));
      },
      1000);
}

TEST(ExtremeText, Parameters) {
  for (const setting_info& each : all_settings()) {
    for (const std::string& number : numbers) {
      const auto made = value_in(each, number);
      if (made) use(change_to(*made));
      use(answer_of(each, number).has_value());
    }
    with_extremes<double>([&](double number) { use(answer_of(each, number).has_value()); });
    with_extremes<std::int64_t>(
        [&](std::int64_t number) { use(answer_of(each, number).has_value()); });
    with_extremes<std::int32_t>(
        [&](std::int32_t number) { use(value_of(each, number).has_value()); });
  }
  many_times(
      [](test::dice& random) {
        lidar_parameters parameters;
        lidar_options options;
        for (const parameter& each : all_parameters()) {
          for (const parameter_value& number :
               {parameter_value(any<double>(random)), parameter_value(any<std::int64_t>(random)),
                parameter_value(any_number(random))}) {
            const std::vector<named_value> wanted{{std::string(each.name), number}};
            use(parameters.change(nullptr, wanted).size());
            use(set_option(options, each, number).size());
          }
          use(parameters.value(each).index());
          use(each.is_of(any<std::uint8_t>(random)));
        }
        use(problem_with(options).has_value());
      },
      100);
}

}  // namespace
