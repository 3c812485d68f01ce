// SPDX-License-Identifier: MIT
// The simulated head: its packets are those of a G4, its truth agrees with them, its options take
// effect.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/sim/scanner.hpp"

namespace {

using namespace g4lidar;

// A copy of a packet that outlives the scanner's next call.
struct kept_packet {
  std::vector<std::uint8_t> data;
  std::vector<sim::sample_truth> samples;
  std::int64_t complete_ns;

  [[nodiscard]] packet_view view() const { return packet_view::from(data).value(); }
};

std::vector<kept_packet> run(const sim::scanner_options& options, double seconds,
                             const sim::world& world = sim::built_in_world()) {
  EXPECT_EQ(sim::problem_with(options), "");
  sim::scanner scanner(world, options);
  std::vector<kept_packet> packets;
  const auto end_ns = static_cast<std::int64_t>(seconds * 1e9);
  for (;;) {
    const sim::sent_packet p = scanner.next();
    if (p.complete_ns >= end_ns) return packets;
    packets.push_back(
        {{p.data.begin(), p.data.end()}, {p.samples.begin(), p.samples.end()}, p.complete_ns});
  }
}

std::vector<sim::sample_truth> truths_of(const std::vector<kept_packet>& packets) {
  std::vector<sim::sample_truth> truths;
  for (const kept_packet& p : packets)
    truths.insert(truths.end(), p.samples.begin(), p.samples.end());
  return truths;
}

sim::scanner_options settings(sample_rate rate, int frequency_chz, std::size_t samples,
                              double index_deg) {
  sim::scanner_options options;
  options.sample_rate = rate;
  options.scan_frequency_chz = static_cast<std::uint16_t>(frequency_chz);
  options.samples_per_packet = samples;
  options.index_deg = index_deg;
  return options;
}

// The minimum and maximum of everything that shapes a packet, and values between.
std::vector<sim::scanner_options> all_settings() {
  std::vector<sim::scanner_options> all;
  for (const auto rate : {sample_rate::khz_4, sample_rate::khz_8, sample_rate::khz_9}) {
    for (const int frequency_chz : {500, 700, 1003, 1200}) {
      for (const std::size_t samples : {1U, 7U, 40U, 80U}) {
        for (const double index_deg : {0.0, 123.4, 348.0, 359.999}) {
          all.push_back(settings(rate, frequency_chz, samples, index_deg));
        }
      }
    }
  }
  return all;
}

TEST(SimScanner, EveryPacketIsValidAndHoldsItsSamples) {
  for (const sim::scanner_options& options : all_settings()) {
    for (const kept_packet& p : run(options, 0.5)) {
      const auto view = packet_view::from(p.data);
      ASSERT_TRUE(view);
      ASSERT_FALSE(view->is_suspect());
      ASSERT_EQ(view->sample_count(), p.samples.size());
      ASSERT_LE(view->sample_count(), options.samples_per_packet);
      for (std::size_t i = 0; i < p.samples.size(); ++i) {
        ASSERT_EQ(view->sample(i), p.samples[i].raw);
      }
      ASSERT_EQ(p.complete_ns, p.samples.back().time_ns);
    }
  }
}

TEST(SimScanner, AnglesOnTheWire_AreWithinHalfA64th) {
  for (const sim::scanner_options& options : all_settings()) {
    for (const kept_packet& p : run(options, 0.5)) {
      const packet_view view = p.view();
      const auto apart = [](int wire, double truth) {
        return std::fabs(std::remainder(wire / 64.0 - truth, 360.0));
      };
      ASSERT_LE(apart(view.first_angle_64ths(), p.samples.front().first_level_deg), 1 / 128.0);
      ASSERT_LE(apart(view.last_angle_64ths(), p.samples.back().first_level_deg), 1 / 128.0);
      // The same for the angles between them, which a receiver interpolates.
      for (std::size_t i = 1; i + 1 < p.samples.size(); ++i) {
        const double between =
            view.first_angle_64ths() / 64.0 + view.span_64ths() / 64.0 * static_cast<double>(i) /
                                                  static_cast<double>(p.samples.size() - 1);
        const double wrong = std::remainder(between - p.samples[i].first_level_deg, 360.0);
        ASSERT_LE(std::fabs(wrong), 1 / 128.0 + 1e-9);
      }
    }
  }
}

TEST(SimScanner, ZeroPacket_HoldsOnlyTheFirstSampleAfterTheIndex) {
  for (const sim::scanner_options& options : all_settings()) {
    const double step_deg = 3.6 * options.scan_frequency_chz / to_hz(options.sample_rate);
    std::uint64_t zeros = 0;
    const auto packets = run(options, 2.0);
    for (const kept_packet& p : packets) {
      const packet_view view = p.view();
      zeros += view.is_zero() ? 1U : 0U;
      if (view.is_zero()) {
        ASSERT_EQ(view.sample_count(), 1U);
        ASSERT_EQ(view.first_angle_64ths(), view.last_angle_64ths());
      }
      for (const sim::sample_truth& t : p.samples) {
        const double behind = t.first_level_deg - options.index_deg;
        const double behind_index = behind < 0.0 ? behind + 360.0 : behind;
        ASSERT_EQ(view.is_zero(), behind_index < step_deg * (1.0 - 1e-9)) << behind_index;
      }
    }
    const double turns = 2.0 * options.scan_frequency_chz / 100.0;
    EXPECT_NEAR(static_cast<double>(zeros), turns, 1.0);
  }
}

TEST(SimScanner, OnlyThePacketBeforeAZeroPacketIsShort) {
  for (const sim::scanner_options& options : all_settings()) {
    const auto packets = run(options, 0.5);
    for (std::size_t i = 0; i + 1 < packets.size(); ++i) {
      if (packets[i].view().is_zero() || packets[i + 1].view().is_zero()) continue;
      ASSERT_EQ(packets[i].samples.size(), options.samples_per_packet);
    }
  }
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

TEST(SimScanner, SamplesAreEquidistantInTimeAndAngle) {
  for (const sim::scanner_options& options : all_settings()) {
    const auto truths = truths_of(run(options, 1.0));
    const std::uint32_t rate = to_hz(options.sample_rate);
    EXPECT_LE(truths.size(), rate);
    EXPECT_GT(truths.size() + options.samples_per_packet, rate);
    const double step_deg = 3.6 * options.scan_frequency_chz / rate;
    for (std::size_t i = 0; i < truths.size(); ++i) {
      ASSERT_EQ(truths[i].index, i);
      ASSERT_EQ(truths[i].time_ns, static_cast<std::int64_t>(i * 1'000'000'000U / rate));
      ASSERT_GE(truths[i].first_level_deg, 0.0);
      ASSERT_LT(truths[i].first_level_deg, 360.0);
      const double expected = truths[0].first_level_deg + static_cast<double>(i) * step_deg;
      ASSERT_NEAR(std::remainder(truths[i].first_level_deg - expected, 360.0), 0.0, 1e-9);
    }
  }
}

TEST(SimScanner, ExactDevice_SendsTheRangeWithinAQuarterMillimetre) {
  sim::scanner_options options;
  std::size_t measured = 0;
  std::size_t too_near = 0;
  std::size_t too_far = 0;
  for (const auto& t : truths_of(run(options, 2.0))) {
    if (t.range_mm < 280.0 || t.range_mm > 16'000.0) {
      ASSERT_EQ(t.raw, 0) << t.range_mm;
      (t.range_mm < 280.0 ? too_near : too_far) += 1;
      continue;
    }
    ASSERT_NEAR(t.raw / 4.0, t.range_mm, 0.125);
    const double apart = t.bearing_deg - t.first_level_deg - sim::correction_deg(t.range_mm);
    ASSERT_NEAR(std::remainder(apart, 360.0), 0.0, 1e-9);
    ++measured;
  }
  EXPECT_GT(measured, 15'000U);
  EXPECT_GT(too_near, 100U);
  EXPECT_GT(too_far, 100U);
}

TEST(SimScanner, NoTarget_TruthHasTheDirectionOfAFarTarget) {
  for (const auto& t : truths_of(run({}, 0.3, sim::world{}))) {
    ASSERT_EQ(t.raw, 0);
    ASSERT_EQ(t.range_mm, 0.0);
    const double apart = t.bearing_deg - t.first_level_deg - sim::far_correction_deg;
    ASSERT_NEAR(std::remainder(apart, 360.0), 0.0, 1e-9);
    ASSERT_GE(t.bearing_deg, 0.0);
    ASSERT_LT(t.bearing_deg, 360.0);
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
        ASSERT_EQ(p.view().reported_frequency_dhz(), reports && p.view().is_zero() ? dhz : 0);
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

TEST(SimScanner, Copy_IsEqualAndIndependent) {
  sim::scanner_options options;
  options.noise_mm = 5.0;
  options.dropout_ratio = 0.1;
  sim::scanner one(sim::built_in_world(), options);
  for (int i = 0; i < 100; ++i) (void)one.next();
  sim::scanner two = one;
  std::vector<std::uint8_t> of_one;
  for (int i = 0; i < 100; ++i) {
    const bytes data = one.next().data;
    of_one.insert(of_one.end(), data.begin(), data.end());
  }
  std::vector<std::uint8_t> of_two;
  for (int i = 0; i < 100; ++i) {
    const bytes data = two.next().data;
    of_two.insert(of_two.end(), data.begin(), data.end());
  }
  EXPECT_EQ(of_one, of_two);
}

TEST(SimScanner, Stream_StartsWithTheReplyToTheStartCommand) {
  const std::vector<std::uint8_t> expected{0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81};
  const bytes reply = sim::scan_start_reply();
  EXPECT_EQ(std::vector<std::uint8_t>(reply.begin(), reply.end()), expected);
  EXPECT_EQ(response_view::from(reply)->kind(), response_kind::scan_started);
}

}  // namespace
