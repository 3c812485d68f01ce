// SPDX-License-Identifier: MIT
// Lidars that are not as the table has them: the device overrules the table, and its owner overrules both.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "model_bench.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::numbered_connector;
using test::options_of;

/// A device of one model with the number of another one.
struct mixed_up {
  mixed_up(const model& real, std::uint8_t number)
      : device(sim::built_in_world(), with(real, number)) {}

  static sim::device_options with(const model& real, std::uint8_t number) {
    sim::device_options options = options_of(real);
    options.info.model = number;
    return options;
  }
  [[nodiscard]] result<lidar> open_as(const model& which) {
    auto port = std::make_unique<sim::virtual_connector>(device, clock);
    return lidar::open(std::make_unique<numbered_connector>(std::move(port), which), {});
  }
  [[nodiscard]] result<lidar> open_named(const model& which, bool insists = false) {
    return lidar::open(std::make_unique<sim::virtual_connector>(device, clock),
                       {.model = &which, .insist_on_model = insists});
  }

  sim::virtual_clock clock;
  sim::device device;
};

int times(lidar& of, lidar_event::kind what) {
  int count = 0;
  while (const auto event = of.next_event()) count += event->what == what ? 1 : 0;
  return count;
}

/// Within a tenth.
bool has_sample_rate(const model& row, std::uint32_t hz) {
  return std::ranges::any_of(row.rates.entries, [hz](const sample_rate_entry& own) {
    return std::abs(static_cast<double>(own.hz) - hz) <= 0.1 * own.hz && own.hz != 0;
  });
}

bool is_two_way(const model& row) { return row.link == link_kind::two_way; }

/// All pairs of two-way models whose samples have different sizes, and whose motors start in the same way: at the latest after a few packets it is read as what it
/// sends, and the event and the texts state both.
TEST(Recognition, SamplesThatContradictTheNumber_Decide) {
  int pairs = 0;
  for (const model& real : models) {
    for (const model& number : models) {
      const std::size_t size = sample_size(real.samples.layout);
      const bool differs = sample_size(number.samples.layout) != size && number.motor == real.motor;
      if (!is_two_way(real) || !is_two_way(number) || !differs || number.ids[0] == 0) continue;
      SCOPED_TRACE(std::string(real.word).append(" as ").append(number.word));
      ++pairs;
      mixed_up on(real, number.ids[0]);
      auto lidar = on.open_as(number);
      ASSERT_TRUE(lidar) << lidar.error().message();
      ASSERT_TRUE(lidar->start());
      for (int i = 0; i < 3; ++i) {
        const auto got = lidar->wait_scan(5s);
        ASSERT_TRUE(got) << got.error().message();
        if (i < 2) continue;
        EXPECT_EQ(sample_size(got->model->samples.layout), size);
        EXPECT_GT(got->points.size(), 100U);
      }
      const recognition known = lidar->recognition();
      EXPECT_EQ(known.by, known_by::samples);
      EXPECT_EQ(sample_size(known.model->samples.layout), size);
      EXPECT_TRUE(has_sample_rate(*known.model, to_hz(options_of(real).scanner.sample_rate)))
          << known.model->word;
      EXPECT_EQ(known.number, number.ids[0]);
      EXPECT_EQ(times(*lidar, lidar_event::kind::other_number), 1);
      EXPECT_EQ(times(*lidar, lidar_event::kind::restarted), 0);
      if (detail::may_report(*known.model, number.ids[0])) continue;  // it has both
      const std::string text = contradictions_of(known);
      EXPECT_NE(text.find(std::to_string(number.ids[0])), std::string::npos) << text;
      EXPECT_NE(text.find(known.model->name), std::string::npos) << text;
    }
  }
  EXPECT_GT(pairs, 50);
}

/// The number alone decides neither what the baud rate contradicts nor that points lack the offset of zero.
TEST(Recognition, WhatFollowsFromAnUncertainModel_IsReportedOfTheRightOne) {
  struct mixed_case {
    const char* real;
    const char* number;
    int without_zero;  ///< How often it is reported: a G4 and a T-mini Plus are not asked for the offset.
  };
  for (const auto& [word, reported, without_zero] :
       std::to_array<mixed_case>({{"t-mini-pro", "tg15", 0},
                                  {"t-mini-plus-sh", "tg30", 0},
                                  {"t-mini-pro", "g4", 0},
                                  {"g2", "g4", 1},
                                  {"tg15", "t-mini-plus", 1}})) {
    SCOPED_TRACE(std::string(word).append(" as ").append(reported));
    mixed_up on(*model_named(word), model_named(reported)->ids[0]);
    auto lidar = on.open_as(*model_named(reported));
    ASSERT_TRUE(lidar) << lidar.error().message();
    EXPECT_EQ(contradictions_of(lidar->recognition()), "");
    ASSERT_TRUE(lidar->start());
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(lidar->wait_scan(5s));
    EXPECT_EQ(contradictions_of(lidar->recognition()).find(" baud"), std::string::npos)
        << contradictions_of(lidar->recognition());
    EXPECT_EQ(times(*lidar, lidar_event::kind::no_zero_angle), without_zero);
    ASSERT_TRUE(lidar->stop());
  }
}

/// One with the number of its model, and another baud rate: packets show that it is right.
TEST(Recognition, AnotherBaudRateThanThatOfItsModel_IsReportedWhenPacketsHaveCome) {
  const model& real = *model_named("tg15");
  sim::device_options options = options_of(real);
  options.baud = 230'400;
  sim::virtual_clock clock;
  sim::device device(sim::built_in_world(), options);
  auto port = std::make_unique<sim::virtual_connector>(device, clock);
  auto lidar = lidar::open(std::make_unique<numbered_connector>(std::move(port), real), {});
  ASSERT_TRUE(lidar) << lidar.error().message();
  EXPECT_EQ(contradictions_of(lidar->recognition()), "");
  ASSERT_TRUE(lidar->start());
  ASSERT_TRUE(lidar->wait_scan(5s));
  EXPECT_EQ(contradictions_of(lidar->recognition()),
            "The line runs at 230400 baud, a TG15 usually at 512000.");
}

/// It is not asked for its offset of zero.
TEST(Recognition, ALidarThatIsListenedTo_LacksItsOffsetOfZero) {
  for (const auto& [word, count] : {std::pair{"g2", 1}, {"tg15", 1}, {"g4", 0}, {"t-mini", 0}}) {
    SCOPED_TRACE(word);
    const model& real = *model_named(word);
    sim::virtual_clock clock;
    sim::device device(sim::built_in_world(), options_of(real),
                       std::vector{sim::make_fault(sim::fault_kind::scanning)});
    auto lidar = lidar::open(std::make_unique<sim::virtual_connector>(device, clock),
                             {.model = &real, .listen_only = true});
    ASSERT_TRUE(lidar) << lidar.error().message();
    ASSERT_TRUE(lidar->start());
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(lidar->wait_scan(5s));
    EXPECT_EQ(times(*lidar, lidar_event::kind::no_zero_angle), count);
  }
}

/// Where the sizes are equal, the number decides, and nothing contradicts.
TEST(Recognition, AHealthyLidar_HasNoContradiction) {
  for (const model& real : models) {
    if (!is_two_way(real)) continue;
    SCOPED_TRACE(real.word);
    mixed_up on(real, real.ids[0]);
    auto lidar = on.open_as(real);
    ASSERT_TRUE(lidar) << lidar.error().message();
    ASSERT_TRUE(lidar->start());
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(lidar->wait_scan(5s));
    EXPECT_EQ(contradictions_of(lidar->recognition()), "");
    EXPECT_EQ(lidar->recognition().by, known_by::number);
    EXPECT_EQ(lidar->recognition().number, real.ids[0]);
    EXPECT_EQ(times(*lidar, lidar_event::kind::other_number), 0);
  }
}

/// The word of the user is right where the packets can be read so, whatever the number.
TEST(Recognition, ANamedModelWithAnotherNumber_IsReadAsItWasNamed) {
  for (const auto& [word, number, text] :
       {std::tuple("t-mini-plus-sh", 151, "reports the number 151, that of a T-mini Plus."),
        {"t-mini-plus", 153, "reports the number 153, which no known model has."},
        {"g4", 99, "reports the number 99, which no known model has."},
        {"tg15", 151, "reports the number 151, that of a T-mini Plus."}}) {
    SCOPED_TRACE(word);
    const model& real = *model_named(word);
    mixed_up on(real, static_cast<std::uint8_t>(number));
    auto lidar = on.open_named(real);
    ASSERT_TRUE(lidar) << lidar.error().message();
    ASSERT_TRUE(lidar->start());
    const auto got = lidar->wait_scan(5s);
    ASSERT_TRUE(got) << got.error().message();
    EXPECT_EQ(got->model, &real);
    EXPECT_EQ(lidar->recognition().by, known_by::user);
    EXPECT_EQ(times(*lidar, lidar_event::kind::other_number), 1);
    EXPECT_NE(contradictions_of(lidar->recognition()).find(text), std::string::npos)
        << contradictions_of(lidar->recognition());
  }
}

/// Two lidars have swapped their ports: nothing but the word of the user contradicts. He may insist.
TEST(Recognition, ANamedModelWithTheNumberOfAnotherOneAlike_IsRefused_UnlessTheUserInsists) {
  const model& real = *model_named("g4");
  const model& word = *model_named("g5");
  mixed_up on(real, real.ids[0]);
  const auto refused = on.open_named(word);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), problem::other_device);
  EXPECT_NE(refused.error().message().find("insist_on_model"), std::string::npos);
  mixed_up again(real, real.ids[0]);
  auto insisted = again.open_named(word, true);
  ASSERT_TRUE(insisted) << insisted.error().message();
  EXPECT_EQ(insisted->recognition().model, &word);
  EXPECT_EQ(times(*insisted, lidar_event::kind::other_number), 1);
}

/// Packets that cannot be read as the user has it are refused, and the text states what they are.
TEST(Recognition, ANamedModelWithSamplesOfAnotherSize_IsRefusedWhenTheyCome) {
  const model& real = *model_named("t-mini-plus-sh");
  const model& word = *model_named("t-mini-plus");
  mixed_up on(real, word.ids[0]);
  auto lidar = on.open_named(word);
  ASSERT_TRUE(lidar) << lidar.error().message();
  auto done = lidar->start();
  if (done) {
    const auto got = lidar->wait_scan(5s);
    done = got ? result<void>() : tl::unexpected(got.error());
  }
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error(), problem::other_device) << done.error().message();
  EXPECT_EQ(done.error().detail(), error_detail::other_samples);
  EXPECT_NE(done.error().message().find("samples of 4 bytes, and a T-mini Plus has 3"),
            std::string::npos)
      << done.error().message();
}

/// Not a byte is written, and the packets are read; what needs an answer is refused.
TEST(Recognition, ALidarThatIsListenedTo_GetsNoByte) {
  for (const char* const word : {"g4", "t-mini-pro", "x4"}) {
    SCOPED_TRACE(word);
    const model& real = *model_named(word);
    sim::virtual_clock clock;
    sim::device device(sim::built_in_world(), options_of(real),
                       std::vector{sim::make_fault(sim::fault_kind::scanning)});
    auto lidar = lidar::open(std::make_unique<sim::virtual_connector>(device, clock),
                             {.model = &real, .listen_only = true});
    ASSERT_TRUE(lidar) << lidar.error().message();
    ASSERT_TRUE(lidar->start());
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(lidar->wait_scan(5s));
    const auto set = lidar->set(scan_frequency::hz(8));
    EXPECT_EQ(set.error(), problem::not_supported);
    // Not for the model, which has the command.
    EXPECT_EQ(set.error().detail() == error_detail::only_listens, is_two_way(real));
    EXPECT_EQ(set.error().message().find("no such command") == std::string::npos, is_two_way(real));
    EXPECT_TRUE(lidar->stop());
    EXPECT_TRUE(lidar->close());
    EXPECT_TRUE(device.log().empty());
  }
  const auto refused =
      lidar::open("sim:?model=g4", {.listen_only = true, .frequency = scan_frequency::hz(8)});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), problem::not_supported);
  EXPECT_EQ(refused.error().detail(), error_detail::only_listens);
}

}  // namespace
}  // namespace g4lidar
