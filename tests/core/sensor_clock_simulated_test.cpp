// SPDX-License-Identifier: MIT
// When samples were measured, from the bytes of the simulated G4, compared with its true times: the
// clock used as its header describes, with a connection of 230400 baud and a bridge that holds
// bytes back.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <limits>
#include <numbers>
#include <variant>
#include <vector>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/sensor_clock.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/sim/random.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "g4lidar/sim/world.hpp"
#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

constexpr std::int64_t start_ns = 7'000'000'000'000;  // of the device, in the program's time

/// A byte and the time when it was transmitted, after start_ns.
struct timed_byte {
  std::uint8_t value;
  double time_ns;
};

/// The errors of points from 5 s on.
struct errors {
  double points = 0.0;
  double square_sum = 0.0;
  double worst_ns = 0.0;
  double broken = 0.0;
  bool grows = true;
  std::vector<double> bounds;
  std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();

  void add(const packet_times& times, const std::vector<std::int64_t>& truth) {
    for (std::size_t i = 0; i < truth.size(); ++i) {
      grows = grows && times.at(i) > last_ns;
      last_ns = times.at(i);
      if (truth[i] < 5'000'000'000) continue;
      const auto error = static_cast<double>(times.at(i) - start_ns - truth[i]);
      points += 1.0;
      square_sum += error * error;
      worst_ns = std::max(worst_ns, std::abs(error));
      if (std::abs(error) > static_cast<double>(times.bound_ns)) broken += 1.0;
      bounds.push_back(static_cast<double>(times.bound_ns));
    }
  }
};

/// The device, its connection, and the program that reads it.
class simulated_run {
 public:
  simulated_run(std::uint64_t seed, double ratio)
      : dice_(seed, 1),
        device_(sim::built_in_world(),
                {.seed = seed, .sample_rate_ratio = ratio, .sample_rate_drift_ppm = 200.0}) {}

  errors run(double seconds) {
    while (now_ns_ < seconds * 1e9) {
      // A bridge that has delivered waits for a byte, then for up to 16 ms, and delivers again.
      while (sent_.empty()) send_packet();
      now_ns_ = std::max(now_ns_, sent_.front().time_ns) + 16e6 * dice_.uniform();
      while (sent_ns_ < now_ns_) send_packet();
      deliver();
    }
    return found_;
  }
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  [[nodiscard]] std::int64_t counted() const { return counted_; }

 private:
  /// Every fiftieth packet is damaged or lost. The speed of the motor varies by 3 % up and down.
  void send_packet() {
    const double phase = 2.0 * std::numbers::pi * sent_ns_ / 17e9;
    device_.set_speed_mhz(static_cast<std::uint32_t>(7000.0 * (1.0 + 0.03 * std::sin(phase))));
    const sim::sent_packet sent = device_.next();
    const bool damaged = dice_.uniform() < 0.01;
    const bool dropped = !damaged && dice_.uniform() < 0.01;
    double at_ns = std::max(sent_ns_, static_cast<double>(sent.complete_ns));
    for (std::size_t i = 0; i < sent.data.size(); ++i) {
      at_ns += 10e9 / 230400.0;
      const auto flipped = static_cast<std::uint8_t>(damaged && i == 8 ? 0x10U : 0U);
      const auto value = static_cast<std::uint8_t>(sent.data[i] ^ flipped);
      if (!dropped) sent_.push_back({value, at_ns});
    }
    sent_ns_ = at_ns;
    if (damaged || dropped) {
      lost_ += static_cast<std::int64_t>(sent.samples.size());
      return;
    }
    std::vector<std::int64_t> times;
    for (const sim::sample_truth& sample : sent.samples) times.push_back(sample.time_ns);
    truths_.push_back(times);
  }

  void deliver() {
    std::vector<std::uint8_t> chunk;
    while (!sent_.empty() && sent_.front().time_ns <= now_ns_) {
      chunk.push_back(sent_.front().value);
      sent_.pop_front();
    }
    const double late_ns = -30e3 * std::log(1.0 - dice_.uniform());  // until the program runs
    const std::int64_t arrival_ns = start_ns + static_cast<std::int64_t>(now_ns_ + late_ns);
    parser_.feed(chunk, [&](const event& what) { take(what, arrival_ns); });
    if (parser_.held() >= packet_header_size) clock_.seen(parser_.held(), arrival_ns);
  }

  void take(const event& what, std::int64_t arrival_ns) {
    if (const auto* gone = std::get_if<skipped>(&what)) {
      if (gone->reason != skip_reason::noise) clock_.lost(gone->count);
    }
    const auto* packet = std::get_if<packet_view>(&what);
    if (packet == nullptr) return;
    ASSERT_FALSE(truths_.empty());
    ASSERT_EQ(packet->sample_count(), truths_.front().size());
    const decoded points = decode(*packet, compact_correction{}, 0, memory_);
    const packet_times times = clock_.stamp(points, arrival_ns);
    counted_ += times.lost;
    found_.add(times, truths_.front());
    truths_.pop_front();
  }

  sim::random_stream dice_;
  sim::scanner device_;
  double sent_ns_ = 0.0;
  double now_ns_ = 0.0;
  std::deque<timed_byte> sent_;
  std::deque<std::vector<std::int64_t>> truths_;
  stream_parser parser_;
  sensor_clock clock_;
  std::array<point, max_samples> memory_{};
  errors found_;
  std::int64_t lost_ = 0;
  std::int64_t counted_ = 0;
};

TEST(SensorClockSimulated, KeepsItsPromiseAgainstTheTruth) {
  constexpr std::array<double, 3> ratios{0.97, 1.03, 1.0};
  for (const int seed : test::seeds(6)) {
    const double ratio = ratios[static_cast<std::size_t>(seed % 3)];
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", rate times " << ratio);
    simulated_run one(static_cast<std::uint64_t>(seed), ratio);
    errors found = one.run(30.0);
    ASSERT_GT(found.points, 200'000.0);
    const double rms_us = std::sqrt(found.square_sum / found.points) / 1e3;
    const auto middle = found.bounds.begin() + std::ssize(found.bounds) / 2;
    std::nth_element(found.bounds.begin(), middle, found.bounds.end());
    std::printf("  rate times %.2f: rms %.1f us, worst %.1f us, bound %.1f us, broken %.5f\n",
                ratio, rms_us, found.worst_ns / 1e3, *middle / 1e3, found.broken / found.points);
    EXPECT_LT(rms_us, 200.0);
    EXPECT_LE(found.worst_ns, 1e6);
    EXPECT_LT(found.broken / found.points, 1e-3);
    EXPECT_LE(*middle, 500e3);
    EXPECT_TRUE(found.grows);
    EXPECT_GT(one.lost(), 1000);
    EXPECT_NEAR(static_cast<double>(one.counted()), static_cast<double>(one.lost()), 80.0);
  }
}

}  // namespace
}  // namespace g4lidar
