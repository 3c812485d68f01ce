// SPDX-License-Identifier: MIT
// How many cases a randomised test tries: the same ones each time, more of them on request.
#pragma once

#include <gtest/gtest.h>
// GoogleTest first.
#include <rapidcheck/gtest.h>

#include <cstdlib>
#include <sstream>
#include <string>

#include "support/test_scale.hpp"

namespace g4lidar::test {

/// Checks `property` on `cases` cases, times test_scale(). The cases are the same ones each time,
/// unless RC_PARAMS sets another ("seed=...").
template <class Property>
void check_cases(int cases, Property property) {
  const auto* const info = testing::UnitTest::GetInstance()->current_test_info();
  rc::detail::TestMetadata about;
  about.id = std::string(info->test_suite_name()) + "/" + info->name();
  about.description = info->name();
  rc::detail::TestParams params = rc::detail::configuration().testParams;
  if (std::getenv("RC_PARAMS") == nullptr) {
    params.seed = 4;
    params.maxSuccess = cases * test_scale();
  }
  const auto result = rc::detail::checkTestable(property, about, params);
  if (!result.template is<rc::detail::SuccessResult>()) {
    std::ostringstream message;
    rc::detail::printResultMessage(result, message);
    FAIL() << message.str();
  }
}

}  // namespace g4lidar::test
