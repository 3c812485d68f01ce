// SPDX-License-Identifier: MIT
// Same seed, same bytes: digests of simulated streams, the same on every processor this runs on.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <string>
#include <variant>

#include "g4lidar/sim/odometry.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "sim/arithmetic.hpp"

namespace {

using namespace g4lidar;

// FNV-1a over bytes; numbers go in with their least significant byte first.
class digest {
 public:
  void add(bytes data) {
    for (const std::uint8_t byte : data) state_ = (state_ ^ byte) * 0x100000001B3U;
  }
  void add(std::uint64_t number) {
    for (int shift = 0; shift < 64; shift += 8) {
      state_ = (state_ ^ ((number >> shift) & 0xFFU)) * 0x100000001B3U;
    }
  }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xCBF29CE484222325U;
};

sim::scanner_options as_it_comes(std::uint64_t seed) {
  sim::scanner_options options;
  options.seed = seed;
  return options;
}

sim::scanner_options noisy(std::uint64_t seed) {
  sim::scanner_options options;
  options.seed = seed;
  options.noise_mm = 4.0;
  options.noise_ratio = 0.003;
  options.dropout_ratio = 0.02;
  options.scan_frequency_chz = 1013;
  return options;
}

sim::scanner_options slow_and_turned(std::uint64_t seed) {
  sim::scanner_options options;
  options.seed = seed;
  options.sample_rate = sample_rate::khz_4;
  options.scan_frequency_chz = 1200;
  options.samples_per_packet = 80;
  options.index_deg = 348.0;
  options.reports_frequency = false;
  options.min_range_mm = 100.0;
  return options;
}

constexpr double golden_angle_deg = 137.50776405003785;

struct golden {
  const char* name;
  sim::scanner_options (*options)(std::uint64_t seed);
  std::uint64_t seed;
  std::uint64_t of_bytes;
  std::uint64_t of_truths;  // every bit of every double
};

void PrintTo(const golden& g, std::ostream* out) { *out << g.name << " seed " << g.seed; }

class SimGolden : public testing::TestWithParam<golden> {};

TEST_P(SimGolden, TwoSecondsAreTheSameOnEveryProcessor) {
  const golden& expected = GetParam();
  sim::scanner scanner(sim::built_in_world(), expected.options(expected.seed));
  digest of_bytes;
  digest of_truths;
  for (std::int64_t now = 0; now < 2'000'000'000;) {
    const sim::sent_packet packet = scanner.next();
    of_bytes.add(packet.data);
    for (const sim::sample_truth& truth : packet.samples) {
      of_truths.add(truth.index);
      of_truths.add(static_cast<std::uint64_t>(truth.time_ns));
      of_truths.add(truth.revolution);
      of_truths.add(truth.first_level_deg);
      of_truths.add(truth.bearing_deg);
      of_truths.add(truth.range_mm);
      of_truths.add(std::uint64_t{truth.raw});
    }
    now = packet.complete_ns;
  }
  EXPECT_EQ(of_bytes.value(), expected.of_bytes) << std::hex << "0x" << of_bytes.value();
  EXPECT_EQ(of_truths.value(), expected.of_truths) << std::hex << "0x" << of_truths.value();
}

INSTANTIATE_TEST_SUITE_P(
    Streams, SimGolden,
    testing::Values(
        golden{"as_it_comes", as_it_comes, 1, 0xD011DDF368CA90E5U, 0x0BEF5194C8CE43AAU},
        golden{"as_it_comes", as_it_comes, 2, 0xD963C7D3D8999ADDU, 0xF3FECAFDD36AD5BCU},
        golden{"as_it_comes", as_it_comes, 3, 0xAD4435A1715572E1U, 0x479B8F01A0CABDA6U},
        golden{"noisy", noisy, 1, 0xFFDB0B7EFD2A20EDU, 0x5B4F11E3A7B8C9EDU},
        golden{"noisy", noisy, 2, 0x6464BBE451EAA425U, 0xB476A7A0A51E3D43U},
        golden{"noisy", noisy, 3, 0x26176C2F7422D44DU, 0x9381C240D025A4FEU},
        golden{"slow_and_turned", slow_and_turned, 1, 0x54CA5AB2BFF125A1U, 0x25C0426246B9563FU},
        golden{"slow_and_turned", slow_and_turned, 2, 0xD8B9710DC6F54DA1U, 0x10D1BED10ECA966DU},
        golden{"slow_and_turned", slow_and_turned, 3, 0x32D2D2AC5AB58749U, 0x2F8FB42FD8BC8789U}),
    [](const auto& case_) { return case_.param.name + ("_" + std::to_string(case_.param.seed)); });

// A lidar on a robot that drives an arc and turns, among walls, pillars and somebody who walks.
constexpr const char* driving_world = R"(wall -4 -3 6 -3
wall 6 -3 6 3.5
wall 6 3.5 -4 3
wall -4 3 -4 -3
disc 0.3 2 -1.5
disc 0.25 -3 2 5 2.5 1.3
lidar 0 0 12.5
mount 0.2,-0.05,150
drive forward 1 0.8
drive arc 1.2 100 0.6
drive turn -200 90
)";

TEST(SimGolden, ADrivingLidarSeesTheSameOnEveryProcessor) {
  const auto read = sim::parse_world(driving_world);
  ASSERT_TRUE(std::holds_alternative<sim::world>(read));
  const auto& world = std::get<sim::world>(read);
  digest of_all;
  const auto run = [&](sim::turning way) {
    sim::scanner scanner(world, noisy(4));
    scanner.set_turning(way);
    for (std::int64_t now = 0; now < 7'500'000'000;) {
      const sim::sent_packet packet = scanner.next();
      of_all.add(packet.data);
      for (const sim::sample_truth& truth : packet.samples) {
        for (const double x : {truth.bearing_deg, truth.range_mm, truth.lidar.x_m, truth.lidar.y_m,
                               truth.lidar.heading_deg}) {
          of_all.add(x);
        }
      }
      now = packet.complete_ns;
    }
  };
  run(sim::turning::clockwise);
  run(sim::turning::mirrored);
  EXPECT_EQ(of_all.value(), 0x38ABFBD4D9DA1B63U) << std::hex << "0x" << of_all.value();
}

TEST(SimGolden, OdometryIsTheSameOnEveryProcessor) {
  const auto read = sim::parse_world(driving_world);
  ASSERT_TRUE(std::holds_alternative<sim::world>(read));
  sim::odometry_options options;
  options.rate_hz = 37.0;
  options.way_noise = options.turn_noise = 0.04;
  options.way_slip = options.turn_slip = 0.01;
  sim::odometry odometry(std::get<sim::world>(read), options);
  digest of_all;
  for (int i = 0; i < 400; ++i) {
    const sim::odometry_sample sample = odometry.next();
    of_all.add(static_cast<std::uint64_t>(sample.time_ns));
    for (const double x :
         {sample.x_m, sample.y_m, sample.yaw_rad, sample.forward_m_per_s, sample.yaw_rad_per_s}) {
      of_all.add(x);
    }
  }
  EXPECT_EQ(of_all.value(), 0x9FF51F5B607FFF05U) << std::hex << "0x" << of_all.value();
}

TEST(SimGolden, ArithmeticIsTheSameOnEveryProcessor) {
  digest of_all;
  for (int i = 0; i < 100'000; ++i) {
    const double degrees = (i - 50'000) * (golden_angle_deg * 0.01);
    const sim::sin_cos both = sim::sin_cos_deg(degrees);
    of_all.add(both.sine);
    of_all.add(both.cosine);
    of_all.add(sim::atan_deg(degrees * 0.01));
    of_all.add(sim::atan2_deg(both.sine, both.cosine));
    of_all.add(sim::correction_deg(0.25 * (i + 1)));
  }
  EXPECT_EQ(of_all.value(), 0xEC2421430F9D4F41U) << std::hex << "0x" << of_all.value();
}

TEST(SimGolden, AWorldReadFromTextIsTheSameOnEveryProcessor) {
  digest of_all;
  std::string text = "lidar 0.1 -0.3 12.345678901234\n";
  for (int i = 0; i < 500; ++i) {
    const std::string n = std::to_string(i);
    text += "wall " + n + ".01 -3.3" + n + " " + n + ".7 2." + n + n + "\n";
  }
  const auto read = sim::parse_world(text);
  ASSERT_TRUE(std::holds_alternative<sim::world>(read));
  for (const sim::wall& w : std::get<sim::world>(read).walls) {
    for (const double x : {w.x1_m, w.y1_m, w.x2_m, w.y2_m}) of_all.add(x);
  }
  EXPECT_EQ(of_all.value(), 0x9729AE82E0628645U) << std::hex << "0x" << of_all.value();
}

}  // namespace
