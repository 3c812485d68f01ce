// SPDX-License-Identifier: MIT
// The search at a port of which nothing is known, for each model of the table.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "first_scan.hpp"
#include "search_bench.hpp"

namespace g4lidar::test {
namespace {

using sim::fault_kind;

constexpr std::int64_t ms = 1'000'000;

/// The name that a search gives to a model whose bytes are those of others. All others get their own.
constexpr std::pair<std::string_view, std::string_view> shared_names[] = {
    {"x2l", "x2"},
    {"x3", "x2"},
    {"tx8", "x3-pro"},  // 4 kHz at this rate
    {"tx20", "x3-pro"},
    {"s2", "s2-pro"},  // 5 kHz
    {"s2-intensity", "s2-pro-intensity"},
    {"scl", "s2-pro-intensity"},
};

std::string_view name_of(const model& which) {
  const auto* const shared =
      std::ranges::find(shared_names, which.word, [](const auto& each) { return each.first; });
  return shared == std::end(shared_names) ? which.word : shared->second;
}

sim::device_options options_of(std::string_view word, bool other_layout = false) {
  sim::device_options options;
  EXPECT_TRUE(sim::use_model(options, word, other_layout));
  return options;
}

std::string list_of(const std::vector<const model*>& all) {
  std::string text;
  for (const model* each : all) text.append(text.empty() ? "" : " ").append(each->word);
  return text;
}

std::string text_of(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& each : notes) text.append(text.empty() ? "" : " ").append(each);
  return text;
}

/// How often the device got the commands of a stop: `00 65`.
std::ptrdiff_t stops_in(const std::vector<std::string>& notes) {
  return std::ranges::count_if(notes,
                               [](const std::string& each) { return each.starts_with("65@"); });
}

/// Only questions, and stops; a stop only before the question at the same rate, after packets.
void expect_harmless(const std::vector<std::string>& notes, bool may_pulse) {
  for (const std::string& each : notes) {
    const std::string command = each.substr(0, 2);
    const bool is_pulse = may_pulse && command == "dt";
    EXPECT_TRUE(command == "90" || command == "00" || command == "65" || is_pulse) << each;
  }
}

/// The packets of a named model that gets no byte must have its samples.
TEST(Search, OneWayLidarWithOtherSamples_IsRefused_AndTheTextStatesThem) {
  const searched done =
      search_at(options_of("s2-pro", true), {.model = model_named("x2"), .baud = 115'200});
  ASSERT_FALSE(done.lidar);
  EXPECT_EQ(done.lidar.error(), problem::other_device);
  EXPECT_EQ(done.lidar.error().detail(), error_detail::other_samples);
  EXPECT_NE(done.lidar.error().subject().find("samples of 3 bytes at 115200 baud, not of 2"),
            std::string_view::npos)
      << done.lidar.error().subject();
}

/// A lidar of which only the data wire is connected, or a COIN-D4.
TEST(Search, TwoWayLidarThatAnswersNothing_IsReadOnly) {
  for (const char* const word : {"t-mini-plus", "g4", "tg30"}) {
    SCOPED_TRACE(word);
    const searched done =
        search_at(options_of(word), {},
                  {sim::make_fault(fault_kind::scanning), sim::make_fault(fault_kind::deaf)});
    ASSERT_TRUE(done.lidar) << done.lidar.error().message();
    EXPECT_TRUE(done.lidar->is_silent);
    EXPECT_EQ(sample_size(done.lidar->model->samples.layout),
              sample_size(model_named(word)->samples.layout));
  }
}

/// No model need have this rate with samples of this size, and none of those that answer nothing: it is read by its size.
TEST(Search, EachModelAtEachRate_ThatAnswersNothing_IsReadBySize) {
  for (const model& each : models) {
    if (each.link == link_kind::one_way || each.motor == motor_kind::dtr) continue;
    for (const std::uint32_t baud : {115'200U, 128'000U, 153'600U, 230'400U, 460'800U, 512'000U}) {
      SCOPED_TRACE(std::string(each.word) + " at " + std::to_string(baud));
      sim::device_options options = options_of(each.word);
      options.baud = baud;
      const searched done = search_at(
          options, {}, {sim::make_fault(fault_kind::scanning), sim::make_fault(fault_kind::deaf)});
      if (!done.lidar) {  // more is measured than the line carries
        EXPECT_NE(done.lidar.error(), problem::silence);
        continue;
      }
      ASSERT_FALSE(done.lidar->candidates.empty());
      EXPECT_EQ(sample_size(done.lidar->model->samples.layout), sample_size(each.samples.layout));
    }
  }
}

/// The number and the samples of a lidar that scans contradict: all pairs of models at one rate.
TEST(Search, SamplesThatContradictTheNumber_Decide) {
  int pairs = 0;
  for (const model& real : models) {
    for (const model& number : models) {
      const std::size_t size = sample_size(real.samples.layout);
      const bool differs = sample_size(number.samples.layout) != size;
      const bool are_two_way = real.link == link_kind::two_way && number.link == link_kind::two_way;
      if (!are_two_way || !differs || real.motor == motor_kind::dtr) continue;
      SCOPED_TRACE(std::string(real.word) + " with the number of " + std::string(number.word));
      ++pairs;
      sim::device_options options = options_of(real.word);
      options.info.model = number.ids[0];
      const searched done = search_at(options, {}, {sim::make_fault(fault_kind::scanning)});
      ASSERT_TRUE(done.lidar) << done.lidar.error().message();
      EXPECT_EQ(sample_size(done.lidar->model->samples.layout), size);
      EXPECT_EQ(done.lidar->device.model, number.ids[0]);
    }
  }
  EXPECT_GT(pairs, 50);
}

TEST(Search, EveryModel_IsFoundInTime) {
  std::printf("| model | time | baud | name | candidates | written |\n|---|---|---|---|---|---|\n");
  for (const model& each : models) {
    for (const bool scanning : {false, true}) {
      if (scanning && each.link == link_kind::one_way) continue;
      SCOPED_TRACE(each.word);
      std::vector<sim::fault> faults;
      if (scanning) faults.push_back(sim::make_fault(fault_kind::scanning));
      // A scan whose motor does not turn sends nothing, and the device ignores commands.
      const bool needs_pulse = scanning && each.motor == motor_kind::dtr;
      const searched done =
          search_at(options_of(each.word), {.may_pulse_dtr = needs_pulse}, faults);
      ASSERT_TRUE(done.lidar) << done.lidar.error().message() << text_of(done.notes);
      const recognised_lidar& lidar = *done.lidar;
      std::printf("| %s%s | %d ms | %u | %s | %s | %s |\n", each.name.data(),
                  scanning ? ", scanning" : "", static_cast<int>(done.took_ns / ms), lidar.baud,
                  lidar.model->name.data(), list_of(lidar.candidates).c_str(),
                  text_of(done.notes).c_str());
      EXPECT_NE(std::ranges::find(lidar.candidates, &each), lidar.candidates.end())
          << list_of(lidar.candidates);
      EXPECT_EQ(lidar.model, lidar.candidates.front());
      EXPECT_EQ(lidar.model->word, name_of(each));
      EXPECT_EQ(sample_size(lidar.model->samples.layout), sample_size(each.samples.layout));
      EXPECT_EQ(lidar.baud, each.bauds[0]);
      const std::int64_t longest_ns = needs_pulse ? 5000 * ms : longest_search_ns;
      EXPECT_LE(done.took_ns, each.word == "g4" ? 100 * ms : longest_ns);
      EXPECT_EQ(lidar.was_scanning, scanning || each.link == link_kind::one_way);
      expect_harmless(done.notes, needs_pulse);
      EXPECT_LE(stops_in(done.notes), each.link == link_kind::one_way ? 1 : 2);
    }
  }
}

// bench/search.sh prints the times, of more openings.
TEST(Search, EveryModel_HasItsFirstScanAtMost600MsLaterThanIfItIsNamed) {
  constexpr int runs = 3;
  for (const model& each : models) {
    for (const bool is_sending : {false, true}) {
      SCOPED_TRACE(std::string(each.word) + (is_sending ? ", scanning" : ", idle"));
      const search_delay delay = delay_of_search(each, is_sending, runs);
      EXPECT_TRUE(delay.good);
      EXPECT_LE(delay.added_ns, 600 * ms);
    }
  }
}

TEST(Search, DeviceThatAnswersLate_IsFound) {
  for (const model& each : models) {
    if (each.link == link_kind::one_way) continue;
    for (const bool is_scanning : {false, true}) {
      SCOPED_TRACE(std::string(each.word) + (is_scanning ? ", scanning" : ""));
      sim::device_options options = options_of(each.word);
      options.reaction_ns = 350 * ms;
      std::vector<sim::fault> faults;
      if (is_scanning) faults.push_back(sim::make_fault(fault_kind::scanning));
      const bool needs_pulse = is_scanning && each.motor == motor_kind::dtr;
      const searched done = search_at(options, {.may_pulse_dtr = needs_pulse}, faults);
      ASSERT_TRUE(done.lidar) << done.lidar.error().message() << text_of(done.notes);
      EXPECT_EQ(done.lidar->device.model, each.ids[0]);
      EXPECT_FALSE(done.lidar->is_silent);
    }
  }
}

TEST(Search, MotorThatNeedsTwoSecondsAfterDtr_IsFound) {
  for (const model& each : models) {
    if (each.link == link_kind::two_way || each.motor != motor_kind::dtr) continue;
    for (const auto start : {sim::dtr_start::level, sim::dtr_start::pulse}) {
      SCOPED_TRACE(each.word);
      sim::device_options options = options_of(each.word);
      options.dtr_starts_by = start;
      options.standstill_ns = 1'900 * ms;
      const searched done = search_at(options, {.may_pulse_dtr = true}, {}, true);
      ASSERT_TRUE(done.lidar) << done.lidar.error().message();
      EXPECT_EQ(done.lidar->model->word, name_of(each));
    }
  }
}

// A two-way lidar with 2-byte samples has 4 kHz at 115200 baud, and at 128000 no information in its CT bytes.
TEST(Search, OneWayLidarThatShowsWhatItIs_GetsNoByte) {
  for (const std::string_view word :
       {"x2", "x2l", "x3", "x4-pro", "s2", "s2-pro", "s2-intensity", "s2-pro-intensity", "scl"}) {
    const searched done = search_at(options_of(word));
    ASSERT_TRUE(done.lidar) << word << done.lidar.error().message();
    EXPECT_EQ(done.notes, std::vector<std::string>{}) << word;
  }
}

TEST(Search, OneWayLidarLikeATwoWayOne_GetsOneStop) {
  for (const std::string_view word : {"x3-pro", "tx8", "tx20"}) {
    const searched done = search_at(options_of(word));
    ASSERT_TRUE(done.lidar) << word << done.lidar.error().message();
    EXPECT_EQ(done.notes, (std::vector<std::string>{"00@115200", "65@115200"})) << word;
    EXPECT_EQ(done.lidar->model->word, "x3-pro");
  }
}

// Without a reported frequency it cannot be distinguished from an S4.
TEST(Search, OneWayLidarWithoutAFrequency_GetsOneStop) {
  sim::device_options options = options_of("x2");
  options.scanner.reports_frequency = false;
  const searched done = search_at(options);
  ASSERT_TRUE(done.lidar) << done.lidar.error().message();
  EXPECT_EQ(done.notes, (std::vector<std::string>{"00@115200", "65@115200"}));
  EXPECT_EQ(done.lidar->model->word, "x2");
  EXPECT_LE(done.took_ns, longest_search_ns);
}

TEST(Search, NamedRate_IsNotSearchedFor) {
  const searched done = search_at(options_of("x4"), {.baud = 128'000});
  ASSERT_TRUE(done.lidar) << done.lidar.error().message();
  EXPECT_EQ(done.lidar->model->word, "x4");
  EXPECT_EQ(done.notes, std::vector<std::string>{"90@128000"});
  EXPECT_LT(done.took_ns, 100 * ms);
}

TEST(Search, NamedModel_IsNotSearchedFor) {
  const searched done = search_at(options_of("tg15"), {.model = model_named("tg15")});
  ASSERT_TRUE(done.lidar) << done.lidar.error().message();
  EXPECT_EQ(done.notes, std::vector<std::string>{"90@512000"});
  const searched scl = search_at(options_of("scl"), {.model = model_named("scl")});
  ASSERT_TRUE(scl.lidar) << scl.lidar.error().message();
  EXPECT_EQ(scl.lidar->model->word, "scl");
  EXPECT_EQ(scl.notes, std::vector<std::string>{});
}

TEST(Search, NothingThere_IsSilenceAfterTheDeadline) {
  const searched done = search_at({}, {}, {sim::make_fault(fault_kind::deaf)});
  ASSERT_FALSE(done.lidar);
  EXPECT_EQ(done.lidar.error().code(), problem::silence);
  EXPECT_LE(done.took_ns, longest_search_ns + 10 * ms);
  for (const std::string& each : done.notes) EXPECT_TRUE(each.starts_with("90@")) << each;
}

TEST(Search, Cancelled_EndsAtOnce) {
  int asked = 0;
  const searched done = search_at({}, {.is_cancelled = [&asked] { return ++asked > 3; }},
                                  {sim::make_fault(fault_kind::deaf)});
  ASSERT_FALSE(done.lidar);
  EXPECT_EQ(done.lidar.error().code(), problem::cancelled);
  EXPECT_LE(done.took_ns, 200 * ms);
}

// A port that the user has not named gets no pulse.
TEST(Search, MotorThatWaitsForDtr_TurnsOnlyBehindANamedPort) {
  sim::device_options options = options_of("x2");
  options.dtr_starts_by = sim::dtr_start::pulse;
  const searched unnamed = search_at(options, {}, {}, true);
  ASSERT_FALSE(unnamed.lidar);
  EXPECT_EQ(unnamed.lidar.error().code(), problem::silence);
  EXPECT_EQ(std::ranges::count(unnamed.notes, "dtr=0"), 0);
  const searched named = search_at(options, {.may_pulse_dtr = true}, {}, true);
  ASSERT_TRUE(named.lidar) << named.lidar.error().message();
  EXPECT_EQ(named.lidar->model->word, "x2");
  EXPECT_EQ(std::ranges::count(named.notes, "dtr=0"), 1);
}

// The error states how many rates were tried.
TEST(Search, SomethingSendsAtEveryRate_NamesTheRates) {
  sim::device_options options = options_of("g4");
  options.baud = 57'600;
  const searched done = search_at(options, {}, {sim::make_fault(fault_kind::scanning)});
  ASSERT_FALSE(done.lidar);
  EXPECT_EQ(done.lidar.error().code(), problem::garbage) << done.lidar.error().message();
  EXPECT_TRUE(done.lidar.error().subject().ends_with(" at 10 rates from 115200 to 921600 baud"))
      << done.lidar.error().subject();
}

TEST(Search, VariantAtAnUnusualRate_IsFoundWhileItSends) {
  sim::device_options options = options_of("s4");
  options.baud = 214'285;
  options.driven_by = sim::drive::power;
  const searched done = search_at(options, {}, {sim::make_fault(fault_kind::scanning)});
  ASSERT_TRUE(done.lidar) << done.lidar.error().message();
  EXPECT_EQ(done.lidar->model->word, "s4");
  EXPECT_EQ(done.lidar->baud, 214'285U);
}

}  // namespace
}  // namespace g4lidar::test
