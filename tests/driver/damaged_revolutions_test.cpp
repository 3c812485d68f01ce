// SPDX-License-Identifier: MIT
// Revolutions of a damaged stream, compared with the true values of the simulated device: which of
// the intact points they contain, that none is more than one turn, and that their flags are right.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <ranges>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/device.hpp"
#include "support/measured_truth.hpp"
#include "support/test_scale.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::measured_truth;

struct damage {
  const char* name;
  sim::fault_kind kind;
  double rate;
};

class DamagedRevolutions : public testing::TestWithParam<damage> {
 protected:
  static constexpr std::int64_t run_ns = 60'000'000'000;

  void run(std::uint64_t seed) {
    scans_.clear();
    sim::fault fault = sim::make_fault(GetParam().kind, 3'000'000'000);
    fault.rate = GetParam().rate;
    sim::device_options options;
    options.scanner.seed = seed;
    options.truth_capacity = 700'000;
    test::virtual_bench bench(options, std::span(&fault, 1));
    auto device = test::open_virtual(bench);
    ASSERT_TRUE(device) << device.error().message();
    ASSERT_TRUE(device->start());
    const std::int64_t end_ns = bench.now_ns + run_ns;
    while (bench.now_ns < end_ns) {
      const auto found = device->try_scan(2000ms);  // also while it spins up
      ASSERT_TRUE(found) << found.error().message();
      scans_.emplace_back(*found, std::vector<point>(found->begin(), found->end()));
    }
    EXPECT_EQ(device->counts().scans_missed, 0U);
    truth_ = measured_truth::of(bench.device, options.truth_capacity);
  }

  /// The truth of a point: the next intact sample with its values.
  const sim::sample_truth* truth_of(const point& seen) {
    return truth_.next(5'000, [&](const sim::sample_truth& each) {
      return std::abs(each.time_ns - seen.time_ns) <= 20'000'000 &&
             test::looks_like(each, static_cast<double>(seen.angle_deg),
                              static_cast<double>(seen.range_mm));
    });
  }

  /// The number of points of each revolution in a scan, and of points of none: two flipped bits at
  /// the same position do not change the checksum of a packet.
  struct share {
    std::map<std::uint64_t, std::size_t> of;
    std::size_t unknown = 0;
  };

  void expect_one_turn(const scan& found, const share& shares) const {
    // The cut by the angle is exact to one sample.
    std::size_t foreign = found.size();
    for (const auto& [revolution, count] : shares.of) {
      foreign = std::min(foreign, found.size() - shares.unknown - count);
    }
    EXPECT_LE(foreign, 2U) << found.revolution;
    EXPECT_LE(found.turned_deg, 361.0F + 45.0F) << found.revolution;
  }

  void expect_flags(const scan& found, const share& shares) const {
    const auto [revolution, count] =
        *std::max_element(shares.of.begin(), shares.of.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; });
    const bool is_complete = count + shares.unknown >= truth_.revolutions().at(revolution).sent;
    // The loss of the next zero packet does not make this one less complete.
    const bool ended = !found.has(scan_flags::end_by_angle);
    EXPECT_TRUE(!found.is_whole() || is_complete) << revolution;
    EXPECT_TRUE(!is_complete || found.is_whole() || !ended) << revolution;
    EXPECT_FALSE(found.has(scan_flags::start_by_angle) && is_complete) << revolution;
    EXPECT_FALSE(found.is_piece());
  }

  void expect_intact_points() {
    std::size_t delivered = 0;
    std::size_t unknown = 0;
    for (const auto& [found, points] : scans_) {
      share shares;
      for (const point& each : points) {
        const sim::sample_truth* const truth = truth_of(each);
        if (truth == nullptr) {
          ++shares.unknown;
          continue;
        }
        ++delivered;
        ++shares.of[truth->revolution];
      }
      unknown += shares.unknown;
      ASSERT_FALSE(shares.of.empty());
      expect_one_turn(found, shares);
      expect_flags(found, shares);
    }
    // All except the pieces at the start and at the end.
    const std::size_t intact = truth_.intact();
    EXPECT_GE(static_cast<double>(delivered), 0.99 * static_cast<double>(intact));
    EXPECT_LE(delivered, intact + truth_.revolutions().rbegin()->second.intact + 2);
    EXPECT_LE(unknown, intact / 1000);
    RecordProperty("delivered", std::to_string(delivered) + " of " + std::to_string(intact));
  }

  std::vector<std::pair<scan, std::vector<point>>> scans_;
  measured_truth truth_;
};

TEST_P(DamagedRevolutions, HoldTheIntactPointsAndNoneIsMerged) {
  // Flipped bits that the checksum does not find may damage an angle: not for each seed.
  const bool is_flip = GetParam().kind == sim::fault_kind::flip;
  for (const int seed : is_flip ? std::views::iota(1, 2) : test::seeds(1)) {
    SCOPED_TRACE(seed);
    ASSERT_NO_FATAL_FAILURE(run(static_cast<std::uint64_t>(seed)));
    ASSERT_NO_FATAL_FAILURE(expect_intact_points());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, DamagedRevolutions,
    testing::Values(damage{"NoBytes", sim::fault_kind::flip, 1e-9},
                    damage{"OneFlippedInTenThousand", sim::fault_kind::flip, 1e-4},
                    damage{"OneFlippedInThousand", sim::fault_kind::flip, 1e-3},
                    damage{"OnePacketTruncatedInHundred", sim::fault_kind::truncate, 1e-2},
                    damage{"OneByteDroppedInThousand", sim::fault_kind::drop, 1e-3}),
    [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace g4lidar
