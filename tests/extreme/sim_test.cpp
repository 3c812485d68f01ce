// SPDX-License-Identifier: MIT
// The simulator, with extreme numbers in everything that a program gives it.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/odometry.hpp"
#include "g4lidar/sim/random.hpp"
#include "g4lidar/sim/ray_caster.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "g4lidar/sim/setup.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "numbers.hpp"
#include "sim/arithmetic.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::extreme;

sim::pose any_place(test::dice& random) {
  return {any<double>(random), any<double>(random), any<double>(random)};
}

TEST(ExtremeSim, Arithmetic) {
  with_extremes<double>([](double x) {
    const sim::sin_cos turned = sim::sin_cos_deg(x);
    EXPECT_TRUE(!(std::abs(turned.sine) > 1.0 + 1e-9) || std::abs(x) > 1e9) << x;
    EXPECT_EQ(std::isnan(sim::atan_deg(x)), std::isnan(x)) << x;
    use(sim::correction_deg(x));
  });
  with_extremes<double, double>([](double y, double x) { use(sim::atan2_deg(y, x)); });
  with_extremes<std::uint64_t, std::uint64_t>([](std::uint64_t seed, std::uint64_t purpose) {
    sim::random_stream random(seed, purpose);
    EXPECT_LT(random.uniform(), 1.0);
    use(random.gaussian());
  });
  with_extremes<std::uint8_t>([](std::uint8_t code) {
    sim::command_set commands{code};
    EXPECT_TRUE(commands.has(code));
  });
}

TEST(ExtremeSim, Paths) {
  many_times([](test::dice& random) {
    std::vector<sim::path_point> path(1 + random.below(5));
    for (sim::path_point& each : path)
      each = {any<std::int64_t>(random), {any_place(random), any_place(random)}};
    if (random.below(2) == 0) std::ranges::sort(path, {}, &sim::path_point::time_ns);
    sim::smooth(path);
    use(sim::robot_at(path, any<std::int64_t>(random)));
    use(sim::placed(any_place(random), any_place(random)));
    use(sim::cable_pose(any_place(random)));
  });
}

// A world that breaks every rule: casting ends, and gives something or nothing.
TEST(ExtremeSim, Casting) {
  many_times(
      [](test::dice& random) {
        sim::world scene;
        for (std::size_t i = random.below(4); i-- > 0;)
          scene.walls.push_back(
              {any<double>(random), any<double>(random), any<double>(random), any<double>(random)});
        for (std::size_t i = random.below(3); i-- > 0;) {
          scene.discs.push_back({any<double>(random), any<double>(random), any<double>(random),
                                 any<double>(random), any<double>(random), any<double>(random)});
        }
        scene.lidar = any_place(random);
        scene.mounted_at = any_place(random);
        if (random.below(2) == 0)
          scene.path = {{any<std::int64_t>(random), {any_place(random), any_place(random)}}};
        const sim::beam_shape shape =
            random.below(2) == 0 ? sim::triangle_beam
                                 : sim::beam_shape{any<double>(random), any<double>(random),
                                                   any<double>(random), any<double>(random)};
        const sim::ray_caster walls(scene, shape);
        use(walls.cast(any<double>(random)));
        sim::scene_caster all(scene, shape, any<bool>(random));
        const auto time_ns = any<std::int64_t>(random);
        use(all.cast(any<double>(random), all.lidar_at(time_ns), time_ns, any<bool>(random)));
      },
      1000);
}

// One extreme option at a time: it is a problem, or the device works.
template <class Options, class Number>
void set_any(Options& options, Number Options::* member, test::dice& random) {
  options.*member = any<Number>(random);
}

TEST(ExtremeSim, Devices) {
  int built = 0;
  many_times(
      [&](test::dice& random) {
        sim::device_options options;
        sim::scanner_options& scanner = options.scanner;
        const std::size_t which = random.below(24);
        if (which == 0) set_any(scanner, &sim::scanner_options::scan_frequency_chz, random);
        if (which == 1) set_any(scanner, &sim::scanner_options::sample_rate, random);
        if (which == 2) set_any(scanner, &sim::scanner_options::samples_per_packet, random);
        if (which == 3) set_any(scanner, &sim::scanner_options::zero_deg, random);
        if (which == 4) set_any(scanner, &sim::scanner_options::index_deg, random);
        if (which == 5) scanner.start_deg = any<double>(random);
        if (which == 6) set_any(scanner, &sim::scanner_options::min_range_mm, random);
        if (which == 7) set_any(scanner, &sim::scanner_options::max_range_mm, random);
        if (which == 8) set_any(scanner, &sim::scanner_options::noise_mm, random);
        if (which == 9) set_any(scanner, &sim::scanner_options::noise_ratio, random);
        if (which == 10) set_any(scanner, &sim::scanner_options::dropout_ratio, random);
        if (which == 11) set_any(scanner, &sim::scanner_options::sample_rate_ratio, random);
        if (which == 12) set_any(scanner, &sim::scanner_options::sample_rate_drift_ppm, random);
        if (which == 13) set_any(options, &sim::device_options::baud, random);
        if (which == 14) set_any(options, &sim::device_options::batch_max_ns, random);
        if (which == 15) set_any(options, &sim::device_options::reaction_ns, random);
        if (which == 16) set_any(options, &sim::device_options::acceleration_mhz_per_s, random);
        if (which == 17) set_any(options, &sim::device_options::motor_drift_ppm, random);
        if (which == 18) set_any(options, &sim::device_options::motor_drift_period_ns, random);
        if (which == 19) set_any(options, &sim::device_options::time_packet_ns, random);
        if (which == 21) set_any(options, &sim::device_options::zero_angle_cdeg, random);
        if (which == 22) set_any(options, &sim::device_options::highest_frequency_chz, random);
        if (which == 23) set_any(options, &sim::device_options::zero_angle_divisor, random);
        if (which == 20)
          scanner.format.code = {any<std::uint8_t>(random), any<std::uint8_t>(random),
                                 any<sim::lower_bits>(random)};
        use(sim::problem_with(scanner).size());
        if (!sim::problem_with(options).empty()) return;
        ++built;
        sim::device device(sim::world{}, options);
        use(sim::scanner_of(options).seed);
        std::array<std::uint8_t, 512> out{};
        device.write(std::array<std::uint8_t, 2>{0xA5, 0x60}, 1000);
        for (const std::int64_t ms : {1, 100, 1000, 1500}) use(device.read(out, ms * 1'000'000));
        use(device.motor_mhz(1'500'000'000));
        device.host().set_baud(any<std::uint32_t>(random), 1'500'000'000);
        use(device.next_ns(1'500'000'000));
      },
      600);
  EXPECT_GT(built, 50);
}

// Time goes to its end.
TEST(ExtremeSim, EndOfTime) {
  sim::device idle{sim::world{}};
  std::array<std::uint8_t, 512> out{};
  for (const std::int64_t now_ns : {std::int64_t{0}, std::int64_t{1} << 40U, std::int64_t{1} << 62U,
                                    sim::forever_ns - 1, sim::forever_ns}) {
    use(idle.read(out, now_ns));
    use(idle.available(now_ns));
    use(idle.next_ns(now_ns));
    use(idle.motor_mhz(now_ns));
    use(idle.is_plugged(now_ns));
    use(idle.is_idle_and_silent(now_ns));
    idle.host().open(now_ns);
    idle.host().set_dtr(true, now_ns);
    idle.host().ignore_dtr(now_ns);
    idle.host().close(now_ns);
    idle.unplug(now_ns);
    idle.replug(now_ns);
  }
  sim::virtual_clock clock(std::numeric_limits<std::int64_t>::max());
  for (int i = 0; i < 3; ++i) clock.tick();
  clock.advance_to(std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(clock.now_ns(), sim::forever_ns);
}

TEST(ExtremeSim, Scanners) {
  sim::scanner scanner(sim::world{}, {});
  many_times(
      [&](test::dice& random) {
        scanner.set_speed_mhz(any<std::uint32_t>(random));
        scanner.set_sample_rate(any<sample_rate>(random));
        scanner.set_turning(any<sim::turning>(random));
        scanner.resume(any<std::int64_t>(random), any<std::uint64_t>(random));
        use(scanner.next().complete_ns);
        use(scanner.next_sample_ns());
      },
      500);
}

TEST(ExtremeSim, Faults) {
  many_times(
      [](test::dice& random) {
        const sim::fault made{any<sim::fault_kind>(random), any<std::int64_t>(random),
                              any<std::int64_t>(random), any<double>(random),
                              any<std::int64_t>(random)};
        use(sim::name_of(made.kind));
        use(sim::make_fault(made.kind, made.begin_ns, made.duration_ns));
        if (!sim::problem_with(made).empty()) return;
        const std::array faults{made};
        sim::device device(sim::world{}, {}, faults);
        std::array<std::uint8_t, 512> out{};
        device.write(std::array<std::uint8_t, 2>{0xA5, 0x60}, 1000);
        for (const std::int64_t ms : {1, 100, 500}) use(device.read(out, ms * 1'000'000));
        use(device.next_plug_ns());
        use(device.next_ns(500'000'000));
      },
      1000);
}

TEST(ExtremeSim, Odometry) {
  many_times([](test::dice& random) {
    const sim::odometry_options options{any<std::uint64_t>(random), any<double>(random),
                                        any<double>(random),        any<double>(random),
                                        any<double>(random),        any<double>(random)};
    if (!sim::problem_with(options).empty()) return;
    sim::odometry robot(sim::world{}, options);
    for (int i = 0; i < 5; ++i) use(robot.next());
  });
  many_times([](test::dice& random) {
    sim::world scene;
    scene.path = {{any<std::int64_t>(random), {any_place(random), any_place(random)}}};
    sim::odometry robot(scene, {});
    for (int i = 0; i < 5; ++i) use(robot.next());
    use(robot.next_ns());
  });
}

TEST(ExtremeSim, Several) { EXPECT_EQ(sim::several({}, 0, {}).size(), 0U); }

}  // namespace
