// SPDX-License-Identifier: MIT
// The search for lidars at baud rates that their models do not have.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "search_bench.hpp"

namespace g4lidar::test {
namespace {

constexpr std::int64_t ms = 1'000'000;

sim::device_options device_of(std::string_view word, bool other_layout = false) {
  sim::device_options options;
  EXPECT_TRUE(sim::use_model(options, word, other_layout));
  return options;
}

/// What sends and answers nothing, at a rate that its model does not have: read as it is, and with that rate.
TEST(SearchAtAnyRate, OneWayLidarsAtAnyRate_AreFound_NamedOrNot) {
  for (const std::uint32_t baud : {150'000U, 153'600U, 214'285U, 256'000U}) {
    for (const bool is_named : {false, true}) {
      SCOPED_TRACE(std::to_string(baud) + (is_named ? ", named" : ""));
      sim::device_options options = device_of("s2-pro", true);
      options.baud = baud;
      const model& named = *model_named("s2-pro-intensity");
      const searched done = search_at(options, {.model = is_named ? &named : nullptr});
      ASSERT_TRUE(done.lidar) << done.lidar.error().message();
      EXPECT_NEAR(done.lidar->baud, baud, 0.04 * baud);  // bytes arrive
      EXPECT_EQ(sample_size(done.lidar->model->samples.layout), 3U);
      EXPECT_EQ(done.lidar->model->link, link_kind::one_way);
      EXPECT_EQ(done.lidar->by == known_by::user, is_named);
      if (!is_named) continue;
      EXPECT_EQ(done.notes, std::vector<std::string>{});
    }
  }
}

/// A two-way lidar that waits for a command, at a rate that its model does not have.
TEST(SearchAtAnyRate, IdleLidarsAtAnyRate_AreFound_NamedOrNot) {
  for (const char* const word : {"g4", "x4", "tg15", "g6", "s4b", "t-mini-plus"}) {
    for (const std::uint32_t baud : {115'200U, 128'000U, 150'000U, 153'600U, 214'285U, 230'400U,
                                     256'000U, 460'800U, 512'000U, 921'600U}) {
      for (const bool is_named : {false, true}) {
        for (const bool may_pulse : {false, true}) {
          SCOPED_TRACE(word + std::string(" at ") + std::to_string(baud) +
                       (is_named ? ", named" : "") + (may_pulse ? ", pulsed" : ""));
          sim::device_options options = device_of(word);
          options.baud = baud;
          const model& its = *model_named(word);
          const search_options how{.model = is_named ? &its : nullptr, .may_pulse_dtr = may_pulse};
          const searched done = search_at(options, how, {}, false, 4'000 * ms);
          ASSERT_TRUE(done.lidar) << done.lidar.error().message();
          EXPECT_NEAR(done.lidar->baud, baud, 0.04 * baud);  // bytes arrive
          EXPECT_EQ(done.lidar->device.model, its.ids[0]);
          EXPECT_TRUE(done.lidar->model->has_number(its.ids[0])) << done.lidar->model->word;
          for (const std::string& each : done.notes) {
            EXPECT_TRUE(each.starts_with("90@") || (may_pulse && each.starts_with("dtr"))) << each;
          }
        }
      }
    }
  }
}

/// An S2 has the number of one-way lidars, and answers.
TEST(SearchAtAnyRate, DeviceThatAnswersWithTheNumberOfAOneWayLidar_IsReadByItsRate) {
  sim::device_options options = device_of("s4b");
  options.baud = 150'000;
  options.info.model = 12;
  for (const bool is_scanning : {false, true}) {
    std::vector<sim::fault> faults;
    if (is_scanning) faults.push_back(sim::make_fault(sim::fault_kind::scanning));
    const searched done = search_at(options, {.may_pulse_dtr = is_scanning}, faults);
    ASSERT_TRUE(done.lidar) << done.lidar.error().message();
    EXPECT_EQ(done.lidar->model->word, "s4b");
    EXPECT_EQ(done.lidar->device.model, 12);
    EXPECT_EQ(done.lidar->by, is_scanning ? known_by::samples : known_by::nothing);
  }
}

/// Nothing is sent, so only its sample rate is not that of a G4: also through a bridge, whose rate is not known.
TEST(SearchAtAnyRate, OneWayLidarThatIsListenedTo_IsReadBySampleRate) {
  for (const std::uint32_t baud : {115'200U, 150'000U, 214'285U, 460'800U, 921'600U}) {
    SCOPED_TRACE(baud);
    sim::device_options options = device_of("x2");
    options.baud = baud;
    const searched done = search_at(options, {.listen_only = true});
    ASSERT_TRUE(done.lidar) << done.lidar.error().message();
    EXPECT_EQ(done.lidar->model->word, "x2");
    for (const model* const each : done.lidar->candidates) {
      EXPECT_NE(each->word, "g4");
    }
    EXPECT_EQ(done.notes, std::vector<std::string>{});
  }
}

/// Its rate cannot be set: that of the port is not that of the line.
class bridge final : public forwarding_transport {
 public:
  using forwarding_transport::forwarding_transport;
  result<bool> set_baud(std::uint32_t /*baud*/) noexcept override { return false; }
};

TEST(SearchAtAnyRate, BehindABridgeTheRateIsNotKnown) {
  for (const char* const word : {"x2", "g4", "t-mini-plus", "x4"}) {
    for (const bool only_listens : {false, true}) {
      SCOPED_TRACE(word);
      sim::device simulated(sim::built_in_world(), device_of(word),
                            std::vector{sim::make_fault(sim::fault_kind::scanning)});
      sim::virtual_clock clock;
      clock.advance_to(5'000 * ms);
      auto port = std::make_unique<sim::virtual_port>(simulated, clock);
      EXPECT_EQ(port->set_baud(device_of(word).baud), true);
      bridge to(std::move(port));
      const auto found = search(to, to.now_ns() + 3'000 * ms, {.listen_only = only_listens});
      ASSERT_TRUE(found) << found.error().message();
      EXPECT_EQ(found->baud, 0U);
      EXPECT_EQ(sample_size(found->model->samples.layout),
                sample_size(model_named(word)->samples.layout));
      EXPECT_EQ(found->model->word == "x2", std::string_view(word) == "x2");
    }
  }
}

}  // namespace
}  // namespace g4lidar::test
