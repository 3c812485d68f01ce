// SPDX-License-Identifier: MIT
// Each problem is produced, and the error has the expected contents.
#include "g4lidar/error.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <iterator>
#include <set>
#include <string>
#include <type_traits>

#include "scenario.hpp"

namespace g4lidar::test {

std::vector<scenario> all_scenarios() {
  std::vector<scenario> all = device_scenarios();
  for (auto more : {port_scenarios(), place_scenarios()}) {
    std::ranges::move(more, std::back_inserter(all));
  }
  return all;
}

namespace {

class Trouble : public testing::TestWithParam<scenario> {};

TEST_P(Trouble, HasTheExpectedContents) {
  const scenario& of = GetParam();
  const auto reported = of.bring_about();
  ASSERT_TRUE(reported) << "nothing went wrong";
  const std::string message = reported->message();
  SCOPED_TRACE(message);
  EXPECT_EQ(name_of(reported->code()), name_of(of.what));
  EXPECT_EQ(name_of(reported->doing()), name_of(of.doing));
  EXPECT_EQ(reported->is_fatal(), of.fatal);
  EXPECT_NE(reported->subject().find(of.subject), std::string_view::npos) << reported->subject();
  EXPECT_NE(message.find(reported->subject()), std::string::npos);
  EXPECT_TRUE(message.ends_with(reported->advice()));
  EXPECT_TRUE(message.starts_with(name_of(of.doing)));
  RecordProperty("message", message);
}

INSTANTIATE_TEST_SUITE_P(All, Trouble, testing::ValuesIn(all_scenarios()),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(Error, EachProblemHasAScenario) {
  std::set<problem> brought_about;
  for (const scenario& of : all_scenarios()) brought_about.insert(of.what);
  for (std::size_t i = 0; i < problem_count; ++i) {
    const auto what = static_cast<problem>(i);
    EXPECT_TRUE(brought_about.contains(what)) << name_of(what);
  }
}

}  // namespace
}  // namespace g4lidar::test
