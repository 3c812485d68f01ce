// SPDX-License-Identifier: MIT
// A search at the port of a simulated lidar, in virtual time, and what it writes.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "g4lidar/discovery.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar::test {

/// Notes what is written: "90@128000", "dtr=0".
class noting_port final : public forwarding_transport {
 public:
  explicit noting_port(std::unique_ptr<transport> inner) : forwarding_transport(std::move(inner)) {}

  result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : data) {
      if (byte != 0xA5) text.append({digits[byte >> 4U], digits[byte & 15U]});
    }
    notes_->push_back(text + "@" + std::to_string(baud()));
    return forwarding_transport::write(data, deadline_ns);
  }
  result<bool> set_dtr(bool high) noexcept override {
    notes_->push_back(high ? "dtr=1" : "dtr=0");
    return forwarding_transport::set_dtr(high);
  }
  [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return *notes_; }
  /// The same, which may outlive this.
  [[nodiscard]] std::shared_ptr<const std::vector<std::string>> shared_notes() const noexcept {
    return notes_;
  }

 private:
  std::shared_ptr<std::vector<std::string>> notes_ = std::make_shared<std::vector<std::string>>();
};

/// What a search has found, how long it took, and what it wrote.
struct searched {
  result<recognised_lidar> lidar;
  std::int64_t took_ns;
  std::vector<std::string> notes;
};

inline constexpr std::int64_t longest_search_ns = 3'000'000'000;

/// In a port that is opened at the rate of a G4, after the device has had power for 5 s. If the port
/// was open before, its end has stopped a motor that DTR drives.
inline searched search_at(const sim::device_options& options, const search_options& how = {},
                          const std::vector<sim::fault>& faults = {}, bool was_open_before = false,
                          std::int64_t longest_ns = longest_search_ns) {
  constexpr std::int64_t before_ns = 5'000'000'000;
  sim::device simulated(sim::built_in_world(), options, faults);
  sim::virtual_clock clock;
  if (was_open_before) const sim::virtual_port earlier(simulated, clock);
  clock.advance_to(before_ns);
  auto inner = std::make_unique<sim::virtual_port>(simulated, clock);
  EXPECT_EQ(inner->set_baud(g4_model.bauds[0]), true);
  noting_port port(std::move(inner));
  const std::int64_t begin_ns = port.now_ns();
  auto lidar = search(port, begin_ns + longest_ns, how);
  return {std::move(lidar), port.now_ns() - begin_ns, port.notes()};
}

}  // namespace g4lidar::test
