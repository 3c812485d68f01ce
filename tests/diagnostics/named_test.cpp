// SPDX-License-Identifier: MIT
// The doctor and lidar::open() with a named model: the word of the user is refused only where the packets cannot be read
// so, or where number, rate and packets all agree on another row of the table.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <tuple>

#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/device_options.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

struct named_lidar {
  sim::device_options options;
  sim::virtual_clock clock;

  named_lidar(std::string_view real, std::uint8_t number) {
    EXPECT_TRUE(sim::use_model(options, real));
    options.info.model = number;
  }
  [[nodiscard]] examined doctor(const model& named, bool insists = false) {
    sim::device simulated(sim::built_in_world(), options);
    diagnostic_options how{.model = &named, .insist_on_model = insists};
    how.measuring_time = std::chrono::seconds(1);
    return examine(simulated, clock, how);
  }
  /// Whether lidar::open() takes it.
  [[nodiscard]] bool opens(const model& named, bool insists = false) {
    sim::device simulated(sim::built_in_world(), options);
    auto from = std::make_unique<sim::virtual_connector>(simulated, clock);
    from->set_baud(named.bauds[0]);
    return lidar::open(std::move(from), {.model = &named, .insist_on_model = insists}).has_value();
  }
};

bool has_number(const model& row, int number) {
  return row.ids[0] == number || row.ids[1] == number;
}

/// The numbers of all models, one of another product (GS2), and some that nothing has.
std::set<int> numbers() {
  std::set<int> all{52, 99, 153};
  for (const model& row : models) all.insert({row.ids[0], row.ids[1]});
  all.erase(0);
  return all;
}

TEST(DoctorOfANamedModel, NumberOfAnotherOne_IsJudgedAsLidarOpenDoes) {
  int refused = 0;
  int warned = 0;
  for (const char* const word : {"g4", "g2", "t-mini-plus-sh", "t-mini-pro", "tg15", "s4b"}) {
    const model& real = *model_named(word);
    for (const int number : numbers()) {
      SCOPED_TRACE(std::string(word) + " with the number " + std::to_string(number));
      const auto agrees = [&](const model& row) {
        return has_number(row, number) &&
               sample_size(row.samples.layout) == sample_size(real.samples.layout) &&
               (row.bauds[0] == real.bauds[0] || row.bauds[1] == real.bauds[0]);
      };
      const bool is_own = has_number(real, number);
      const bool is_another = !is_own && std::ranges::any_of(models, agrees);
      named_lidar on(word, static_cast<std::uint8_t>(number));
      EXPECT_EQ(on.opens(real), !is_another);
      const examined done = on.doctor(real);
      EXPECT_EQ(done.diagnoses(), is_own       ? ""
                                  : is_another ? "other_device"
                                               : "other_number")
          << done;
      refused += is_another ? 1 : 0;
      warned += is_own || is_another ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 10);
  EXPECT_GT(warned, 50);
}

/// Nothing is found that follows from the model of the number alone: its samples show another one.
TEST(DoctorOfAnUnnamedModel, WhatFollowsFromItsNumberAlone_IsNotFound) {
  for (const auto& [word, number, read_as] : {std::tuple("t-mini-pro", 100, "a T-mini Pro"),
                                              {"g2", 5, "a G2"},
                                              {"t-mini-plus-sh", 101, "a T-mini Plus SH"},
                                              {"tg15", 150, "a TG15"}}) {
    sim::device_options options;
    ASSERT_TRUE(sim::use_model(options, word));
    options.info.model = static_cast<std::uint8_t>(number);
    sim::device simulated(sim::built_in_world(), options);
    sim::virtual_clock clock;
    const examined done = examine(simulated, clock, {});
    EXPECT_EQ(done.diagnoses(), "other_number") << word << done;
    EXPECT_NE(done.at(diagnostic_stage::motor).remark.find(read_as), std::string::npos) << done;
  }
}

TEST(DoctorOfANamedModel, TheUserInsists_IsAWarning) {
  const model& word = *model_named("g5");
  named_lidar on("g4", 5);
  EXPECT_FALSE(on.opens(word));
  EXPECT_EQ(on.doctor(word).diagnoses(), "other_device");
  EXPECT_TRUE(on.opens(word, true));
  EXPECT_EQ(on.doctor(word, true).diagnoses(), "other_number");
}

// The packets cannot be read so, whatever the number.
TEST(DoctorOfANamedModel, SamplesOfAnotherSize_AreRefusedWhenTheyCome) {
  const model& word = *model_named("t-mini-plus");
  for (const bool insists : {false, true}) {
    named_lidar on("t-mini-plus-sh", word.ids[0]);
    const examined done = on.doctor(word, insists);
    EXPECT_EQ(done.diagnoses(), "other_device") << done;
    EXPECT_EQ(done.at(diagnostic_stage::motor).remark,
              "The packets have 4 bytes per sample; those of a T-mini Plus have 3.");
    EXPECT_FALSE(done.motor_turns);
  }
}

}  // namespace
