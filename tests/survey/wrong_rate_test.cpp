// SPDX-License-Identifier: MIT
// No other maker, text or change is found in the stream of a lidar, at whatever rate it is read. The simulated line samples the bits of
// the sender at the times of the receiver.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/world.hpp"
#include "survey/other_makers.hpp"
#include "survey/stream_survey.hpp"

namespace g4lidar {
namespace {

/// What is found in two revolutions of a lidar that scans.
std::string finding_in(const model& which, const sim::world& scene, std::uint32_t baud) {
  sim::device_options options;
  EXPECT_TRUE(sim::use_model(options, which.word));
  const std::array faults{sim::make_fault(sim::fault_kind::scanning)};
  sim::device simulated(scene, options, faults);
  simulated.host().set_baud(baud, 0);
  stream_survey seen;
  std::array<std::uint8_t, 4096> some{};
  std::size_t heard = 0;
  for (std::int64_t now_ns = 0; now_ns < 400'000'000; now_ns += 1'000'000) {
    const std::size_t count = simulated.read(some, now_ns);
    seen.received(bytes(some).first(count));
    heard += count;
  }
  seen.finish();
  EXPECT_GT(heard, 300U) << which.word << " at " << baud;
  return seen.finding();
}

TEST(WrongRate, NoOtherMakerTextOrChangeIsFound) {
  const auto blind = sim::parse_world("wall -900 900 900 900\nlidar 0 0 0\n");
  for (const model& which : models) {
    for (const sim::world& scene : {sim::built_in_world(), std::get<sim::world>(blind)}) {
      for (const std::uint32_t baud : {230'400U, 115'200U, 128'000U, 512'000U, 153'600U, 150'000U,
                                       214'285U, 256'000U, 460'800U, 921'600U}) {
        EXPECT_EQ(finding_in(which, scene, baud), "") << which.word << " at " << baud;
      }
    }
  }
}

TEST(WrongRate, NoOtherMakerIsNamedInOneByteAgainAndAgain) {
  for (unsigned byte = 0; byte < 256; ++byte) {
    maker_recogniser seen;
    seen.take(std::vector<std::uint8_t>(5'000, static_cast<std::uint8_t>(byte)));
    seen.finish();
    EXPECT_EQ(seen.found(), nullptr) << byte;
  }
}

}  // namespace
}  // namespace g4lidar
