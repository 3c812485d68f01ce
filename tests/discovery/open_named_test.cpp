// SPDX-License-Identifier: MIT
// lidar::open() with a model: at all rates that it has, and with all numbers that it reports.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "discovery/fitting_models.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "search_bench.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

sim::device_options options_of(std::string_view word, std::uint32_t baud = 0) {
  sim::device_options options;
  EXPECT_TRUE(sim::use_model(options, word));
  if (baud != 0) options.baud = baud;
  return options;
}

std::string test_name(const testing::TestParamInfo<std::string_view>& of) {
  std::string name(of.param);
  std::erase(name, '-');
  return name;
}

/// A device without a number of its own answers 0.
TEST(OpenNamed, TheNumber0_IsNotThatOfAnotherModel) {
  for (const model& row : models) EXPECT_FALSE(is_surely_another(row, 0, 0)) << row.word;
  sim::device_options options = options_of("f4-pro");
  options.info.model = 0;
  auto served = sim::background_pty::open(sim::device(sim::built_in_world(), options));
  ASSERT_TRUE(served);
  const auto opened = lidar::open(served->path() + "?model=f4-pro");
  EXPECT_TRUE(opened) << opened.error().message();
}

/// The models of which devices with two rates are known: 115200 and 128000.
class OpenAtTheOtherRate : public testing::TestWithParam<std::string_view> {};

TEST_P(OpenAtTheOtherRate, IsFound) {
  for (const std::uint32_t baud : {115'200U, 128'000U}) {
    auto served =
        sim::background_pty::open(sim::device(sim::built_in_world(), options_of(GetParam(), baud)));
    ASSERT_TRUE(served);
    const std::string with_model = served->path() + "?model=" + std::string(GetParam());
    auto opened = lidar::open(with_model);
    ASSERT_TRUE(opened) << baud << ": " << opened.error().message();
    EXPECT_EQ(opened->recognition().candidates.size(), 1U);
    ASSERT_TRUE(opened->start());
    const auto got = opened->try_scan(patience);
    ASSERT_TRUE(got) << baud << ": " << got.error().message();
    EXPECT_EQ(got->model->word, GetParam());
  }
}

TEST_P(OpenAtTheOtherRate, OfASimulatedSource_IsFound) {
  auto opened = lidar::open("sim:?model=" + std::string(GetParam()) + "&baud=128000");
  ASSERT_TRUE(opened) << opened.error().message();
  ASSERT_TRUE(opened->start());
  EXPECT_TRUE(opened->try_scan(patience));
}

/// As one at a port, of a model that has one rate.
TEST(OpenNamed, ASimulatedSourceAtNoRateOfItsModel_IsFound) {
  for (const char* const source : {"sim:?model=x4&baud=153600", "sim:?baud=512000"}) {
    auto opened = lidar::open(source);
    ASSERT_TRUE(opened) << source << opened.error().message();
    ASSERT_TRUE(opened->start());
    EXPECT_TRUE(opened->try_scan(patience)) << source;
  }
}

TEST_P(OpenAtTheOtherRate, Silence_NamesTheModelAndTheRates) {
  sim::device_options options = options_of(GetParam());
  options.dtr_starts_by = sim::dtr_start::pulse;
  const searched done = search_at(options, {.model = model_named(GetParam())}, {}, true);
  ASSERT_FALSE(done.lidar);
  EXPECT_EQ(done.lidar.error().code(), problem::silence);
  const std::string wanted =
      ", " + std::string(model_named(GetParam())->name) + " at 115200, 128000 baud";
  EXPECT_TRUE(done.lidar.error().subject().ends_with(wanted)) << done.lidar.error().subject();
  EXPECT_EQ(done.notes, std::vector<std::string>{}) << "it answers nothing";
}

// The rate that the user names is the only one.
TEST_P(OpenAtTheOtherRate, ANamedRate_IsTheOnlyOne) {
  auto served = sim::background_pty::open(
      sim::device(sim::built_in_world(), options_of(GetParam(), 128'000)));
  ASSERT_TRUE(served);
  lidar_options how;
  how.device = served->path();
  how.model = model_named(GetParam());
  how.baud = 115'200;
  const auto refused = lidar::open(how);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), problem::garbage) << refused.error().message();
  EXPECT_NE(refused.error().subject().find(" at 115200 baud"), std::string_view::npos)
      << refused.error().message();
}

INSTANTIATE_TEST_SUITE_P(Models, OpenAtTheOtherRate,
                         testing::Values("s2", "s2-pro", "s2-intensity", "s2-pro-intensity"),
                         test_name);

/// A named model with one rate, which is opened without a search; its device waits for a command at another rate.
TEST(OpenAtAnotherRate, ANamedOneIsFound_AndAnotherOneIsRefused) {
  auto served =
      sim::background_pty::open(sim::device(sim::built_in_world(), options_of("g4", 512'000)));
  ASSERT_TRUE(served);
  auto opened = lidar::open(served->path() + "?model=g4");
  ASSERT_TRUE(opened) << opened.error().message();
  EXPECT_EQ(opened->recognition().baud, 512'000U);
  EXPECT_NE(contradictions_of(opened->recognition()).find("512000 baud, a G4 usually at 230400"),
            std::string::npos);
  ASSERT_TRUE(opened->close());
  const auto swapped =
      sim::background_pty::open(sim::device(sim::built_in_world(), options_of("tg15")));
  ASSERT_TRUE(swapped);
  lidar_options how;
  how.device = swapped->path();
  how.model = &g4_model;
  const auto refused = lidar::open(how);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), problem::other_device) << refused.error().message();
  EXPECT_NE(refused.error().message().find("--model WORD!"), std::string::npos);
  how.insist_on_model = true;
  const auto insisted = lidar::open(how);
  EXPECT_TRUE(insisted) << insisted.error().message();
}

// The number of the F4 Pro's manual is also that of an S4 and an S4B, which have other rates.
TEST(SharedNumber, TheRateDecides) {
  sim::device_options f4_pro = options_of("f4-pro");
  f4_pro.info.model = 4;
  const searched done = search_at(f4_pro);
  ASSERT_TRUE(done.lidar) << done.lidar.error().message();
  EXPECT_EQ(done.lidar->model->word, "f4-pro");
  EXPECT_EQ(done.lidar->candidates.size(), 1U);
  const searched s4 = search_at(options_of("s4"));
  ASSERT_TRUE(s4.lidar) << s4.lidar.error().message();
  EXPECT_EQ(s4.lidar->model->word, "s4");
  EXPECT_EQ(s4.lidar->candidates.size(), 1U);
}

TEST(SharedNumber, AnUncertainRate_DoesNotDecide) {
  lidar_signs seen{.baud = 230'400, .is_baud_certain = false, .id = 4, .answers = presence::yes};
  const auto fitting = models_that_fit(seen);
  EXPECT_EQ(model_words(fitting), "s4, s4b, f4-pro") << "those whose usual number it is come first";
  seen.is_baud_certain = true;
  EXPECT_EQ(model_words(models_that_fit(seen)), "f4-pro");
}

TEST(SharedNumber, OfANamedModel_IsAccepted) {
  for (const std::uint8_t number : {std::uint8_t{8}, std::uint8_t{4}}) {
    sim::device_options options = options_of("f4-pro");
    options.info.model = number;
    auto served = sim::background_pty::open(sim::device(sim::built_in_world(), options));
    ASSERT_TRUE(served);
    auto opened = lidar::open(served->path() + "?model=f4-pro");
    ASSERT_TRUE(opened) << opened.error().message();
    EXPECT_EQ(opened->information().model, number);
    ASSERT_TRUE(opened->start());
    const auto got = opened->try_scan(patience);
    ASSERT_TRUE(got) << got.error().message();
    EXPECT_EQ(got->model->turn_deg, 180);
  }
}

}  // namespace
}  // namespace g4lidar::test
