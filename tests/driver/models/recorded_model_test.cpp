// SPDX-License-Identifier: MIT
// Models that are recorded live and replayed: the same points, by their offset of zero, and the line DTR.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "model_bench.hpp"
#include "recording/recorded_run.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::numbered_connector;
using test::temporary_path;

/// The angles and ranges of five scans.
std::vector<std::pair<float, float>> five_scans(lidar& from) {
  std::vector<std::pair<float, float>> all;
  EXPECT_TRUE(from.start());
  for (int i = 0; i < 5; ++i) {
    const auto scan = from.wait_scan(2000ms);
    EXPECT_TRUE(scan) << i;
    if (!scan) break;
    for (const point& each : scan->points) all.emplace_back(each.angle_deg, each.range_mm);
  }
  return all;
}

/// The same of a simulated lidar while it is recorded to `path`.
std::vector<std::pair<float, float>> live(const model& which, const sim::device_options& options,
                                          const std::string& path) {
  sim::device device(sim::built_in_world(), options);
  sim::virtual_clock clock;
  auto writer = recording_writer::create(path, {.model = &which});
  EXPECT_TRUE(writer);
  auto from = recorded(std::make_unique<sim::virtual_connector>(device, clock), *writer);
  EXPECT_TRUE(from);
  auto opened = lidar::open(std::move(*from), {.model = &which});
  EXPECT_TRUE(opened) << opened.error().message();
  if (!opened) return {};
  auto scans = five_scans(*opened);
  EXPECT_TRUE(opened->close());
  EXPECT_TRUE(writer->close());
  return scans;
}

std::vector<std::pair<float, float>> replayed(const std::string& path) {
  auto from = replay::open(path, {.speed = 0});
  EXPECT_TRUE(from) << from.error().message();
  auto opened = lidar::open(std::move(*from));
  EXPECT_TRUE(opened) << opened.error().message();
  return opened ? five_scans(*opened) : std::vector<std::pair<float, float>>();
}

TEST(RecordedModel, ANumberThatItDoesNotHave_IsReportedByTheReplay) {
  sim::device_options options;
  ASSERT_TRUE(sim::use_model(options, "scl"));
  options.ct_information = options.ct_crc = options.stray_before_zero = true;
  for (const auto& [sent, times] : {std::pair{std::uint8_t{22}, 0}, {std::uint8_t{4}, 1}}) {
    options.info.model = sent;
    const temporary_path path;
    static_cast<void>(live(*model_named("scl"), options, path.text()));
    auto opened = lidar::open(path.text());
    ASSERT_TRUE(opened) << opened.error().message();
    static_cast<void>(five_scans(*opened));
    int reported = 0;
    while (const auto event = opened->next_event())
      reported += event->what == lidar_event::kind::other_number ? 1 : 0;
    EXPECT_EQ(reported, times) << int{sent};
    EXPECT_EQ(opened->information().model, sent);
  }
}

TEST(RecordedModel, GivesTheSamePoints) {
  for (const std::string_view word : sim::model_words()) {
    sim::device_options options;
    ASSERT_TRUE(sim::use_model(options, word)) << word;
    const temporary_path path;
    const auto first = live(*model_named(word), options, path.text());
    EXPECT_GT(first.size(), 1000U) << word;
    EXPECT_EQ(replayed(path.text()), first) << word;
  }
}

// The recording states the model of the number, and its driver has read the samples.
TEST(RecordedModel, SamplesThatContradictTheNumber_GiveTheSamePoints) {
  for (const auto& [word, reported] : {std::pair{"t-mini-plus-sh", "t-mini-plus"},
                                       {"g2", "g4"},
                                       {"t-mini-pro", "tg15"},
                                       {"tg15", "t-mini-pro"}}) {
    SCOPED_TRACE(word);
    const model& number = *model_named(reported);
    sim::device_options options;
    ASSERT_TRUE(sim::use_model(options, word));
    options.info.model = number.ids[0];
    sim::device device(sim::built_in_world(), options);
    sim::virtual_clock clock;
    const temporary_path path;
    auto writer = recording_writer::create(path.text(), {.model = &number});
    ASSERT_TRUE(writer);
    auto from = recorded(std::make_unique<numbered_connector>(
                             std::make_unique<sim::virtual_connector>(device, clock), number),
                         *writer);
    ASSERT_TRUE(from);
    auto opened = lidar::open(std::move(*from));
    ASSERT_TRUE(opened) << opened.error().message();
    const auto first = five_scans(*opened);
    ASSERT_TRUE(opened->close());
    ASSERT_TRUE(writer->close());
    EXPECT_GT(first.size(), 1000U);
    EXPECT_EQ(replayed(path.text()), first);
  }
}

// The offset is in the answer to 93. Without it all angles of the replay would differ.
TEST(RecordedModel, OffsetOfZero_IsAddedLiveAndReplayed) {
  const model& g2 = *model_named("g2");
  sim::device_options options;
  ASSERT_TRUE(sim::use_model(options, "g2"));
  options.zero_angle_cdeg = 0;
  const temporary_path plain_path;
  const auto plain = live(g2, options, plain_path.text());
  options.zero_angle_cdeg = 1050;
  const temporary_path path;
  const auto turned = live(g2, options, path.text());
  EXPECT_EQ(replayed(path.text()), turned);
  ASSERT_EQ(plain.size(), turned.size());
  // The device measures in the same directions, and sends angles that are 10.5 degrees too small.
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const double apart_deg = std::remainder(
        static_cast<double>(turned[i].first) - static_cast<double>(plain[i].first), 360.0);
    ASSERT_LT(std::abs(apart_deg), 0.1) << i;
  }
}

TEST(RecordedModel, LineDtr_IsRecorded) {
  sim::device_options options;
  ASSERT_TRUE(sim::use_model(options, "x4"));
  const temporary_path path;
  ASSERT_FALSE(live(*model_named("x4"), options, path.text()).empty());
  auto reader = recording_reader::open(path.text());
  ASSERT_TRUE(reader);
  std::string seen;
  while (true) {
    const auto item = reader->next();
    ASSERT_TRUE(item);
    if (!*item) break;
    if ((*item)->what != recorded_item::kind::other) continue;
    if ((*item)->other.what == recorded_event::kind::dtr_low) seen += "low ";
    if ((*item)->other.what == recorded_event::kind::dtr_high) seen += "high ";
  }
  EXPECT_EQ(seen, "low high low ") << "at open, at start, at stop";
}

}  // namespace
}  // namespace g4lidar
