// SPDX-License-Identifier: MIT
// Motors that the line DTR drives: when the driver raises it, and when it lowers it.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "g4lidar/transport/transport.hpp"
#include "model_bench.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::bench;
using test::options_of;

TEST(LiveDtr, MotorOfAnX4_TurnsFromStartToStop) {
  bench on(*model_named("x4"));
  auto lidar = on.open();
  ASSERT_TRUE(lidar) << lidar.error().message();
  EXPECT_FALSE(on.device.motor_turns());
  ASSERT_TRUE(lidar->start());
  ASSERT_TRUE(lidar->wait_scan(2000ms));
  EXPECT_TRUE(on.device.motor_turns());
  ASSERT_TRUE(lidar->stop());
  EXPECT_FALSE(on.device.motor_turns());
}

/// Records what is done to the line DTR of its ports.
class line_connector final : public forwarding_connector {
 public:
  line_connector(std::unique_ptr<connector> inner, std::string& done)
      : forwarding_connector(std::move(inner)), done_(done) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    auto port = inner().connect();
    if (!port) return port;
    return std::make_unique<line_port>(*std::move(port), done_);
  }

 private:
  class line_port final : public forwarding_transport {
   public:
    line_port(std::unique_ptr<transport> inner, std::string& done)
        : forwarding_transport(std::move(inner)), done_(done) {}
    [[nodiscard]] result<bool> set_dtr(bool high) noexcept override {
      done_ += high ? "high " : "low ";
      return forwarding_transport::set_dtr(high);
    }
    void keep_dtr() noexcept override {
      done_ += "kept ";
      forwarding_transport::keep_dtr();
    }

   private:
    std::string& done_;
  };

  std::string& done_;
};

// A line that is kept stays high when a serial port is closed: see DtrThatWasRaised_StaysHighAfterTheClose.
TEST(LiveDtr, ReleasedWhileItScans_TheLineStaysHigh) {
  struct expectation {
    std::string_view word;
    std::string_view released;
    std::string_view closed;
  };
  constexpr expectation all[] = {{"x4", "low high kept ", "low high low "},
                                 {"s4b", "low high kept ", "low high low "},
                                 {"x2", "high kept ", "high low "},
                                 {"g4", "kept ", ""},
                                 {"x4-pro", "kept ", ""}};
  for (const auto& [word, released, closed] : all) {
    for (const bool is_released : {true, false}) {
      bench on(*model_named(word));
      std::string done;
      auto lidar =
          lidar::open(std::make_unique<line_connector>(
                          std::make_unique<sim::virtual_connector>(on.device, on.clock), done),
                      {.model = &on.which});
      ASSERT_TRUE(lidar) << lidar.error().message();
      ASSERT_TRUE(lidar->start());
      ASSERT_TRUE(lidar->wait_scan(2000ms)) << word;
      if (is_released) {
        lidar->release();
      } else {
        ASSERT_TRUE(lidar->close());
      }
      EXPECT_EQ(done, is_released ? released : closed) << word;
      if (on.which.motor != motor_kind::dtr) continue;
      EXPECT_EQ(on.device.motor_turns(), is_released) << word;
      if (!is_released) continue;
      auto next = on.open();  // the line is high already, and falls with this program
      ASSERT_TRUE(next) << next.error().message();
      EXPECT_TRUE(next->close());
      EXPECT_FALSE(on.device.motor_turns()) << word;
    }
  }
}

/// The error with which a lidar ends that starts and never turns; nothing if it does turn.
std::optional<error> fatal_error_of(lidar& device) {
  EXPECT_TRUE(device.start());
  auto why = device.wait_scan(500ms);
  for (int i = 0; i < 100 && !why && !why.error().is_fatal(); ++i) why = device.wait_scan(500ms);
  return why ? std::nullopt : std::optional(why.error());
}

sim::device_options without_power(const model& which) {
  sim::device_options options = options_of(which);
  options.motor_has_power = false;
  return options;
}

TEST(LiveDtr, LidarThatIsGivenUp_TheLineIsLowered) {
  const model& x4 = *model_named("x4");
  bench on(x4, without_power(x4));
  std::string done;
  auto lidar = lidar::open(std::make_unique<line_connector>(
                               std::make_unique<sim::virtual_connector>(on.device, on.clock), done),
                           {.model = &on.which});
  ASSERT_TRUE(lidar) << lidar.error().message();
  EXPECT_EQ(fatal_error_of(*lidar), problem::brown_out);
  EXPECT_TRUE(done.ends_with("high low ")) << done;
}

TEST(LiveDtr, MotorWithoutPower_IsAnErrorThatNamesThePlug) {
  const model& x4 = *model_named("x4");
  bench on(x4, without_power(x4));
  auto lidar = on.open();
  ASSERT_TRUE(lidar) << lidar.error().message();
  const auto why = fatal_error_of(*lidar);
  ASSERT_TRUE(why);
  EXPECT_EQ(why->code(), problem::brown_out);
  EXPECT_NE(why->message().find("second (power) plug"), std::string::npos) << why->message();
  EXPECT_NE(why->message().find("DTR"), std::string::npos);
}

TEST(LiveDtr, SilentOneWayLidar_GetsAPulse) {
  const model& x2 = *model_named("x2");
  for (const sim::dtr_start by :
       {sim::dtr_start::level, sim::dtr_start::edge, sim::dtr_start::pulse}) {
    for (const sim::dtr_cut cut : {sim::dtr_cut::motor, sim::dtr_cut::supply}) {
      sim::device_options options = options_of(x2);
      options.dtr_starts_by = by;
      options.dtr_cuts = cut;
      bench on(x2, options);
      auto lidar = on.open();
      ASSERT_TRUE(lidar) << static_cast<int>(by) << lidar.error().message();
      ASSERT_TRUE(lidar->start());
      const auto scan = lidar->wait_scan(2000ms);
      EXPECT_TRUE(scan) << static_cast<int>(by) << static_cast<int>(cut) << scan.error().message();
    }
  }
}

// Also of a silent lidar, which gets a pulse otherwise.
TEST(LiveDtr, LeftAlone_TheLineIsNotSet) {
  for (const std::string_view word : {"x2", "tx8", "g4"}) {
    for (const bool sends : {true, false}) {
      const model& which = *model_named(word);
      bench on(which, options_of(which),
               {sim::make_fault(sends ? sim::fault_kind::scanning : sim::fault_kind::stall)});
      std::string done;
      {
        auto lidar =
            lidar::open(std::make_unique<line_connector>(
                            std::make_unique<sim::virtual_connector>(on.device, on.clock), done),
                        {.model = &which, .listen_only = true, .leave_dtr = true});
        ASSERT_EQ(lidar.has_value(), sends) << word;
        if (sends) {
          ASSERT_TRUE(lidar->start());
          ASSERT_TRUE(lidar->wait_scan(5000ms)) << word;
          ASSERT_TRUE(lidar->stop());
          ASSERT_TRUE(lidar->close());
        }
      }
      EXPECT_EQ(done, "") << word;
      EXPECT_TRUE(on.device.log().empty()) << word;
    }
  }
}

}  // namespace
}  // namespace g4lidar
