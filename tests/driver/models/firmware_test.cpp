// SPDX-License-Identifier: MIT
// Old and new firmware, and codes of sample rates: points, live and replayed, against the truth of the simulator.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/sim/setup.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "recording/recorded_run.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::temporary_path;

/// What five scans contain.
struct scans_seen {
  std::vector<point> points;
  std::vector<int> frequencies_chz;
  device_information who;
};

scans_seen scans_of(lidar& from) {
  scans_seen all{};
  EXPECT_TRUE(from.start());
  for (int i = 0; i < 5; ++i) {
    const auto scan = from.wait_scan(2000ms);
    EXPECT_TRUE(scan) << i << ": " << scan.error().message();
    if (!scan) break;
    all.points.insert(all.points.end(), scan->points.begin(), scan->points.end());
    if (i > 1) all.frequencies_chz.push_back(scan->reported_frequency_chz);
  }
  all.who = from.information();
  return all;
}

struct firmware_case {
  const char* source;      ///< Of the simulated lidar.
  const char* word;        ///< Of its model.
  double units_per_mm;     ///< Of a sample.
  std::int32_t zero_cdeg;  ///< What 93 answers.
  bool has_correction;     ///< Of the angle by the range.
};

void PrintTo(const firmware_case& of, std::ostream* out) { *out << of.source; }

// By the notes on the family: a TG up to firmware 1.2 sends half millimetres and the frequency as it is,
// later whole ones and 3 Hz too little; an R2 answers 93 in quarters of a degree up to 1.7, later in hundredths.
constexpr firmware_case cases[] = {
    {"sim:?model=tg15&firmware=1.2", "tg15", 2.0, 2050, false},
    {"sim:?model=tg15&firmware=1.3", "tg15", 1.0, 2050, false},
    {"sim:?model=tg30&firmware=1.0", "tg30", 2.0, -800, false},
    {"sim:?model=tg50&firmware=2.0", "tg50", 1.0, -800, false},
    {"sim:?model=r2&firmware=1.7", "r2", 4.0, 1050, true},
    {"sim:?model=r2&firmware=1.8", "r2", 4.0, 1050, true},
};

class LiveFirmware : public ::testing::TestWithParam<firmware_case> {
 protected:
  LiveFirmware() {
    auto read = sim::parse_setup(GetParam().source);
    EXPECT_TRUE(std::holds_alternative<sim::setup>(read));
    options_ = std::get<sim::setup>(read).device;
    options_.zero_angle_cdeg = GetParam().zero_cdeg;
    options_.truth_capacity = 200'000;
  }

  /// Records what it returns.
  scans_seen live(std::string_view path) {
    sim::device device(sim::built_in_world(), options_);
    sim::virtual_clock clock;
    const model* const which = model_named(GetParam().word);
    auto writer = recording_writer::create(std::string(path), {.model = which});
    EXPECT_TRUE(writer);
    auto from = recorded(std::make_unique<sim::virtual_connector>(device, clock), *writer);
    EXPECT_TRUE(from);
    auto opened = lidar::open(std::move(*from), {.model = which});
    EXPECT_TRUE(opened) << opened.error().message();
    if (!opened) return {};
    scans_seen seen = scans_of(*opened);
    EXPECT_TRUE(opened->close());
    EXPECT_TRUE(writer->close());
    sent_.resize(200'000);
    sent_.resize(device.take_truth(sent_));
    return seen;
  }

  /// Where in the truth the points begin; points are samples one after the other.
  [[nodiscard]] std::size_t place_of(const std::vector<point>& points) const {
    constexpr std::size_t enough = 200;
    for (std::size_t at = 0; at + points.size() <= sent_.size(); ++at) {
      std::size_t i = 0;
      while (i < enough && is_raw_of(points[i], sent_[at + i].truth)) ++i;
      if (i == enough) return at;
    }
    return sent_.size();
  }
  [[nodiscard]] static bool is_raw_of(const point& seen, const sim::sample_truth& truth) {
    const double range_mm = truth.raw / GetParam().units_per_mm;
    return std::abs(static_cast<double>(seen.range_mm) - range_mm) < 1e-3;
  }

  sim::device_options options_;
  std::vector<sim::sent_sample> sent_;
};

TEST_P(LiveFirmware, PointsAreTheTruth_LiveAndReplayed) {
  const temporary_path path;
  const scans_seen seen = live(path.text());
  ASSERT_GT(seen.points.size(), 2'000U);
  const std::size_t begin = place_of(seen.points);
  ASSERT_LT(begin, sent_.size()) << "no samples of the device have these ranges";
  for (std::size_t i = 0; i < seen.points.size(); ++i) {
    const point& each = seen.points[i];
    const sim::sample_truth& truth = sent_[begin + i].truth;
    ASSERT_TRUE(is_raw_of(each, truth)) << i;
    if (truth.raw == 0) continue;
    // The scanner has a noise of some millimetres.
    EXPECT_NEAR(each.range_mm, truth.range_mm, 30.0 + 0.03 * truth.range_mm) << i;
    // The noise of the range changes the correction of near points.
    const double true_deg = GetParam().has_correction ? truth.bearing_deg : truth.first_level_deg;
    const double apart_deg = std::remainder(static_cast<double>(each.angle_deg) - true_deg, 360.0);
    EXPECT_LT(std::abs(apart_deg), GetParam().has_correction ? 0.5 : 0.1) << i;
  }
  for (const int chz : seen.frequencies_chz) EXPECT_NEAR(chz, 700, 10);

  auto from = replay::open(path.text(), {.speed = 0});
  ASSERT_TRUE(from) << from.error().message();
  auto opened = lidar::open(std::move(*from));
  ASSERT_TRUE(opened) << opened.error().message();
  const scans_seen again = scans_of(*opened);
  EXPECT_EQ(again.frequencies_chz, seen.frequencies_chz);
  ASSERT_EQ(again.points.size(), seen.points.size());
  for (std::size_t i = 0; i < seen.points.size(); ++i) {
    ASSERT_EQ(again.points[i].range_mm, seen.points[i].range_mm) << i;
    ASSERT_EQ(again.points[i].angle_deg, seen.points[i].angle_deg) << i;
  }
  EXPECT_EQ(again.who, seen.who);
}

/// The unit of the answer to ask() is that of the firmware, too.
TEST_P(LiveFirmware, ZeroAngle_HasTheUnitOfTheFirmware) {
  sim::device device(sim::built_in_world(), options_);
  sim::virtual_clock clock;
  auto opened = lidar::open(std::make_unique<sim::virtual_connector>(device, clock),
                            {.model = model_named(GetParam().word)});
  ASSERT_TRUE(opened) << opened.error().message();
  const auto zero = opened->ask(requests::zero_angle());
  ASSERT_TRUE(zero) << zero.error().message();
  EXPECT_EQ(zero->deg(), GetParam().zero_cdeg / 100.0);
}

INSTANTIATE_TEST_SUITE_P(All, LiveFirmware, ::testing::ValuesIn(cases));

// ---- the sample rate of a TG ---------------------------------------------------------------------

/// What `hz` is to a driver, of a simulated TG that answers D1 with `code`.
struct rate_case {
  std::uint16_t hz;
  bool has_other_codes;
  std::uint8_t code;
};

class LiveRate : public ::testing::TestWithParam<rate_case> {};

// 3 means 20 kHz and 4 means 10 kHz; the other codes are the places of the rates 10, 18 and 20 kHz.
TEST_P(LiveRate, IsKnownByItsCode) {
  const auto& [hz, has_other_codes, code] = GetParam();
  const model& tg30 = *model_named("tg30");
  sim::device_options options;
  ASSERT_TRUE(sim::use_model(options, "tg30"));
  options.scanner.sample_rate = sample_rate{hz};
  options.answers_sample_rate = true;
  options.other_rate_codes = has_other_codes;
  sim::device device(sim::built_in_world(), options);
  sim::virtual_clock clock;
  const temporary_path path;
  auto writer = recording_writer::create(path.text(), {.model = &tg30});
  ASSERT_TRUE(writer);
  auto from = recorded(std::make_unique<sim::virtual_connector>(device, clock), *writer);
  ASSERT_TRUE(from);
  auto opened = lidar::open(std::move(*from), {.model = &tg30});
  ASSERT_TRUE(opened) << opened.error().message();
  const auto rate = opened->ask(requests::get_sample_rate());
  ASSERT_TRUE(rate) << rate.error().message();
  EXPECT_EQ(to_hz(*rate), hz);
  ASSERT_TRUE(opened->start());
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(opened->wait_scan(2000ms));
  const auto scan = opened->wait_scan(2000ms);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->sample_rate_hz, hz);
  EXPECT_NEAR(static_cast<double>(scan->points.size()), hz / 7.0, hz / 7.0 * 0.02);
  ASSERT_TRUE(opened->close());
  ASSERT_TRUE(writer->close());

  // The code is on the wire.
  auto played = recording_reader::open(path.text());
  ASSERT_TRUE(played);
  const std::string answer{'\xA5', '\x5A', 1, 0, 0, 0, 4, static_cast<char>(code)};
  std::string all;
  while (true) {
    const auto item = played->next();
    ASSERT_TRUE(item);
    if (!*item || all.size() > 1'000) break;
    if ((*item)->what == recorded_item::kind::from_device) {
      all.append((*item)->data.begin(), (*item)->data.end());
    }
  }
  EXPECT_NE(all.find(answer), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(All, LiveRate,
                         ::testing::Values(rate_case{20'000, true, 3}, rate_case{10'000, true, 4},
                                           rate_case{18'000, true, 1}, rate_case{20'000, false, 2},
                                           rate_case{10'000, false, 0}));

}  // namespace
}  // namespace g4lidar
