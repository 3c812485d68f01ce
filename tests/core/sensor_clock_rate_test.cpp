// SPDX-License-Identifier: MIT
// The clock with models whose rate is known less well than that of a G4: what it promises for each of them.
#include <gtest/gtest.h>

#include <string>

#include "clock_errors.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/sensor_clock.hpp"
#include "support/arrival_model.hpp"
#include "support/test_scale.hpp"

namespace g4lidar {
namespace {

using arrivals::batching;
using arrivals::errors;

struct device_case {
  const char* word;
  double true_hz;  ///< Before the error of its oscillator.
  double error;    ///< The largest one of its oscillator, to both sides.
  std::uint32_t baud;
};

std::ostream& operator<<(std::ostream& out, const device_case& which) {
  return out << which.word << " with " << which.true_hz << " Hz";
}

/// The rate of its model, and those that are not known in advance.
class ClockOfAModel : public testing::TestWithParam<device_case> {
 protected:
  /// Behind a bridge with a timer, an X2 may have a wrong bound: owners have seen rates that are far apart.
  static bool is_unsure(batching mode) {
    return mode == batching::ticks && model_named(GetParam().word)->rates.least_seen_hz != 0;
  }
  /// From `after_s` on, for a device that is like the model in everything that its model states.
  static errors run(batching mode, std::uint64_t seed, double after_s, double seconds) {
    const device_case& of = GetParam();
    const model& which = *model_named(of.word);
    arrivals::options how = arrivals::drawn({.mode = mode}, seed);
    how.nominal_hz = of.true_hz;
    how.rate_error *= of.error / 0.03;
    how.baud = of.baud;
    how.layout = which.samples.layout;
    arrivals::model device(how);
    const expected_rate rate = expected_rate_of(which, first_rate_hz(which));
    sensor_clock clock({.baud = of.baud, .layout = which.samples.layout});
    clock.reset(rate);
    errors found;
    found.after_s = after_s;
    while (device.now_s() < seconds) {
      const arrivals::delivery next = device.next();
      found.add(next, arrivals::stamp(clock, next, {}), how.start_ns);
    }
    return found;
  }
};

constexpr auto bridges = {batching::direct, batching::ticks, batching::gaps};

TEST_P(ClockOfAModel, KeepsThePromiseOfAG4AfterFiveSeconds) {
  for (const batching mode : bridges) {
    for (const int seed : test::seeds(4)) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(mode) << ", seed " << seed);
      errors found = run(mode, static_cast<std::uint64_t>(seed), 5.0, 20.0);
      EXPECT_LT(found.rms_us(), 200.0);
      EXPECT_LT(found.worst_us(), 1000.0);
      if (!is_unsure(mode)) {
        EXPECT_LT(found.broken_share(), 1e-3);
        EXPECT_LT(found.median_bound_us(), 500.0);
      }
      EXPECT_TRUE(found.grows);
      EXPECT_LT(found.wrong_counts, 4);
    }
  }
}

TEST_P(ClockOfAModel, ItsBoundHoldsFromTheFirstPacketOn) {
  for (const batching mode : bridges) {
    for (const int seed : test::seeds(4)) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(mode) << ", seed " << seed);
      const errors found = run(mode, static_cast<std::uint64_t>(seed), 0.0, 5.0);
      EXPECT_LT(found.worst_us(), 60e3);
      EXPECT_TRUE(found.grows);
      if (is_unsure(mode)) continue;
      EXPECT_LT(found.broken_share(), 1e-3);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Family, ClockOfAModel,
    testing::Values(
        device_case{"x4", 5000, 0.09, 128'000}, device_case{"x2", 3000, 0.09, 115'200},
        device_case{"x2", 2500, 0.0, 115'200}, device_case{"x2", 2575, 0.001, 115'200},
        device_case{"x2", 3500, 0.001, 115'200}, device_case{"x2", 3600, 0.0, 115'200},
        device_case{"t-mini", 4000, 0.09, 230'400}, device_case{"g4b", 10'000, 0.09, 512'000},
        device_case{"x3-pro", 3000, 0.09, 115'200}, device_case{"x3-pro", 4000, 0.09, 115'200},
        device_case{"s2", 3000, 0.09, 115'200}, device_case{"s2", 4000, 0.09, 115'200},
        device_case{"s2", 5000, 0.09, 128'000}, device_case{"tg15", 10'000, 0.09, 512'000},
        device_case{"tg15", 18'000, 0.09, 512'000}, device_case{"tg15", 20'000, 0.09, 512'000}));

}  // namespace
}  // namespace g4lidar
