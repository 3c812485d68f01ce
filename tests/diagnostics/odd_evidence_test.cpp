// SPDX-License-Identifier: MIT
// Lidars that differ from their row of the table: their evidence and their verdicts agree, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "diagnostics/agreement.hpp"
#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device_options.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::test;
using ::testing::TestWithParam;

struct odd_device {
  std::string_view name;
  std::string_view real;
  std::uint8_t number = 0;  ///< 0: its own.
  std::uint32_t baud = 0;   ///< 0: its own.
  std::string_view named = {};
};

void PrintTo(const odd_device& one, std::ostream* out) { *out << one.name; }

sim::device_options options_of(const odd_device& one) {
  sim::device_options options;
  EXPECT_TRUE(sim::use_model(options, one.real)) << one.real;
  if (one.number != 0) options.info.model = one.number;
  if (one.baud != 0) options.baud = one.baud;
  return options;
}

examined examine_odd(const odd_device& one, const std::vector<sim::fault>& faults,
                     bool is_network = false, int measured_s = 2) {
  const sim::device_options options = options_of(one);
  sim::device simulated(sim::built_in_world(), options, faults);
  sim::virtual_clock clock;
  diagnostic_options how{.model = one.named.empty() ? nullptr : model_named(one.named)};
  how.measuring_time = std::chrono::seconds(measured_s);
  std::unique_ptr<transport> port = std::make_unique<sim::virtual_port>(simulated, clock);
  static_cast<void>(port->set_baud(is_network ? options.baud : 230'400));
  if (is_network) port = std::make_unique<network_port>(std::move(port));
  examined done;
  done.stages = diagnose(std::move(port), how);
  return done;
}

class OddEvidence : public TestWithParam<odd_device> {};

TEST_P(OddEvidence, AgreesWithTheVerdict) {
  const odd_device& one = GetParam();
  const model& real = *model_named(one.real);
  using enum sim::fault_kind;
  const std::vector<std::vector<sim::fault>> all{{},
                                                 {sim::make_fault(scanning)},
                                                 {sim::make_fault(scanning), sim::make_fault(deaf)},
                                                 {sim::make_fault(stall, 5'000'000'000)},
                                                 {sim::make_fault(flip)},
                                                 {sim::make_fault(drop)},
                                                 {sim::make_fault(insert)},
                                                 {sim::make_fault(truncate)}};
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const bool is_network : {false, true}) {
      SCOPED_TRACE(std::to_string(i) + (is_network ? ", network" : ""));
      const examined done = examine_odd(one, all[i], is_network);
      expect_agreement(done, real, is_network);
      const stage_report* const baud = stage_of(done, diagnostic_stage::baud_rate);
      if (is_network && baud != nullptr) {
        EXPECT_EQ(number_in(*baud, "baud"), 0.0);  // nobody knows it
      }
      // A lidar that answers or sends is never silent; what it does not know is not missing.
      EXPECT_EQ(done.diagnoses().find("silent"), std::string::npos);
      if (i == 0 && one.number != 0) {
        EXPECT_EQ(done.diagnoses().find("answers_missing"), std::string::npos);
      }
      if (HasFailure()) FAIL() << done;
    }
  }
}

constexpr std::uint8_t unknown = 153;
const std::vector<odd_device> odd_devices{
    {"G4_at512000", "g4", 0, 512'000, ""},
    {"G4_at512000_named", "g4", 0, 512'000, "g4"},
    {"X4_at230400_named", "x4", 0, 230'400, "x4"},
    {"TMini_at150000", "t-mini", 0, 150'000, ""},
    {"TMini_ofUnknownNumber", "t-mini-plus", unknown, 0, ""},
    {"TMini_ofUnknownNumber_named", "t-mini-plus", unknown, 0, "t-mini-plus"},
    {"TMiniSh_ofUnknownNumber", "t-mini-plus-sh", unknown, 0, ""},
    {"G4_ofUnknownNumber", "g4", unknown, 0, ""},
    {"TMiniSh_ofTheNumberOfAPlus", "t-mini-plus-sh", 151, 0, ""},
    {"TMiniSh_ofTheNumberOfAPlus_named", "t-mini-plus-sh", 151, 0, "t-mini-plus-sh"},
    {"TMiniSh_ofTheNumberOfAPlus_namedPro", "t-mini-plus-sh", 151, 0, "t-mini-pro"},
    {"TMiniSh_ofTheNumberOfAPlus_namedPlus", "t-mini-plus-sh", 151, 0, "t-mini-plus"},
    {"TMini_ofTheNumberOfAG4", "t-mini", 5, 0, ""},
    {"TMini_ofTheNumberOfAG4_namedG4", "t-mini", 5, 0, "g4"},
    {"G4_ofTheNumberOfAG5_namedG5", "g4", 5, 0, "g5"},
    {"X2_at230400", "x2", 0, 230'400, ""},
    {"S2_at153600_named", "s2-intensity", 0, 153'600, "s2-intensity"},
};

INSTANTIATE_TEST_SUITE_P(Of, OddEvidence, ::testing::ValuesIn(odd_devices),
                         [](const auto& of) { return std::string(of.param.name); });

// Only the number is unknown, and that is what is reported, with the request to report it.
TEST(OddNumber, ThatNoModelHas_IsAllThatIsReported) {
  for (const char* const word : {"g4", "t-mini-plus", "t-mini-plus-sh", "tg15", "g2"}) {
    const examined done = examine_odd({word, word, unknown}, {});
    EXPECT_EQ(done.diagnoses(), "other_number") << word << done;
    std::string remarks;
    for (const stage_report& each : done.stages) remarks += each.remark + "\n";
    EXPECT_NE(remarks.find("The number 153 is that of no known model. Please report it"),
              std::string::npos)
        << done;
    EXPECT_EQ(remarks.find("umber is that of"), std::string::npos) << done;
  }
}

// The samples of other models look like text now and then: a boot is a text that stands by itself.
TEST(OddEvidenceOf, SamplesOfAnotherModel_AreNoBoots) {
  for (const std::string_view word : sim::model_words()) {
    const model& real = *model_named(word);
    if (real.link == link_kind::one_way) continue;
    for (const char* const named : {"", "g4", "t-mini-pro", "t-mini-plus-sh"}) {
      const odd_device one{word, word, 0, 0, named};
      const examined done = examine_odd(one, faults_of({"scanning", "deaf"}));
      EXPECT_EQ(sum_of(done, "boots"), 0.0) << word << " " << named << done;
      EXPECT_EQ(done.diagnoses().find("reboots"), std::string::npos) << word << done;
      for (const stage_report& each : done.stages) {
        for (const diagnosis what : each.diagnoses)
          EXPECT_EQ(each.explain(what).advice.find("was stopped"), std::string_view::npos) << word;
      }
    }
  }
}

// A gap is reported with its length.
TEST(OddEvidenceOf, AGap_HasItsLength) {
  for (const int length_ms : {300, 800, 1'500, 2'500}) {
    for (const char* const word : {"g4", "x2", "t-mini-plus"}) {
      const std::string fault = "stall@3500ms+" + std::to_string(length_ms) + "ms";
      const examined done = examine_odd({word, word, 0, 0, word}, faults_of({fault}), false, 4);
      const stage_report* const stream = stage_of(done, diagnostic_stage::stream);
      ASSERT_NE(stream, nullptr);
      EXPECT_EQ(done.diagnoses(), "stalls") << word << fault << done;
      // A stall begins and ends within the pause between two reads.
      EXPECT_NEAR(number_in(*stream, "longest_silence_ms"), length_ms, 120.0)
          << word << fault << done;
    }
  }
}

}  // namespace
