// SPDX-License-Identifier: MIT
// Each kind of fault has its effect while it is active, and no other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "g4lidar/sim/device.hpp"
#include "support/host_side.hpp"

namespace {

using namespace g4lidar;
using sim::fault;
using sim::fault_kind;
using sim::make_fault;
using test::byte_vector;
using test::heard;
using test::host_side;
using test::ms;
using test::second;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

const byte_vector information = host_side().ask(command::device_info);

fault with_rate(fault f, double rate) {
  f.rate = rate;
  return f;
}
fault with_amount(fault f, std::int64_t amount) {
  f.amount = amount;
  return f;
}

// A device without stray bytes that starts to scan, and its bytes of 10 s.
heard ten_seconds(std::initializer_list<fault> faults) {
  sim::device_options options;
  options.stray_after_start = options.stray_before_zero = false;
  host_side host(options, faults);
  host.send(command::start);
  return host.hear(10 * second);
}

TEST(SimFaults, Bursts_HaveTheGivenLength) {
  const heard clean = ten_seconds({});
  const heard hit = ten_seconds({with_amount(with_rate(make_fault(fault_kind::burst), 1e-4), 50)});
  ASSERT_EQ(hit.bytes.size(), clean.bytes.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < clean.bytes.size(); ++i) wrong += clean.bytes[i] != hit.bytes[i];
  EXPECT_NEAR(static_cast<double>(wrong), 20 * 50.0, 500.0);
}

TEST(SimFaults, Stall_DelaysBytesAndLosesNone) {
  host_side host({}, {make_fault(fault_kind::stall, second, 100 * ms)});
  (void)host.ask(command::start, second);
  EXPECT_THAT(host.listen(99 * ms), IsEmpty());
  EXPECT_GT(host.listen(2 * ms).size(), 2'000U);
  const byte_vector steady = host.listen(100 * ms);
  EXPECT_NEAR(static_cast<double>(steady.size()), 2'036.0, 100.0);
}

TEST(SimFaults, Batch_DeliversBytesTogether) {
  host_side host({}, {with_amount(make_fault(fault_kind::batch), 16 * ms)});
  (void)host.ask(command::start, second);
  std::int64_t longest = 0;
  std::size_t batches = 0;
  for (const std::int64_t begin = host.now_ns; host.now_ns < begin + 10 * second; ++batches) {
    const std::int64_t before = host.now_ns;
    while (host.device.available(host.now_ns) == 0) {
      host.now_ns = std::max(host.device.next_ns(host.now_ns), host.now_ns + 1);
    }
    longest = std::max(longest, host.now_ns - before);
    (void)host.listen(1);
  }
  EXPECT_NEAR(static_cast<double>(batches), 10'000.0 / 8.0, 100.0) << "8 ms in the mean";
  EXPECT_GT(longest, 15 * ms);
  EXPECT_LT(longest, 17 * ms);
}

TEST(SimFaults, Late_DelaysAnswers) {
  host_side host({}, {with_amount(make_fault(fault_kind::late), 300 * ms)});
  EXPECT_THAT(host.ask(command::device_info, 299 * ms), IsEmpty());
  EXPECT_EQ(host.listen(10 * ms), information);
}

TEST(SimFaults, Wrong_SendsPossibleAnswers) {
  host_side host({}, {make_fault(fault_kind::wrong)});
  for (int i = 0; i < 50; ++i) {
    const heard got = test::taken_apart(host.ask(command::device_info));
    ASSERT_EQ(got.responses.size(), 1U);
    ASSERT_NE(got.responses.front(), response_kind::device_info);
    ASSERT_EQ(got.skipped_bytes, 0U);
  }
}

TEST(SimFaults, TwiceAndMute_RepeatOrOmitAnswers) {
  host_side twice({}, {make_fault(fault_kind::twice)});
  byte_vector both = information;
  both.insert(both.end(), information.begin(), information.end());
  EXPECT_EQ(twice.ask(command::device_info), both);
  host_side never({}, {make_fault(fault_kind::mute, 0, second)});
  EXPECT_THAT(never.ask(command::frequency_up_1_hz), IsEmpty());
  EXPECT_EQ(never.device.settings().scan_frequency_chz, 800) << "it was carried out";
  (void)never.listen(second);
  EXPECT_EQ(never.ask(command::device_info), information);
}

TEST(SimFaults, Rate_IsOfAllAnswers) {
  host_side host({}, {with_rate(make_fault(fault_kind::mute), 0.25)});
  int answered = 0;
  for (int i = 0; i < 400; ++i) answered += host.ask(command::health, 10 * ms).empty() ? 0 : 1;
  EXPECT_NEAR(answered, 300, 40);
}

TEST(SimFaults, Scanning_BeginsAtFullSpeed) {
  host_side host({}, {make_fault(fault_kind::scanning)});
  const heard got = host.hear(second);
  EXPECT_THAT(got.responses, IsEmpty()) << "no header";
  EXPECT_NEAR(static_cast<double>(got.zero_packets), 7.0, 1.0);
  host_side later({}, {make_fault(fault_kind::scanning, second)});
  EXPECT_THAT(later.listen(second), IsEmpty());
  EXPECT_GT(later.hear(second).packets, 200U);
}

TEST(SimFaults, BrownOut_SilencesTheDeviceUntilItEnds) {
  host_side host({}, {make_fault(fault_kind::brown_out, 0, 3 * second)});
  EXPECT_EQ(host.ask(command::device_info), information) << "without the motor nothing fails";
  const heard got = test::taken_apart(host.ask(command::start, second));
  EXPECT_EQ(got.responses.size(), 1U);
  EXPECT_LT(got.bytes.size(), 800U) << "30 ms of packets";
  EXPECT_TRUE(host.device.is_plugged(host.now_ns));
  EXPECT_THAT(host.ask(command::device_info, second), IsEmpty());
  EXPECT_EQ(host.hear(2 * second).responses.size(), 1U) << "it has booted";
  EXPECT_GT(test::taken_apart(host.ask(command::start, second)).packets, 100U);
}

TEST(SimFaults, MotorStoppedInTime_CausesNoBrownOut) {
  host_side host({}, {make_fault(fault_kind::brown_out)});
  (void)host.ask(command::start, 20 * ms);
  (void)host.ask(command::stop, second);
  EXPECT_EQ(host.ask(command::device_info), information);
}

TEST(SimFaults, BytesNotSentBeforePowerLoss_AreNeverSent) {
  host_side host({}, {make_fault(fault_kind::late)});
  (void)host.ask(command::health, 100 * ms);
  host.device.unplug(host.now_ns);
  host.device.replug(host.now_ns);
  EXPECT_EQ(host.hear(second).responses, std::vector{response_kind::device_info});
  EXPECT_EQ(host.ask(command::device_info, second), information);
}

TEST(SimFaults, Reboot_BootsAgain) {
  host_side host({}, {make_fault(fault_kind::reboot)});
  for (int i = 0; i < 3; ++i) {
    const heard got = test::taken_apart(host.ask(command::start, 2 * second));
    EXPECT_THAT(got.responses,
                ElementsAre(response_kind::scan_started, response_kind::device_info));
    EXPECT_TRUE(host.device.is_idle_and_silent(host.now_ns));
  }
}

TEST(SimFaults, UnplugAndReplug) {
  for (const bool outlives : {false, true}) {
    sim::device_options options;
    options.settings_outlive_power = outlives;
    host_side host(options, {make_fault(fault_kind::unplug, second, second)});
    (void)host.ask(command::frequency_up_1_hz);
    (void)host.ask(command::start, 940 * ms);
    EXPECT_TRUE(host.device.is_plugged(second - 1));
    EXPECT_EQ(host.device.next_plug_ns(), second);
    host.now_ns = second;
    EXPECT_FALSE(host.device.is_plugged(second));
    EXPECT_THAT(host.ask(command::device_info, second - 1 - 1), IsEmpty());
    EXPECT_EQ(host.device.replugs(), 0U);
    host.now_ns = 2 * second;
    EXPECT_TRUE(host.device.is_plugged(host.now_ns));
    EXPECT_EQ(host.device.replugs(), 1U);
    EXPECT_FALSE(host.device.is_up());
    EXPECT_THAT(host.hear(second).responses, ElementsAre(response_kind::device_info));
    EXPECT_EQ(host.device.settings().scan_frequency_chz, outlives ? 800 : 700);
  }
}

TEST(SimFaults, Health_ChangesAndRecovers) {
  host_side host({}, {make_fault(fault_kind::health, second, second)});
  const auto status = [&host] { return host.ask(command::health).at(7); };
  EXPECT_EQ(status(), 0);
  (void)host.listen(second);
  EXPECT_EQ(status(), 2);
  (void)host.listen(second);
  EXPECT_EQ(status(), 0);
}

TEST(SimFaults, Jolts_CauseSuspectPackets) {
  const heard got = ten_seconds({with_rate(make_fault(fault_kind::jolt), 0.1)});
  EXPECT_GT(got.suspect, 100U);
  EXPECT_EQ(ten_seconds({}).suspect, 0U);
}

TEST(SimFaults, Fault_EndsAfterItsDuration) {
  for (int kind = 0; kind <= static_cast<int>(sim::last_fault_kind); ++kind) {
    SCOPED_TRACE(name_of(static_cast<fault_kind>(kind)));
    fault f = make_fault(static_cast<fault_kind>(kind), second, second);
    if (f.rate < 1.0) f.rate = 0.01;
    sim::device_options options;
    options.stray_after_start = options.stray_before_zero = false;
    host_side host(options, {f});
    (void)host.ask(command::start, 3 * second);
    (void)host.ask(command::stop, second);
    (void)host.listen(second);
    EXPECT_EQ(host.ask(command::device_info), information);
    (void)host.ask(command::start, 2 * second);
    const heard steady = host.hear(2 * second);
    EXPECT_NEAR(static_cast<double>(steady.samples), 18'000.0, 80.0);
    EXPECT_LE(steady.skipped_bytes, 2 * max_packet_size);
    EXPECT_EQ(steady.suspect, 0U);
  }
}

// Packets that the truth flags as whole arrive, and no others (except errors that the checksum
// cannot detect, which do not occur with these seeds).
void expect_whole_packets_and_no_others(host_side& host, const heard& got) {
  std::vector<sim::sent_sample> truth(16'384);
  truth.resize(host.device.take_truth(truth));
  std::vector<std::uint16_t> whole;
  for (const sim::sent_sample& s : truth) {
    if (s.whole) whole.push_back(s.truth.raw);
  }
  EXPECT_LT(whole.size(), truth.size());
  std::vector<std::uint16_t> delivered;
  for (const byte_vector& bytes : got.packet_bytes) {
    const auto packet = packet_view::from(bytes);
    for (std::size_t i = 0; i < packet->sample_count(); ++i) {
      delivered.push_back(packet->sample(i));
    }
  }
  ASSERT_LE(delivered.size(), whole.size());
  EXPECT_LE(whole.size() - delivered.size(), 80U) << "but for what the bridge still holds";
  EXPECT_TRUE(std::equal(delivered.begin(), delivered.end(), whole.begin()));
}

TEST(SimFaults, Truth_FlagsDamagedPackets) {
  for (const fault_kind kind : {fault_kind::flip, fault_kind::drop, fault_kind::insert,
                                fault_kind::burst, fault_kind::truncate}) {
    SCOPED_TRACE(name_of(kind));
    host_side host({}, {make_fault(kind)});
    const heard got = test::taken_apart(host.ask(command::start, 1'700 * ms));
    expect_whole_packets_and_no_others(host, got);
  }
}

TEST(SimFaults, Truth_FlagsPacketsInterruptedByAnAnswer) {
  for (const sim::disturbance how : {sim::disturbance::mid_packet, sim::disturbance::drops}) {
    sim::device_options options;
    options.while_scanning = how;
    host_side host(options);
    byte_vector all = host.ask(command::start, 500 * ms);
    for (int i = 0; i < 20; ++i) {
      const byte_vector more = host.ask(command::device_info, 51 * ms);
      all.insert(all.end(), more.begin(), more.end());
    }
    expect_whole_packets_and_no_others(host, test::taken_apart(all));
  }
}

// The information is answered, the health is not.
TEST(SimFaults, OfOneCommand_LeaveTheOthers) {
  for (const fault_kind kind : {fault_kind::mute, fault_kind::wrong, fault_kind::twice}) {
    host_side clean;
    host_side host({}, {with_amount(make_fault(kind), 0x91)});
    EXPECT_EQ(host.ask(command::device_info), information);
    EXPECT_NE(host.ask(command::health), clean.ask(command::health));
    EXPECT_EQ(host.ask(command::health_vendor), clean.ask(command::health_vendor));
  }
}

}  // namespace
