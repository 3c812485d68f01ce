// SPDX-License-Identifier: MIT
// The words and numbers of the running diagnosis: of a network, of a file, and of gaps.
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <string_view>

#include "diagnostics/agreement.hpp"
#include "diagnostics/odd_links.hpp"
#include "diagnostics/running_bench.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;

TEST(RunningWords, OfANetwork_BlameNoLine) {
  for (std::size_t i = 0; i <= static_cast<std::size_t>(sim::last_fault_kind); ++i) {
    const auto kind = static_cast<sim::fault_kind>(i);
    use how;
    how.faults = {sim::make_fault(kind, 6'000'000'000)};
    how.wrap = wrap_in<network_port>();
    how.seconds = 12;
    const seen found = watch(how);
    for (const auto& stages : found.looks) {
      examined look;
      look.stages = stages;
      for (const stage_report& each : stages) EXPECT_EQ(each.by, byte_path::network);
      expect_no_line(look);
      if (HasFailure()) FAIL() << sim::name_of(kind) << look;
    }
  }
}

TEST(RunningWords, AGap_HasItsLength) {
  for (const int length_ms : {400, 1'000, 5'000}) {
    use how;
    how.options.reconnect = true;
    const std::string fault = "stall@6s+" + std::to_string(length_ms) + "ms";
    how.faults = faults_of({fault});
    const seen found = watch(how);
    double longest_ms = 0.0;
    int looks = 0;
    for (const auto& stages : found.looks) {
      for (const stage_report& each : stages) {
        if (!has(each, diagnosis::stalls)) continue;
        ++looks;
        const double here_ms =
            std::max(number_in(each, "longest_silence_ms"), number_in(each, "silence_ms"));
        EXPECT_GT(here_ms, 149.0) << found;
        longest_ms = std::max(longest_ms, here_ms);
      }
    }
    EXPECT_GT(looks, 0) << length_ms << found;
    EXPECT_LE(longest_ms, length_ms + 200.0) << found;
    constexpr double until_restart_ms = 1'000.0;  // then the driver starts the scan again
    EXPECT_GE(longest_ms, std::min<double>(length_ms, until_restart_ms) - 200.0) << found;
  }
}

}  // namespace
