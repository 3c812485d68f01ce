// SPDX-License-Identifier: MIT
// lidar::open() at the path of a port, without a model: the search, and its open port in the hands of the
// driver.
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

class OpenUnknown : public testing::TestWithParam<std::string_view> {};

TEST_P(OpenUnknown, ScansAsItsModel) {
  sim::device_options options;
  ASSERT_TRUE(sim::use_model(options, GetParam()));
  auto served = sim::background_pty::open(sim::device(sim::built_in_world(), options));
  ASSERT_TRUE(served);
  auto opened = lidar::open(served->path());
  ASSERT_TRUE(opened) << opened.error().message();
  ASSERT_TRUE(opened->start());
  const auto got = opened->try_scan(patience);
  ASSERT_TRUE(got) << got.error().message();
  EXPECT_EQ(got->model->word, GetParam());
  EXPECT_GT(got->points.size(), 100U);
}

class OpenWithSettings : public testing::Test {
 protected:
  result<lidar> open(std::string_view word, const lidar_options& how) {
    sim::device_options options;
    EXPECT_TRUE(sim::use_model(options, word));
    auto served = sim::background_pty::open(sim::device(sim::built_in_world(), options));
    served_.emplace(std::move(served.value()));
    return lidar::open(served_->path(), how);
  }

  std::optional<sim::background_pty> served_;
};

// 3 Hz are below the limit of a G4.
TEST_F(OpenWithSettings, LimitsAreThoseOfTheModelThatIsFound) {
  lidar_options how;
  how.frequency = scan_frequency{300};
  auto opened = open("tg15", how);
  ASSERT_TRUE(opened) << opened.error().message();
  ASSERT_TRUE(opened->start());
  const auto got = opened->try_scan(patience);
  ASSERT_TRUE(got) << got.error().message();
  served_->with([](sim::device& simulated, std::int64_t) {
    EXPECT_EQ(simulated.settings().scan_frequency_chz, 300);
  });
}

TEST_F(OpenWithSettings, ValueThatTheFoundModelCannotHave_BadOption) {
  lidar_options how;
  how.frequency = scan_frequency{500};
  const auto opened = open("t-mini-pro", how);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code(), problem::bad_option);
  EXPECT_NE(opened.error().subject().find("6 to 12 Hz of a T-mini Pro"), std::string_view::npos)
      << opened.error().message();
}

TEST_F(OpenWithSettings, SettingThatTheFoundModelHasNot_ErrorListsTheCandidates) {
  lidar_options how;
  how.frequency = scan_frequency{700};
  const auto opened = open("x2", how);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code(), problem::not_supported);
  EXPECT_NE(opened.error().subject().find("(or x2l, x3"), std::string_view::npos)
      << opened.error().message();
}

// The limits of a lidar that is not there are unknown.
TEST_F(OpenWithSettings, NoDevice_IsTheErrorWhateverTheSettings) {
  lidar_options how;
  how.frequency = scan_frequency{300};
  const auto opened = lidar::open("/dev/g4lidar_there_is_none", how);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code(), problem::no_port) << opened.error().message();
}

TEST(OpenCandidates, AreAllThatSendTheSame) {
  sim::device_options options;
  ASSERT_TRUE(sim::use_model(options, "x2"));
  auto served = sim::background_pty::open(sim::device(sim::built_in_world(), options));
  ASSERT_TRUE(served);
  const auto words_of = [](const lidar& of) { return model_words(of.recognition().candidates); };
  {
    const auto found = lidar::open(served->path());
    ASSERT_TRUE(found) << found.error().message();
    EXPECT_TRUE(words_of(*found).starts_with("x2, x2l, x3")) << words_of(*found);
  }
  const auto named = lidar::open(served->path() + "?model=x3");
  ASSERT_TRUE(named) << named.error().message();
  EXPECT_EQ(words_of(*named), "x3");
}

/// A two-way lidar that a dead host has left scanning.
class OpenLeftScanning : public testing::TestWithParam<std::string_view> {};

TEST_P(OpenLeftScanning, IsStoppedNamedAndScansAsItsModel) {
  sim::device_options options;
  ASSERT_TRUE(sim::use_model(options, GetParam()));
  auto served = sim::background_pty::open(sim::device(
      sim::built_in_world(), options, std::vector{sim::make_fault(sim::fault_kind::scanning)}));
  ASSERT_TRUE(served);
  auto opened = lidar::open(served->path());
  ASSERT_TRUE(opened) << opened.error().message();
  ASSERT_EQ(opened->recognition().candidates.size(), 1U);
  EXPECT_EQ(opened->recognition().candidates.front()->word, GetParam());
  EXPECT_EQ(opened->information().model, options.info.model);
  const auto event = opened->next_event();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->what, lidar_event::kind::found_scanning);
  served->with([](sim::device& simulated, std::int64_t) { EXPECT_FALSE(simulated.is_scanning()); });
  ASSERT_TRUE(opened->start());
  const auto got = opened->try_scan(patience);
  ASSERT_TRUE(got) << got.error().message();
  EXPECT_EQ(got->model->word, GetParam());
}

std::vector<std::string_view> two_way_models() {
  std::vector<std::string_view> words;
  for (const model& each : models) {
    if (each.link == link_kind::two_way) words.push_back(each.word);
  }
  return words;
}

INSTANTIATE_TEST_SUITE_P(Models, OpenLeftScanning, testing::ValuesIn(two_way_models()),
                         [](const auto& of) {
                           std::string name(of.param);
                           std::erase(name, '-');
                           return name;
                         });

INSTANTIATE_TEST_SUITE_P(Models, OpenUnknown,
                         testing::Values("g4", "t-mini-pro", "x4", "x2", "tg15"),
                         [](const auto& of) {
                           std::string name(of.param);
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace g4lidar::test
