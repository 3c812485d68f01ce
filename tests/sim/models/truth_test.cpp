// SPDX-License-Identifier: MIT
// Each model of the family: what a simulated one sends, decoded in two ways, against its true values.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "family_stream.hpp"
#include "g4lidar/recording/bulk_decoder.hpp"
#include "support/decode_as.hpp"

namespace g4lidar {
namespace {

using test::family_model;
using test::sent_stream;

constexpr double degrees = 180.0 / std::numbers::pi;

/// What rounding to the format can do to the angle of a return: half of 1/64 degree, and the change
/// of the correction by half a unit of the range.
double angle_slack_deg(const reference::wire_format& how, double range_mm) {
  const double offset_mm = how.correction == 'T' ? 21.8 : how.correction == 'S' ? 17.8 : 0.0;
  const double least_mm = range_mm - how.mm_per_unit / 2;
  return 1.0 / 128 + offset_mm / (least_mm * least_mm) * degrees * how.mm_per_unit / 2 + 1e-3;
}

void expect_point(const family_model& which, const sim::sample_truth& truth, const point& got) {
  const reference::wire_format& how = which.format();
  EXPECT_EQ(got.sample_flags, truth.flags);
  EXPECT_EQ(got.intensity, truth.intensity);
  const auto range_mm = static_cast<double>(got.range_mm);
  const auto angle_deg = static_cast<double>(got.angle_deg);
  if (truth.raw == 0) {
    EXPECT_TRUE(got.is_no_return());
    EXPECT_EQ(range_mm, 0.0);
    const double turned = how.correction == 'T' ? std::atan(-21.8 / 155.3) * degrees : 0.0;
    EXPECT_LT(reference::apart_deg(angle_deg, truth.first_level_deg + turned), 1.0 / 128 + 1e-3);
    return;
  }
  EXPECT_FALSE(got.is_no_return());
  EXPECT_NEAR(range_mm, truth.range_mm, how.mm_per_unit / 2 + 1e-3);
  EXPECT_LT(reference::apart_deg(angle_deg, truth.bearing_deg), angle_slack_deg(how, range_mm));
}

/// Compares the points with the samples that were sent, in order.
void expect_points(const family_model& which, const sent_stream& sent,
                   std::span<const point> points) {
  ASSERT_LE(points.size(), sent.truth.size());
  ASSERT_GE(points.size() + 80, sent.truth.size()) << "more than the packet on its way";
  std::size_t returns = 0;
  std::size_t none = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const sim::sent_sample& sample = sent.truth[i];
    EXPECT_EQ(points[i].is_revolution_start(), sample.zero);
    expect_point(which, sample.truth, points[i]);
    if (testing::Test::HasFailure()) FAIL() << which << ", sample " << i;
    if (sample.truth.raw == 0) {
      ++none;
      continue;
    }
    ++returns;
    EXPECT_GE(sample.truth.range_mm, which.nearest_mm);
    EXPECT_LE(sample.truth.range_mm, which.farthest_mm);
  }
  EXPECT_GT(returns, points.size() / 2);
  EXPECT_GT(none, points.size() / 100);
}

class SimModel : public testing::TestWithParam<family_model> {
 protected:
  static sim::device_options options() {
    sim::device_options made = test::options_of(GetParam().word);
    made.scanner.dropout_ratio = 0.05;
    return made;
  }
};

TEST_P(SimModel, PointsOfTheBulkDecoder_AreTheTruth) {
  const sent_stream sent = test::stream_of(options(), 2 * test::second);
  for (const instruction_set set : {instruction_set::portable, best_instruction_set()}) {
    bulk_decoder decoder(*model_named(GetParam().word), set);
    std::vector<point> out(sent.truth.size() + max_samples);
    bytes input(sent.bytes);
    expect_points(GetParam(), sent, decoder.decode(input, out));
    EXPECT_EQ(decoder.counts().skipped(skip_reason::bad_checksum), 0U);
  }
}

TEST_P(SimModel, PointsOfParserAndDecode_AreTheTruth) {
  const model& which = *model_named(GetParam().word);
  const sent_stream sent = test::stream_of(options(), 2 * test::second);
  std::vector<point> points;
  std::array<point, max_samples> memory;
  test::for_each_packet(sent.bytes, which.samples, [&](packet_view packet, std::size_t) {
    const auto found = test::decode_as(packet, which, memory).points;
    points.insert(points.end(), found.begin(), found.end());
  });
  expect_points(GetParam(), sent, points);
}

/// How far a place in metres is from the nearest wall.
double from_walls_m(const sim::world& room, double x, double y) {
  double nearest = 1e9;
  for (const sim::wall& w : room.walls) {
    const double dx = w.x2_m - w.x1_m;
    const double dy = w.y2_m - w.y1_m;
    const double along =
        std::clamp(((x - w.x1_m) * dx + (y - w.y1_m) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    nearest = std::min(nearest, std::hypot(x - w.x1_m - along * dx, y - w.y1_m - along * dy));
  }
  return nearest;
}

// Where the points are in the frame of the robot, counter-clockwise from where the lidar looks, does
// not depend on where the model has its angle 0.
TEST_P(SimModel, TheRobotSeesTheSameWorld) {
  const sim::world room = sim::built_in_world();
  const double looks_deg = room.lidar.heading_deg + room.mounted_at.heading_deg;
  const sent_stream sent = test::stream_of(options(), test::second);
  bulk_decoder decoder(*model_named(GetParam().word));
  std::vector<point> out(sent.truth.size() + max_samples);
  bytes input(sent.bytes);
  std::size_t returns = 0;
  for (const point& p : decoder.decode(input, out)) {
    if (p.is_no_return()) continue;
    ++returns;
    const auto range_mm = static_cast<double>(p.range_mm);
    const double direction =
        (looks_deg + GetParam().turn_deg - static_cast<double>(p.angle_deg)) / degrees;
    const double x = room.lidar.x_m + range_mm / 1000.0 * std::cos(direction);
    const double y = room.lidar.y_m + range_mm / 1000.0 * std::sin(direction);
    const double slack_mm =
        0.5 + range_mm * angle_slack_deg(GetParam().format(), range_mm) / degrees;
    ASSERT_LT(from_walls_m(room, x, y) * 1000.0, slack_mm + 0.01) << range_mm;
  }
  EXPECT_GT(returns, 500U);
}

TEST_P(SimModel, ItHasItsRateAndFrequency) {
  sim::device_options options = test::options_of(GetParam().word);
  options.motor_drift_ppm = 0;
  const double turns = GetParam().word.starts_with("t-mini") ? 10.0 : 7.0;  // as docs/sim.md states
  test::host_side host(options);
  if (GetParam().answers) host.send(command::start);
  (void)host.listen(2 * test::second);
  const test::byte_vector steady = host.listen(4 * test::second);
  std::size_t samples = 0;
  std::size_t zero_packets = 0;
  std::size_t most = 0;
  const sample_format& format = model_named(GetParam().word)->samples;
  test::for_each_packet(steady, format, [&](packet_view packet, std::size_t) {
    samples += packet.sample_count();
    most = std::max(most, packet.sample_count());
    zero_packets += packet.is_zero() ? 1U : 0U;
  });
  EXPECT_NEAR(static_cast<double>(samples), 4 * GetParam().rate_hz, 120.0);
  EXPECT_NEAR(static_cast<double>(zero_packets), 4 * turns, 1.0);
  EXPECT_EQ(most, 40U);
  EXPECT_LT(static_cast<double>(steady.size()), 4.0 * options.baud / 10);
}

INSTANTIATE_TEST_SUITE_P(OfTheFamily, SimModel, testing::ValuesIn(test::family_models),
                         [](const auto& each) {
                           std::string name = each.param.word;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(SimModels, AreAllThatTheFamilyHas) {
  std::vector<std::string> simulated(sim::model_words().begin(), sim::model_words().end());
  std::vector<std::string> wanted;
  for (const family_model& each : test::family_models) wanted.push_back(each.word);
  std::ranges::sort(simulated);
  std::ranges::sort(wanted);
  EXPECT_EQ(simulated, wanted);
  sim::device_options options;
  for (const char* const word : {"", "x5", "x"}) {
    EXPECT_FALSE(sim::use_model(options, word)) << word;
  }
  EXPECT_FALSE(sim::use_model(options, "x4", true)) << "no other layout";
}

// Some S2 and S2 Pro send 3 bytes a sample, at the rate that 115200 baud carry.
TEST(SimModels, TheOtherLayoutOfAnS2) {
  family_model other = *std::ranges::find(test::family_models, "s2-pro", &family_model::word);
  other.like = "s4b";
  sim::device_options options = test::options_of("s2-pro", true);
  options.scanner.dropout_ratio = 0.05;
  const sent_stream sent = test::stream_of(options, 2 * test::second);
  EXPECT_NEAR(static_cast<double>(sent.truth.size()), 2 * 3000, 60.0);
  model as = *model_named("s2-pro");
  as.samples.layout = as.other_layout;
  bulk_decoder decoder(as);
  std::vector<point> out(sent.truth.size() + max_samples);
  bytes input(sent.bytes);
  expect_points(other, sent, decoder.decode(input, out));
}

// A TG with firmware up to 1.2 sends half millimetres, and the frequency as it is.
TEST(SimModels, ATGWithOldFirmware) {
  family_model old = *std::ranges::find(test::family_models, "tg15", &family_model::word);
  old.like = "tg15";
  sim::device_options options;
  options.info.firmware_major = 1;
  options.info.firmware_minor = 2;
  ASSERT_TRUE(sim::use_model(options, "tg15"));
  options.truth_capacity = 100'000;
  options.scanner.dropout_ratio = 0.05;
  const sent_stream sent = test::stream_of(options, 2 * test::second);
  model as = *model_named("tg15");
  as.samples.layout = sample_layout::half_mm;
  bulk_decoder decoder(as);
  std::vector<point> out(sent.truth.size() + max_samples);
  bytes input(sent.bytes);
  expect_points(old, sent, decoder.decode(input, out));
  int reported_chz = 0;
  test::for_each_packet(sent.bytes, as.samples, [&](packet_view packet, std::size_t) {
    if (packet.is_zero()) reported_chz = packet.reported_frequency_chz();
  });
  EXPECT_NEAR(reported_chz, 700, 10);
}

}  // namespace
}  // namespace g4lidar
