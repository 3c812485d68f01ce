// SPDX-License-Identifier: MIT
// A simulated lidar of a model, in virtual time, for the driver.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar::test {

inline constexpr std::int64_t ms = 1'000'000;

inline sim::device_options options_of(const model& which) {
  sim::device_options options;
  EXPECT_TRUE(sim::use_model(options, which.word)) << which.word;
  return options;
}

/// A simulated device and a lidar of it.
struct bench {
  explicit bench(const model& of) : bench(of, options_of(of)) {}
  bench(const model& of, const sim::device_options& options,
        const std::vector<sim::fault>& faults = {})
      : which(of), device(sim::built_in_world(), options, faults) {}

  [[nodiscard]] result<lidar> open(lidar_options how = {}) {
    how.model = &which;
    return lidar::open(std::make_unique<sim::virtual_connector>(device, clock), how);
  }

  const model& which;
  sim::virtual_clock clock;
  sim::device device;
};

/// States that the model follows from the number of the device.
class numbered_connector final : public forwarding_connector {
 public:
  numbered_connector(std::unique_ptr<connector> from, const model& which)
      : forwarding_connector(std::move(from)), which_(&which) {}
  [[nodiscard]] connector_traits traits() const noexcept override {
    connector_traits known = forwarding_connector::traits();
    known.recognised = {.model = which_, .by = known_by::number, .candidates = {&which_, 1}};
    return known;
  }

 private:
  const model* which_;
};

}  // namespace g4lidar::test
