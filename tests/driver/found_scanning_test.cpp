// SPDX-License-Identifier: MIT
// A two-way lidar that scans when it is opened, by its model: the driver stops and reports it, although the port has
// discarded what it sent before, and although it obeys at once.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/transport/transport.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar::test {
namespace {

constexpr std::int64_t ms = 1'000'000;

/// Discards what has arrived before it is opened, as a serial port does.
class discarding_connector final : public forwarding_connector {
 public:
  explicit discarding_connector(virtual_bench& bench)
      : forwarding_connector(std::make_unique<virtual_connector>(bench)), bench_(bench) {}

  result<std::unique_ptr<transport>> connect() noexcept override {
    std::array<std::uint8_t, 4096> old{};
    while (bench_.device.read(old, bench_.now_ns) > 0) continue;
    return forwarding_connector::connect();
  }

 private:
  virtual_bench& bench_;
};

struct opened {
  std::vector<lidar_event::kind> events;
  bool is_idle = false;
  std::int64_t took_ns = 0;
};

/// A device of this model, `offset_ns` after a moment of its scan.
opened open_as(std::string_view word, const std::vector<sim::fault>& faults,
               std::int64_t offset_ns = 0) {
  sim::device_options options;
  EXPECT_TRUE(sim::use_model(options, word));
  virtual_bench bench(options, faults);
  bench.baud = options.baud;
  bench.now_ns = 6'000 * ms + offset_ns;
  const std::int64_t begin_ns = bench.now_ns;
  auto device =
      lidar::open(std::make_unique<discarding_connector>(bench), {.model = model_named(word)});
  EXPECT_TRUE(device) << word << ": " << device.error().message();
  opened made;
  if (!device) return made;
  made.took_ns = bench.now_ns - begin_ns;
  while (const auto event = device->next_event()) made.events.push_back(event->what);
  made.is_idle = !bench.device.is_scanning();
  return made;
}

/// Those whose motor does not depend on a line that this port has not.
std::vector<std::string_view> two_way_models() {
  std::vector<std::string_view> words;
  for (const model& each : models) {
    const bool turns = each.motor == motor_kind::command;
    if (each.link == link_kind::two_way && turns) words.push_back(each.word);
  }
  return words;
}

TEST(FoundScanning, OfEachModel_IsReportedOnce) {
  const std::vector scanning{sim::make_fault(sim::fault_kind::scanning)};
  for (const std::string_view word : two_way_models()) {
    for (std::int64_t offset_ns = 0; offset_ns < 20 * ms; offset_ns += 3 * ms) {
      const opened done = open_as(word, scanning, offset_ns);
      EXPECT_EQ(done.events, std::vector{lidar_event::kind::found_scanning})
          << word << ' ' << offset_ns;
      EXPECT_TRUE(done.is_idle) << word;
    }
  }
}

TEST(FoundScanning, OfAnIdleOne_IsNotReported) {
  for (const std::string_view word : two_way_models()) {
    const opened done = open_as(word, {});
    EXPECT_EQ(done.events, std::vector<lidar_event::kind>{}) << word;
    EXPECT_LE(done.took_ns, 90 * ms) << word;
  }
}

}  // namespace
}  // namespace g4lidar::test
