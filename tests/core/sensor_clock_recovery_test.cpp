// SPDX-License-Identifier: MIT
// When samples were measured: after delays, wrong counts and restarts, and the parts of the interface.
#include "g4lidar/core/sensor_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>

#include "clock_errors.hpp"
#include "support/allocation_count.hpp"
#include "support/arrival_model.hpp"
#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

using arrivals::batching;
using arrivals::delivery;
using arrivals::drawn;
using arrivals::errors;
using arrivals::hints;
using arrivals::model;
using arrivals::simulate;
using arrivals::stamp;

TEST(SensorClock, SuspendedProgram_KeepsTheTimes) {
  errors all;
  for (const int seed : test::seeds(10)) {
    for (const batching mode : {batching::direct, batching::ticks, batching::gaps}) {
      const arrivals::options o = drawn({.mode = mode, .loss = 0.01, .stalls_per_s = 0.3},
                                        static_cast<std::uint64_t>(seed));
      all.add(simulate(o, {}, 25.0));
    }
  }
  all.print("sleeps of up to 1 s, losses");
  EXPECT_LT(all.rms_us(), 200.0);
  EXPECT_LT(all.worst_us(), 1000.0);
  EXPECT_LT(all.broken_share(), 1e-3);
  EXPECT_TRUE(all.grows);
}

// After a suspension the waiting packets are read at three times the rate of the connection.
TEST(SensorClock, ProgramThatCatchesUpSlowly_KeepsTheTimes) {
  const arrivals::options o{.mode = batching::gaps};
  model device(o);
  sensor_clock clock;
  errors found;
  while (device.now_s() < 15.0) {
    delivery d = device.next();
    const auto ready = static_cast<double>(d.arrival_ns - o.start_ns);
    if (ready > 8e9) {
      const double read = 9e9 + (ready - 8e9) / 3.0;
      d.arrival_ns = o.start_ns + static_cast<std::int64_t>(std::max(ready, read));
    }
    found.add(d, stamp(clock, d, {.seen = false}), o.start_ns);
  }
  EXPECT_LT(found.worst_us(), 1000.0);
  EXPECT_EQ(found.broken, 0.0);
}

/// A run in which all packets of an interval are 150 ms late; its errors from `after_s` on.
errors errors_with_delay(double until_s, double after_s) {
  const arrivals::options o{.mode = batching::direct};
  model device(o);
  sensor_clock clock;
  errors found;
  found.after_s = after_s;
  while (device.now_s() < 15.0) {
    delivery d = device.next();
    if (device.now_s() > 8.0 && device.now_s() < until_s) d.arrival_ns += 150'000'000;
    found.add(d, stamp(clock, d, {}), o.start_ns);
  }
  return found;
}

TEST(SensorClock, DelayOfASecond_KeepsTheTimes) {
  EXPECT_LT(errors_with_delay(9.0, 5.0).worst_us(), 1000.0);
}

// A longer delay looks like lost samples first, and later not.
TEST(SensorClock, DetectsTimesThatAreTooLate) {
  const errors found = errors_with_delay(9.4, 9.4);
  EXPECT_GT(found.worst_us(), 100'000.0);
  EXPECT_LT(found.broken, 600.0);  // points, of more than 1,300
  EXPECT_TRUE(found.grows);
  EXPECT_LT(errors_with_delay(9.4, 10.4).worst_us(), 1000.0);
}

// Three and a half packets in 16 ms: the packets beat with the bridge's timer.
TEST(SensorClock, ToleratesABeat) {
  errors all;
  for (const int seed : test::seeds(12)) {
    arrivals::options o{.seed = static_cast<std::uint64_t>(seed)};
    o.rate_error = -0.0282;
    o.motor_hz = 9.91;
    all.add(simulate(o, {.seen = false}, 40.0));
  }
  all.print("a beat, whole packets alone");
  EXPECT_LT(all.worst_us(), 1500.0);
  EXPECT_LT(all.broken_share(), 1e-3);
}

// The motor jumps once: the angle shows samples that did not exist.
TEST(SensorClock, RecoversFromWrongCounts) {
  for (const int wrong : {3, 40, 400, 1000}) {
    SCOPED_TRACE(wrong);
    const arrivals::options o{.mode = batching::gaps};
    model device(o);
    sensor_clock clock;
    errors at_once;
    at_once.after_s = 8.0;
    errors soon;
    soon.after_s = 8.5;
    errors later;
    later.after_s = 10.0;
    int jump = 0;
    while (device.now_s() < 15.0) {
      delivery d = device.next();
      if (device.now_s() > 8.0) jump = wrong * 7 * 23040 / 9000;
      d.packet.first_angle_64ths =
          static_cast<std::uint16_t>((d.packet.first_angle_64ths + jump) % 23040);
      const packet_times times = stamp(clock, d, {});
      at_once.add(d, times, o.start_ns);
      soon.add(d, times, o.start_ns);
      later.add(d, times, o.start_ns);
    }
    EXPECT_LT(later.worst_us(), 1000.0);
    EXPECT_LT(at_once.broken, 600.0);  // points, until the first early arrival
    EXPECT_LT(soon.broken_share(), 1e-3);
    EXPECT_TRUE(soon.grows);
  }
}

TEST(SensorClock, Restart_WidensTheBoundFor250ms) {
  const arrivals::options o{.rate_error = 0.02, .mode = batching::gaps};
  arrivals::options again = o;
  again.seed = 2;
  again.start_ns = o.start_ns + 12'000'000'000;
  model first(o);
  model second(again);
  sensor_clock clock;
  while (first.now_s() < 10.0) stamp(clock, first.next(), {});
  const std::int64_t bound_before = clock.bound_ns();
  clock.reset();
  errors found;
  found.after_s = 0.0;
  errors soon;
  soon.after_s = 0.25;
  std::int64_t bound_after = 0;
  while (second.now_s() < 10.0) {
    const delivery d = second.next();
    const packet_times times = stamp(clock, d, {});
    if (bound_after == 0) bound_after = times.bound_ns;
    found.add(d, times, again.start_ns);
    soon.add(d, times, again.start_ns);
    EXPECT_NEAR(clock.sample_rate_hz(), 9000.0 * 1.02, 9.0);  // 0.1 %, from the first packet on
  }
  EXPECT_GT(bound_after, 10 * bound_before);
  EXPECT_LT(found.broken_share(), 1e-3);
  EXPECT_LT(soon.worst_us(), 1000.0);  // the rate is known
}

TEST(SensorClock, Restart_FollowsAnotherDevice) {
  const arrivals::options o{.rate_error = 0.02};
  const arrivals::options other{.rate_error = -0.02, .start_ns = o.start_ns + 12'000'000'000};
  model first(o);
  model second(other);
  sensor_clock clock;
  while (first.now_s() < 10.0) stamp(clock, first.next(), {});
  clock.reset();
  errors found;
  found.after_s = 25.0;
  while (second.now_s() < 30.0) {
    const delivery d = second.next();
    found.add(d, stamp(clock, d, {}), other.start_ns);
  }
  EXPECT_LT(found.worst_us(), 1000.0);
}

TEST(SensorClock, AcceptsAnotherNominalRate) {
  sensor_clock clock({.sample_rate_hz = 9000.0});
  model fast(arrivals::options{});
  while (fast.now_s() < 6.0) stamp(clock, fast.next(), {});
  clock.reset({4000.0, 0.04});
  const arrivals::options o{.nominal_hz = 4000.0, .start_ns = 1'010'000'000'000};
  model slow(o);
  errors found;
  while (slow.now_s() < 10.0) {
    const delivery d = slow.next();
    found.add(d, stamp(clock, d, {}), o.start_ns);
  }
  EXPECT_LT(found.worst_us(), 1000.0);
}

TEST(SensorClock, SubtractsTheTransportDelay) {
  const arrivals::options o{.mode = batching::poll, .delay_ns = 7e6};
  for (const std::int64_t delay_ns : {0, 7'000'000}) {
    model device(o);
    sensor_clock clock({.transport_delay_ns = delay_ns});
    errors found;
    while (device.now_s() < 8.0) {
      const delivery d = device.next();
      found.add(d, stamp(clock, d, {}), o.start_ns);
    }
    EXPECT_NEAR(found.rms_us(), delay_ns == 0 ? 7000.0 : 0.0, 150.0);
  }
}

TEST(SensorClock, SubtractsTheTransmissionTime) {
  const arrivals::options o{.samples = 40, .mode = batching::direct};
  model device(o);
  sensor_clock clock({.baud = 0});
  errors found;
  while (device.now_s() < 8.0) {
    const delivery d = device.next();
    found.add(d, stamp(clock, d, {}), o.start_ns);
  }
  // Nothing is subtracted: at least the 12 bytes of a zero packet, at most the 90 of the others.
  EXPECT_GT(found.rms_us(), 300.0);
  EXPECT_LT(simulate(o, {}, 8.0).worst_us(), 300.0);
}

TEST(SensorClock, UsesTheEarlierPartOfAPacket) {
  sensor_clock with;
  sensor_clock without;
  decoded packet;
  packet.sample_count = 40;
  with.seen(20, 1'000'000'000);
  with.seen(60, 1'016'000'000);
  with.seen(9, 900'000'000);  // not a complete header
  const std::int64_t late = without.stamp(packet, 1'016'500'000).at(39);
  const std::int64_t early = with.stamp(packet, 1'016'500'000).at(39);
  // 20 bytes by 1.000 s mean 0.999132 s; 90 by 1.0165 s mean 1.012594 s.
  EXPECT_NEAR(static_cast<double>(late - early), 13'462'000.0, 1'000.0);
  with.seen(20, 1'000'000'000);
  with.lost(20);  // no packet was lost
  without.lost(20);
  EXPECT_EQ(with.stamp(packet, 1'030'000'000).bound_ns,
            without.stamp(packet, 1'030'000'000).bound_ns);
}

TEST(SensorClock, ForgetsAPartOfALostPacket) {
  const arrivals::options o{.mode = batching::direct};
  model device(o);
  sensor_clock clock;
  while (device.now_s() < 6.0) stamp(clock, device.next(), {});
  delivery gone = device.next();
  while (gone.packet.sample_count < 40) gone = device.next();
  const delivery after = device.next();
  sensor_clock hinted = clock;
  hinted.seen(20, gone.arrival_ns - 100'000'000);
  EXPECT_EQ(hinted.stamp(after.packet, after.arrival_ns).first_ns,
            clock.stamp(after.packet, after.arrival_ns).first_ns);
}

TEST(SensorClock, WritesTimesIntoPoints) {
  std::array<point, 40> points{};
  sensor_clock clock;
  decoded packet;
  packet.sample_count = 40;
  const packet_times times = clock.stamp(packet, 5'000'000'000);
  times.write_to(points);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(points[i].time_ns, times.at(i));
  EXPECT_NEAR(static_cast<double>(points[39].time_ns - points[0].time_ns), 39e9 / 9000.0, 3e5);
}

TEST(SensorClock, TimesIncreaseForAnyInput) {
  for (const int seed : test::seeds(200)) {
    model dice(arrivals::options{.seed = static_cast<std::uint64_t>(seed)});
    sensor_clock clock({.sample_rate_hz = 1000.0 + 20'000.0 * dice.uniform(),
                        .transport_delay_ns = static_cast<std::int64_t>(dice.bits() >> 40),
                        .baud = dice.bits() % 2 == 0 ? 0U : 230400U});
    std::int64_t now = -(std::int64_t{1} << (dice.bits() % 61));
    std::int64_t last = std::numeric_limits<std::int64_t>::min();
    for (int step = 0; step < 400; ++step) {
      const std::uint64_t kind = dice.bits();
      if (kind % 7 == 0) clock.lost(static_cast<std::size_t>(kind >> 50));
      const auto part = static_cast<std::size_t>((kind >> 40) % 200);
      if (kind % 3 == 0) clock.seen(part, now - static_cast<std::int64_t>(kind >> 34));
      if (kind % 61 == 0) clock.reset();
      const std::uint64_t ahead = dice.bits() >> (8 + dice.bits() % 56);
      if (now < (std::int64_t{1} << 60)) now += static_cast<std::int64_t>(ahead);
      if (kind % 11 == 0) now -= static_cast<std::int64_t>(ahead / 2);
      decoded packet;
      packet.sample_count = static_cast<std::uint16_t>((kind >> 8) % 81);
      packet.first_angle_64ths = static_cast<std::uint16_t>((kind >> 16) % 23040);
      packet.span_64ths = static_cast<std::int16_t>((kind >> 32) % 23040);
      packet.suspect = kind % 5 == 0;
      const packet_times times = clock.stamp(packet, now);
      ASSERT_GE(times.bound_ns, 0) << "seed " << seed;
      for (std::size_t i = 0; i < std::max<std::size_t>(packet.sample_count, 1); ++i) {
        ASSERT_GT(times.at(i), last) << "seed " << seed << ", step " << step << ", sample " << i;
        last = times.at(i);
      }
    }
  }
}

TEST(SensorClock, NeverAllocates) {
  const arrivals::options o{.loss = 0.05, .stalls_per_s = 0.5};
  model device(o);
  std::int64_t sum = 0;
  EXPECT_EQ(test::allocations_in([&] {
              sensor_clock clock;
              while (device.now_s() < 3.0) sum += stamp(clock, device.next(), {}).first_ns;
              clock.reset();
            }),
            0U);
  EXPECT_NE(sum, 0);
}

constexpr std::int64_t last_of_twenty_packets() {
  sensor_clock clock;
  decoded packet;
  packet.sample_count = 40;
  std::int64_t last = 0;
  for (int i = 0; i < 20; ++i) last = clock.stamp(packet, 5'000'000 + i * 4'444'444).at(39);
  return last;
}
static_assert(last_of_twenty_packets() < 5'000'000 + 19 * 4'444'444 - 3'906'250);

}  // namespace
}  // namespace g4lidar
