// SPDX-License-Identifier: MIT
// The options of the simulated head take effect. Its packets and its truth are tested by each model
// (models/truth_test.cpp) and by digests (../core/sim_golden_test.cpp).
#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "g4lidar/core/packet.hpp"
#include "g4lidar/sim/scanner.hpp"

namespace {

using namespace g4lidar;

// A copy of a packet that outlives the scanner's next call.
struct kept_packet {
  std::vector<std::uint8_t> data;
  std::vector<sim::sample_truth> samples;

  [[nodiscard]] packet_view view() const { return packet_view::from(data).value(); }
};

std::vector<kept_packet> run(const sim::scanner_options& options, double seconds) {
  EXPECT_EQ(sim::problem_with(options), "");
  sim::scanner scanner(sim::built_in_world(), options);
  std::vector<kept_packet> packets;
  const auto end_ns = static_cast<std::int64_t>(seconds * 1e9);
  for (;;) {
    const sim::sent_packet p = scanner.next();
    if (p.complete_ns >= end_ns) return packets;
    packets.push_back({{p.data.begin(), p.data.end()}, {p.samples.begin(), p.samples.end()}});
  }
}

std::vector<sim::sample_truth> truths_of(const std::vector<kept_packet>& packets) {
  std::vector<sim::sample_truth> truths;
  for (const kept_packet& p : packets)
    truths.insert(truths.end(), p.samples.begin(), p.samples.end());
  return truths;
}

TEST(SimScanner, Revolutions_CountLaterZeroPackets) {
  for (const double start_deg : {0.0, 200.0}) {
    sim::scanner_options options;
    options.start_deg = start_deg;
    const auto packets = run(options, 2.0);
    EXPECT_EQ(packets[0].view().is_zero(), start_deg == 0.0);
    std::uint64_t revolution = 0;
    for (std::size_t i = 0; i < packets.size(); ++i) {
      if (i > 0 && packets[i].view().is_zero()) ++revolution;
      for (const auto& t : packets[i].samples) ASSERT_EQ(t.revolution, revolution);
    }
    EXPECT_GE(revolution, 13U);
  }
}

TEST(SimScanner, RangeLimitsAreOptions) {
  sim::scanner_options options;
  options.min_range_mm = 1000.0;
  options.max_range_mm = 2500.0;
  std::size_t measured = 0;
  for (const auto& t : truths_of(run(options, 1.0))) {
    ASSERT_EQ(t.raw != 0, t.range_mm >= 1000.0 && t.range_mm <= 2500.0) << t.range_mm;
    measured += t.raw != 0 ? 1U : 0U;
  }
  EXPECT_GT(measured, 1000U);
}

TEST(SimScanner, Noise_HasTheRequestedDeviation) {
  sim::scanner_options options;
  options.noise_mm = 5.0;
  options.noise_ratio = 0.01;
  double sum = 0.0;
  double squares = 0.0;
  double n = 0.0;
  for (const auto& t : truths_of(run(options, 10.0))) {
    if (t.range_mm < 500.0 || t.range_mm > 14'000.0) continue;
    ASSERT_NE(t.raw, 0);
    const double error = (t.raw / 4.0 - t.range_mm) / (5.0 + 0.01 * t.range_mm);
    sum += error;
    squares += error * error;
    n += 1.0;
  }
  EXPECT_GT(n, 60'000.0);
  EXPECT_NEAR(sum / n, 0.0, 0.02);
  EXPECT_NEAR(squares / n, 1.0, 0.02);
}

TEST(SimScanner, Noise_StaysWithinTheRangeLimits) {
  sim::scanner_options options;
  options.noise_mm = 5000.0;
  options.max_range_mm = 3000.0;
  for (const auto& t : truths_of(run(options, 5.0))) {
    const bool measurable = t.range_mm >= 280.0 && t.range_mm <= 3000.0;
    ASSERT_TRUE(t.raw == 0 || (measurable && t.raw >= 280 * 4 && t.raw <= 3000 * 4)) << t.raw;
  }
}

TEST(SimScanner, Dropouts_HaveTheRequestedRateAndChangeNothingElse) {
  sim::scanner_options options;
  options.noise_mm = 5.0;
  const auto whole = truths_of(run(options, 5.0));
  options.dropout_ratio = 0.1;
  const auto dropped = truths_of(run(options, 5.0));
  ASSERT_EQ(whole.size(), dropped.size());
  double gone = 0.0;
  double had = 0.0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    had += whole[i].raw != 0 ? 1.0 : 0.0;
    gone += whole[i].raw != dropped[i].raw ? 1.0 : 0.0;
    ASSERT_TRUE(dropped[i].raw == whole[i].raw || dropped[i].raw == 0);
    ASSERT_EQ(dropped[i].range_mm, whole[i].range_mm);
  }
  EXPECT_NEAR(gone / had, 0.1, 0.01);
  options.dropout_ratio = 1.0;
  for (const auto& t : truths_of(run(options, 0.5))) ASSERT_EQ(t.raw, 0);
}

TEST(SimScanner, ZeroPacket_ReportsTheFrequencyIfRequested) {
  for (const auto& [chz, dhz] : {std::pair{500, 50}, {704, 70}, {705, 71}, {1200, 120}}) {
    sim::scanner_options options;
    options.scan_frequency_chz = static_cast<std::uint16_t>(chz);
    for (const bool reports : {true, false}) {
      options.reports_frequency = reports;
      for (const kept_packet& p : run(options, 0.5)) {
        ASSERT_EQ(p.view().reported_frequency_chz(), reports && p.view().is_zero() ? 10 * dhz : 0);
        ASSERT_TRUE(p.view().is_zero() || p.view().ct() == 0);
      }
    }
  }
}

TEST(SimScanner, StartAngle_IsAsGivenOrFromTheSeed) {
  sim::scanner_options options;
  options.index_deg = 348.0;
  for (const double start_deg : {0.0, 12.25, 348.0, 347.999, 359.999}) {
    options.start_deg = start_deg;
    EXPECT_NEAR(run(options, 0.1)[0].samples[0].first_level_deg, start_deg, 1e-9);
  }
  options.start_deg.reset();
  const double one = run(options, 0.1)[0].samples[0].first_level_deg;
  EXPECT_EQ(run(options, 0.1)[0].samples[0].first_level_deg, one);
  options.seed = 2;
  EXPECT_NE(run(options, 0.1)[0].samples[0].first_level_deg, one);
}

}  // namespace
