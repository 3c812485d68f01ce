// SPDX-License-Identifier: MIT
// The simulated G4 during a scan: motor, rates, protection, disturbance, stop and restart.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "g4lidar/sim/device.hpp"
#include "support/host_side.hpp"

namespace {

using namespace g4lidar;
using test::byte_vector;
using test::heard;
using test::host_side;
using test::ms;
using test::second;
using ::testing::IsEmpty;

heard started(host_side& host, std::int64_t for_ns) {
  host.send(command::start);
  return host.hear(for_ns);
}

TEST(SimScanning, Motor_SpinsUp) {
  host_side host;
  const heard first = started(host, 100 * ms);
  ASSERT_GE(first.packets, 5U);
  const auto front = packet_view::from(first.packet_bytes.front());
  EXPECT_EQ(front->sample_count(), 40U);
  EXPECT_EQ(front->first_angle_64ths(), front->last_angle_64ths()) << "it stands";
  EXPECT_EQ(host.device.motor_mhz(60 * ms), 0U);
  EXPECT_GT(host.device.motor_mhz(80 * ms), 0U);
  EXPECT_LT(host.device.motor_mhz(host.now_ns), 2'000U);
  const heard rising = host.hear(600 * ms);
  int last_span = 0;
  for (const byte_vector& bytes : rising.packet_bytes) {
    const auto packet = packet_view::from(bytes);
    ASSERT_FALSE(packet->is_suspect());
    if (packet->sample_count() < 40) continue;
    EXPECT_GE(packet->span_64ths(), last_span - 2);
    last_span = packet->span_64ths();
  }
  EXPECT_NEAR(last_span / 64.0, 39 * 360.0 * 7 / 9000, 0.1);
  EXPECT_NEAR(host.device.motor_mhz(host.now_ns), 7'000.0, 20.0);
}

TEST(SimScanning, TrueSampleRate_MayDeviateAndDrift) {
  sim::device_options options;
  options.scanner.sample_rate_ratio = 1.03;
  options.scanner.sample_rate_drift_ppm = 10'000;
  host_side host(options);
  (void)started(host, second);
  // In the first half of the period, 30 s, the rate is higher: by 0.5 % on average.
  const heard steady = host.hear(28 * second);
  EXPECT_NEAR(static_cast<double>(steady.samples), 28 * 9000 * 1.03 * 1.005, 300.0);
}

TEST(SimScanning, NoConstantFrequency_MotorDriftsMore) {
  const auto spread = [](constant_frequency constancy) {
    sim::device_options options;
    options.initial.constancy = constancy;
    host_side host(options);
    (void)started(host, 2 * second);
    std::uint32_t least = 100'000;
    std::uint32_t most = 0;
    for (int i = 0; i < 40; ++i) {
      (void)host.hear(second / 2);
      least = std::min(least, host.device.motor_mhz(host.now_ns));
      most = std::max(most, host.device.motor_mhz(host.now_ns));
    }
    return most - least;
  };
  EXPECT_NEAR(spread(constant_frequency::on), 7000 * 0.004, 3.0);
  EXPECT_NEAR(spread(constant_frequency::off), 7000 * 0.06, 25.0);
}

TEST(SimScanning, LowPowerOff_NoSpinUp) {
  host_side host;
  (void)host.ask(command::low_power_off, 2 * second);
  const heard first = started(host, second);
  EXPECT_NEAR(static_cast<double>(first.zero_packets), 7.0, 1.0);
}

TEST(SimScanning, StrayBytes_FollowTheHeaderAndPrecedeZeroPackets) {
  host_side host;
  const heard healthy = started(host, 5 * second);
  EXPECT_GE(healthy.skipped_bytes,
            1 + healthy.zero_packets);  // and the truncated packet at the end
  EXPECT_LE(healthy.skipped_bytes, 1 + healthy.zero_packets + max_packet_size);
  sim::device_options clean;
  clean.stray_after_start = clean.stray_before_zero = false;
  host_side other(clean);
  EXPECT_LE(started(other, 5 * second).skipped_bytes, max_packet_size);
}

TEST(SimScanning, Connection_CarriesNoMoreThanItsRate) {
  sim::device_options options;
  options.scanner.samples_per_packet = 10;  // 27 kB/s at 9 kHz: more than the capacity
  host_side host(options);
  const heard full = started(host, 10 * second);
  EXPECT_NEAR(static_cast<double>(full.bytes.size()), 230'400.0, 1'000.0);
  EXPECT_LE(full.skipped_bytes, full.zero_packets + 200) << "packets are lost whole";
}

TEST(SimScanning, Stop_TruncatesTheLastPacket) {
  for (const bool cuts : {true, false}) {
    sim::device_options options;
    options.stop_truncates = cuts;
    host_side host(options);
    byte_vector all = host.ask(command::start, 1503 * ms);
    const byte_vector rest = host.ask(command::stop, 100 * ms);
    all.insert(all.end(), rest.begin(), rest.end());
    const heard whole = test::taken_apart(all);
    const std::size_t strays = 1 + whole.zero_packets;
    if (cuts) {
      EXPECT_GT(whole.skipped_bytes, strays);
    } else {
      EXPECT_EQ(whole.skipped_bytes, strays);
    }
    EXPECT_TRUE(host.device.is_idle_and_silent(host.now_ns));
    EXPECT_THAT(host.listen(second), IsEmpty());
  }
}

TEST(SimScanning, ForcedStop_MayBeUnknown) {
  host_side host;
  (void)started(host, second);
  (void)host.ask(0x00);
  EXPECT_FALSE(host.device.is_scanning());
  sim::device_options options;
  options.obeys_forced_stop = false;
  host_side other(options);
  (void)started(other, second);
  (void)other.ask(0x00);
  EXPECT_TRUE(other.device.is_scanning());
}

TEST(SimScanning, ProtectionStopsAfterThreeSeconds) {
  host_side host;
  (void)host.ask(command::protection_toggle);
  (void)started(host, 2'900 * ms);
  EXPECT_TRUE(host.device.is_scanning());
  (void)host.ask(command::start, 2'900 * ms);
  EXPECT_TRUE(host.device.is_scanning()) << "it got keep-alives";
  (void)host.listen(200 * ms);
  EXPECT_FALSE(host.device.is_scanning());
  EXPECT_FALSE(host.device.motor_turns());
  EXPECT_THAT(host.listen(second), IsEmpty());
}

TEST(SimScanning, ProtectionTurnedOnDuringAScan_CountsFromThen) {
  host_side host;
  (void)started(host, 10 * second);
  (void)host.ask(command::protection_toggle, 2'900 * ms);
  EXPECT_TRUE(host.device.is_scanning());
  (void)host.listen(200 * ms);
  EXPECT_FALSE(host.device.is_scanning());
}

TEST(SimScanning, StartAfterTheProtection_MaySendNoHeader) {
  for (const bool header : {true, false}) {
    sim::device_options options;
    options.header_after_protection = header;
    host_side host(options);
    (void)host.ask(command::protection_toggle);
    (void)started(host, 4 * second);
    EXPECT_EQ(started(host, second).responses.size(), header ? 1U : 0U);
    EXPECT_TRUE(host.device.is_scanning());
  }
}

TEST(SimScanning, OtherCommandsDisturbTheStream) {
  const auto disturbed = [](sim::disturbance how) {
    sim::device_options options;
    options.while_scanning = how;
    options.stray_before_zero = options.stray_after_start = false;
    host_side host(options);
    byte_vector all = host.ask(command::start, 1501 * ms);
    for (int i = 0; i < 20; ++i) {
      const byte_vector more = host.ask(command::device_info, 51 * ms);
      all.insert(all.end(), more.begin(), more.end());
    }
    return test::taken_apart(all);
  };
  const heard mid = disturbed(sim::disturbance::mid_packet);
  EXPECT_GT(mid.responses.size(), 1U);
  EXPECT_GT(mid.skipped_bytes, 10 * 40U) << "the packets that were parted";
  const heard between = disturbed(sim::disturbance::between);
  EXPECT_EQ(between.responses.size(), 21U);
  EXPECT_LE(between.skipped_bytes, max_packet_size);
  const heard drops = disturbed(sim::disturbance::drops);
  EXPECT_LT(drops.bytes.size(), mid.bytes.size() - 10 * 20U);
  EXPECT_EQ(disturbed(sim::disturbance::ignored).responses.size(), 1U);
}

TEST(SimScanning, CounterClockwise_MirrorsTheRoomOrReversesTheAngles) {
  sim::device_options options;
  options.initial.direction = motor_direction::counter_clockwise;
  options.counter_clockwise = sim::turning::falling;
  host_side falling(options);
  const heard back = started(falling, 3 * second);
  EXPECT_GT(back.suspect, 300U);
  EXPECT_NEAR(static_cast<double>(back.zero_packets), 18.0, 2.0);

  options.counter_clockwise = sim::turning::mirrored;
  options.scanner.min_range_mm = 0.25;
  host_side mirrored(options);
  EXPECT_EQ(started(mirrored, 3 * second).suspect, 0U);
  // The measurement of a clockwise device in the mirrored room.
  sim::world room = sim::built_in_world();
  for (sim::wall& w : room.walls) {
    w.y1_m = 2 * room.lidar.y_m - w.y1_m;
    w.y2_m = 2 * room.lidar.y_m - w.y2_m;
  }
  room.lidar.heading_deg = -room.lidar.heading_deg;
  const sim::ray_caster caster(room);
  std::vector<sim::sent_sample> truth(5'000);
  truth.resize(mirrored.device.take_truth(truth));
  ASSERT_FALSE(truth.empty());
  for (const sim::sent_sample& s : truth) {
    const auto target = caster.cast(s.truth.first_level_deg);
    ASSERT_NEAR(s.truth.range_mm, target ? target->range_mm : 0.0, 1e-6);
  }
}

TEST(SimScanning, Restart_BootsAndResetsSettings) {
  for (const bool keeps : {false, true}) {
    sim::device_options options;
    options.settings_outlive_restart = keeps;
    host_side host(options);
    (void)host.ask(command::frequency_up_1_hz);
    (void)started(host, second);
    host.send(command::restart);
    (void)host.listen(5 * ms);  // bytes in transit
    EXPECT_FALSE(host.device.is_up());
    (void)host.ask(command::device_info, 300 * ms);
    const heard boot = host.hear(second);
    EXPECT_EQ(boot.responses, std::vector{response_kind::device_info}) << "unasked, and once";
    const std::string text(boot.bytes.begin(), boot.bytes.end());
    EXPECT_THAT(text, ::testing::StartsWith("G4 "));
    EXPECT_TRUE(host.device.is_idle_and_silent(host.now_ns));
    EXPECT_EQ(host.device.settings().scan_frequency_chz, keeps ? 800 : 700);
  }
}

TEST(SimScanning, StartDuringAScan_MayBeAnswered) {
  sim::device_options options;
  options.start_again_answers = true;
  options.while_scanning = sim::disturbance::between;
  host_side host(options);
  (void)started(host, second);
  EXPECT_EQ(started(host, second).responses, std::vector{response_kind::scan_started});
}

TEST(SimScanning, HealthError_MayRefuseTheStart) {
  sim::device_options options;
  options.condition = {health_status::error, 1};
  host_side willing(options);
  EXPECT_GT(started(willing, second).packets, 100U);
  options.error_refuses_start = true;
  host_side refusing(options);
  EXPECT_THAT(refusing.ask(command::start, second), IsEmpty());
}

// Each complete packet is in the truth, sample by sample, in the same order.
TEST(SimScanning, Truth_AgreesWithTheSentBytes) {
  sim::device_options options;
  options.scanner.noise_mm = 3.0;
  options.scanner.dropout_ratio = 0.05;
  host_side host(options);
  std::vector<sim::sent_sample> truth(16'384);
  const heard got = started(host, 1'500 * ms);
  truth.resize(host.device.take_truth(truth));
  std::size_t at = 0;
  for (const byte_vector& bytes : got.packet_bytes) {
    const auto packet = packet_view::from(bytes);
    for (std::size_t i = 0; i < packet->sample_count(); ++i, ++at) {
      ASSERT_LT(at, truth.size());
      const sim::sent_sample& s = truth[at];
      ASSERT_TRUE(s.whole);
      ASSERT_EQ(s.position, i);
      ASSERT_EQ(s.count, packet->sample_count());
      ASSERT_EQ(s.zero, packet->is_zero());
      ASSERT_EQ(s.truth.raw, packet->sample(i));
      ASSERT_EQ(s.truth.index, at);
      ASSERT_GE(s.sent_ns, s.truth.time_ns);
    }
  }
  // The truth includes samples that the bridge has not delivered yet.
  EXPECT_LE(truth.size() - at, 40U);
  EXPECT_EQ(host.device.truth_missed(), 0U);
}

TEST(SimScanning, TruthNotTaken_IsCounted) {
  sim::device_options options;
  options.truth_capacity = 100;
  host_side host(options);
  const heard got = started(host, second);
  std::vector<sim::sent_sample> truth(1'000);
  EXPECT_EQ(host.device.take_truth(truth), 100U);
  EXPECT_NEAR(static_cast<double>(host.device.truth_missed()),
              static_cast<double>(got.samples) - 100.0, 40.0);
}

}  // namespace
