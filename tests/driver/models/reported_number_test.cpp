// SPDX-License-Identifier: MIT
// The numbers that lidars report of their model, and errors of those that report none.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model_bench.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using test::bench;
using test::options_of;

/// What a one-way lidar reports, and as what it is taken.
struct reported_id {
  const char* word;  ///< Of the model that is named.
  std::uint8_t sent;
  std::uint8_t known;        ///< By information(); 0: it is refused.
  bool is_reported = false;  ///< By the event other_number.
  const char* other = "";    ///< In the error, as what.
};

int times_reported(lidar& of) {
  int count = 0;
  while (const auto event = of.next_event())
    count += event->what == lidar_event::kind::other_number ? 1 : 0;
  return count;
}

// CT has four bits: 22 of an SCL is 6 there, and 100 of a TX is 4. X2, X3, S2, S4 and X4 Pro report 4, by the
// table of the manufacturer most of them 6. Only an S2 reports 12; an F4 and a G4C have the baud rate of an X2.
TEST(ReportedNumber, NumberOfAOneWayLidar_IsRefusedOnlyIfItIsSurelyAnotherModel) {
  for (const auto& [word, sent, known, is_reported, other] : std::to_array<reported_id>({
           {"x2", 4, 4},
           {"x2", 6, 6},
           {"x3", 4, 4},
           {"x3-pro", 6, 6},
           {"s2", 4, 4},
           {"s2", 12, 12},
           {"s2", 6, 6, true},
           {"s2-intensity", 6, 6, true},
           {"x4-pro", 4, 4},
           {"x4-pro", 6, 6},
           {"scl", 22, 22},
           {"scl", 4, 4, true},
           {"tx8", 100, 100},
           {"tx8", 6, 6, true},
           {"x2", 10, 10, true},
           {"x4-pro", 1, 1, true},
           {"x2", 12, 0, false, "model 12 (S2), not X2"},
           {"x4-pro", 12, 0, false, "model 12 (S2), not X4 Pro"},
           {"x2", 1, 0, false, "model 1 (F4), not X2"},
           {"x3", 2, 0, false, "model 2 (G4C), not X3"},
       })) {
    sim::device_options options = options_of(*model_named(word));
    options.info.model = sent;
    options.ct_information = options.ct_crc = options.stray_before_zero = true;
    options.scanner.samples_per_packet = 20;  // room for the information in a revolution
    bench on(*model_named(word), options);
    auto lidar = on.open();
    ASSERT_TRUE(lidar) << word << lidar.error().message();
    ASSERT_TRUE(lidar->start());
    auto scan = lidar->wait_scan(2000ms);
    for (int i = 0; i < 5 && scan; ++i) scan = lidar->wait_scan(2000ms);
    EXPECT_EQ(lidar->information().model, known) << word << " " << int{sent};
    EXPECT_EQ(scan.has_value(), known != 0) << word << " " << int{sent};
    EXPECT_EQ(times_reported(*lidar), is_reported ? 1 : 0) << word << " " << int{sent};
    if (scan) continue;
    EXPECT_EQ(scan.error().code(), problem::other_device);
    EXPECT_NE(scan.error().message().find(other), std::string::npos) << scan.error().message();
  }
}

/// The lower four bits of the numbers of a one-way model, by the table of the manufacturer; the models of which they
/// are.
struct ct_numbers {
  std::vector<std::uint8_t> own;
  std::vector<const char*> words;
};

TEST(ReportedNumber, EachNumberThatAOneWayLidarCannotHave_IsReportedOrRefused) {
  std::size_t tried = 0;
  for (const auto& [own, words] :
       {ct_numbers{{4, 6}, {"x2", "x2l", "x3", "x3-pro", "x4-pro"}},
        ct_numbers{{4, 12}, {"s2", "s2-pro", "s2-intensity", "s2-pro-intensity"}},
        ct_numbers{{6}, {"scl"}}, ct_numbers{{4}, {"tx8", "tx20"}}}) {
    for (const char* const word : words) {
      ++tried;
      for (std::uint8_t sent = 1; sent <= 15; ++sent) {
        sim::device_options options = options_of(*model_named(word));
        options.info.model = sent;
        options.ct_information = options.ct_crc = options.stray_before_zero = true;
        options.scanner.samples_per_packet = 20;
        bench on(*model_named(word), options);
        auto lidar = on.open();
        ASSERT_TRUE(lidar) << word << lidar.error().message();
        ASSERT_TRUE(lidar->start());
        auto scan = lidar->wait_scan(2000ms);
        for (int i = 0; i < 5 && scan; ++i) scan = lidar->wait_scan(2000ms);
        const bool is_own = std::find(own.begin(), own.end(), sent) != own.end();
        const bool is_refused = !scan && scan.error() == problem::other_device;
        EXPECT_TRUE(scan || is_refused) << word << " " << int{sent};
        EXPECT_EQ(times_reported(*lidar) + (is_refused ? 1 : 0), is_own ? 0 : 1)
            << word << " " << int{sent};
      }
    }
  }
  EXPECT_EQ(tried, static_cast<std::size_t>(std::count_if(
                       models.begin(), models.end(),
                       [](const model& of) { return of.link == link_kind::one_way; })));
}

// At 40 samples a packet: 3 kHz at 8 Hz are 11 packets a revolution, up to the month of the date; at 4 Hz, which not
// every model can, 20.
TEST(ReportedNumber, NumberOfAOneWayLidarWithFewPackets_IsKnown) {
  for (const model& which : models) {
    if (which.link != link_kind::one_way || which.ct_information == presence::no) continue;
    for (const std::uint16_t chz : std::to_array<std::uint16_t>({400, 500, 600, 700, 800})) {
      sim::device_options options = options_of(which);
      if (chz < options.scanner.format.min_frequency_chz) continue;
      options.ct_information = options.ct_crc = options.stray_before_zero = true;
      options.condition = {health_status::error, 1};
      options.scanner.scan_frequency_chz = chz;
      bench on(which, options);
      auto lidar = on.open();
      ASSERT_TRUE(lidar) << which.word << lidar.error().message();
      ASSERT_TRUE(lidar->start());
      for (int i = 0; i < 8; ++i) ASSERT_TRUE(lidar->wait_scan(2000ms)) << which.word << " " << chz;
      EXPECT_EQ(lidar->information().model, options.info.model) << which.word << " " << chz;
      EXPECT_EQ(lidar->information().firmware_major, options.info.firmware_major) << which.word;
      EXPECT_EQ(lidar->information().firmware_minor, options.info.firmware_minor) << which.word;
      const auto condition = lidar->ask(requests::health());
      ASSERT_TRUE(condition) << which.word << " " << chz;
      EXPECT_EQ(condition->status, health_status::error) << which.word << " " << chz;
      EXPECT_EQ(times_reported(*lidar), 0) << which.word << " " << chz;
    }
  }
}

/// The information that it sends after power-on has the whole number.
TEST(ReportedNumber, NumberOfAOneWayLidarAfterPowerOn_IsAWholeOne) {
  for (const auto& [sent, other] :
       {std::pair{4, ""}, {100, "model 100 (TX8), not X2"}, {22, "model 22 (SCL), not X2"}}) {
    sim::device_options options = options_of(*model_named("x2"));
    options.info.model = static_cast<std::uint8_t>(sent);
    options.boots_at_start = true;
    bench on(*model_named("x2"), options);
    const auto lidar = on.open();
    ASSERT_EQ(lidar.has_value(), sent == 4) << sent;
    if (lidar) continue;
    EXPECT_EQ(lidar.error().code(), problem::other_device);
    EXPECT_NE(lidar.error().message().find(other), std::string::npos) << lidar.error().message();
  }
}

// ---- the texts of errors -------------------------------------------------------------------------

TEST(ReportedNumber, OfALidarThatDoesNotIdentifyItself_NamesTheModelAndItsRates) {
  const auto text_of = [](std::string_view word, const std::vector<sim::fault_kind>& faults) {
    std::vector<sim::fault> made;
    for (const sim::fault_kind each : faults) made.push_back(sim::make_fault(each));
    bench on(*model_named(word), options_of(*model_named(word)), made);
    const auto opened = on.open();
    return opened ? std::string() : opened.error().message();
  };
  const std::string x4 = text_of("x4", {sim::fault_kind::mute});
  EXPECT_NE(x4.find(", X4 (128000 baud): no byte was received"), std::string::npos) << x4;
  EXPECT_NE(x4.find("--model"), std::string::npos) << x4;
  EXPECT_EQ(x4.find("G4"), std::string::npos) << x4;
  EXPECT_EQ(x4.find("230400"), std::string::npos) << x4;
  const std::string s2 = text_of("s2", {sim::fault_kind::stall});
  EXPECT_NE(s2.find(", S2 (115200 or 128000 baud) at 115200 baud: no byte"), std::string::npos)
      << s2;
  const std::string g6 = text_of("g6", {sim::fault_kind::scanning, sim::fault_kind::baud});
  EXPECT_NE(g6.find(", G6 (512000 baud), "), std::string::npos) << g6;
  EXPECT_NE(g6.find("): bytes were received, but no valid data"), std::string::npos) << g6;
  EXPECT_NE(g6.find("--model"), std::string::npos) << g6;
}

}  // namespace
}  // namespace g4lidar
