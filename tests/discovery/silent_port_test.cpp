// SPDX-License-Identifier: MIT
// What is written to a port behind which nothing answers or sends, if no model was named, and the error.
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "search_bench.hpp"
#include "support/patience.hpp"
#include "transport/pty.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using sim::fault_kind;
using clock = std::chrono::steady_clock;

constexpr std::int64_t second = 1'000'000'000;

/// In the order of docs/design/ports.md.
const std::vector<std::string> one_round{"90@230400", "90@128000", "90@115200", "90@153600",
                                         "90@512000"};

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

// A round takes 0.8 s, later ones 2 s; then the rates of variants follow, of which two have time.
TEST(SilentPort, Search_AsksOnceAtEachRateOfARound) {
  const searched done = search_at({}, {}, {sim::make_fault(fault_kind::deaf)});
  ASSERT_FALSE(done.lidar);
  std::vector<std::string> expected = one_round;
  expected.insert(expected.end(), one_round.begin(), one_round.end());
  expected.emplace_back("90@150000");
  expected.emplace_back("90@214285");
  EXPECT_EQ(done.notes, expected);
  EXPECT_EQ(done.lidar.error().code(), problem::silence);
  EXPECT_EQ(done.lidar.error().detail(), error_detail::searched);
  EXPECT_TRUE(done.lidar.error().subject().ends_with(" at 7 rates from 115200 to 512000 baud"))
      << done.lidar.error().subject();
}

TEST(SilentPort, SearchAtANamedRate_NamesIt) {
  const searched done = search_at({}, {.baud = 128'000}, {sim::make_fault(fault_kind::deaf)});
  ASSERT_FALSE(done.lidar);
  EXPECT_TRUE(done.lidar.error().subject().ends_with(" at 128000 baud"));
  for (const std::string& each : done.notes) EXPECT_EQ(each, "90@128000");
  const searched named = search_at({}, {.model = &g4_model}, {sim::make_fault(fault_kind::deaf)});
  ASSERT_FALSE(named.lidar);
  EXPECT_EQ(named.lidar.error().detail(), error_detail::usual);
}

/// Everything that the library writes to a port at which nothing answers.
struct failed_opening {
  std::optional<error> why;
  clock::duration took{};
  std::string written;
};

failed_opening open_silent(const lidar_options& options, const pty& nothing) {
  const auto begin = clock::now();
  const auto opened = lidar::open(options);
  failed_opening done;
  done.took = clock::now() - begin;
  if (!opened) done.why = opened.error();
  pollfd polled{nothing.master(), POLLIN, 0};
  while (::poll(&polled, 1, 0) > 0) done.written += nothing.receive(1);
  return done;
}

TEST(SilentPort, OpenedWithoutAModel_GetsQuestionsAlone) {
  const pty nothing;
  lidar_options options;
  options.device = nothing.path();
  const failed_opening done = open_silent(options, nothing);
  ASSERT_TRUE(done.why);
  EXPECT_EQ(done.why->code(), problem::silence);
  EXPECT_EQ(done.why->doing(), task::opening);
  EXPECT_EQ(done.why->subject(), nothing.path() + " at 10 rates from 115200 to 921600 baud");
  const std::string text = done.why->message();
  EXPECT_TRUE(has(text, "(options model and baud, --model and --baud)")) << text;
  EXPECT_FALSE(has(text, "G4") || has(text, "omit")) << text;
  // Two rounds at the usual rates, one at those of variants, and four questions of the next; fewer on a busy machine.
  constexpr std::size_t most = 20;
  EXPECT_EQ(done.written.size() % 2, 0U);
  EXPECT_LE(done.written.size(), 2 * most);
  EXPECT_GE(done.written.size(), 2U);
  for (std::size_t i = 0; i + 1 < done.written.size(); i += 2) {
    EXPECT_EQ(done.written.substr(i, 2), "\xA5\x90") << i;
  }
  EXPECT_GE(done.took, 5s);
  EXPECT_LT(done.took, 5s + patience);
}

TEST(SilentPort, OpenedAtANamedRate_ErrorNamesTheRate) {
  const pty nothing;
  lidar_options options;
  options.device = nothing.path();
  options.baud = 115'200;
  const failed_opening done = open_silent(options, nothing);
  ASSERT_TRUE(done.why);
  EXPECT_EQ(done.why->subject(), nothing.path() + " at 115200 baud");
}

TEST(SilentPort, LidarThatBootsSlowly_IsOpened) {
  sim::device_options slow;
  slow.boots_at_start = true;
  slow.boot_ns = 2 * second;
  auto served = sim::background_pty::open(sim::device(sim::built_in_world(), slow));
  ASSERT_TRUE(served);
  const auto opened = lidar::open(served->path());
  ASSERT_TRUE(opened) << opened.error().message();
  EXPECT_EQ(opened->information().model, 5);
}

// One attempt to stop it takes 2 s.
TEST(SilentPort, LidarThatStopsLate_IsOpened) {
  const std::vector faults{sim::make_fault(fault_kind::scanning),
                           sim::make_fault(fault_kind::deaf, 0, 2600 * second / 1000)};
  auto served = sim::background_pty::open(sim::device(sim::built_in_world(), {}, faults));
  ASSERT_TRUE(served);
  const auto opened = lidar::open(served->path());
  ASSERT_TRUE(opened) << opened.error().message();
  EXPECT_EQ(opened->information().model, 5);
}

}  // namespace
}  // namespace g4lidar::test
