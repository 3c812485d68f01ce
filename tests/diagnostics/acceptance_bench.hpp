// SPDX-License-Identifier: MIT
// The acceptance run with one simulated lidar, in virtual time.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/diagnostics/acceptance.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "g4lidar/transport/forwarding.hpp"

namespace g4lidar::test {

/// A port whose system sets another rate than the wanted one, and reports it.
class off_rate_port final : public forwarding_transport {
 public:
  off_rate_port(std::unique_ptr<transport> inner, std::uint32_t baud)
      : forwarding_transport(std::move(inner)), baud_(baud) {}
  [[nodiscard]] std::uint32_t baud() const noexcept override { return baud_; }

 private:
  std::uint32_t baud_;
};

/// Connects to one device after the other: to the second when the first was unplugged.
class bench_connector final : public connector {
 public:
  bench_connector(sim::device& first, sim::device& second, sim::virtual_clock& clock)
      : first_(first, clock), second_(second, clock) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    auto port = (is_second ? second_ : first_).connect();
    if (!port || set_baud == 0) return port;
    return std::make_unique<off_rate_port>(*std::move(port), set_baud);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return first_.now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override {
    return first_.pause(deadline_ns);
  }
  void wake() noexcept override { first_.wake(); }

  bool is_second = false;
  std::uint32_t set_baud = 0;  // 0: the wanted one

 private:
  sim::virtual_connector first_;
  sim::virtual_connector second_;
};

/// One simulated lidar, the model that is expected, and the user who serves the run.
struct acceptance_bench {
  sim::device_options options;
  std::string_view expected = "g4";
  double placed_mm = 800.0;
  double ahead_deg = 0.0;  ///< The direction of the targets, counter-clockwise from straight ahead.
  bool declines = false;
  bool cancels = false;
  bool scans = false;  ///< A program has left it scanning.
  bool stays_unplugged = false;
  std::optional<sim::device_options> returns_as{};  ///< Another lidar is plugged in.
  std::uint32_t set_baud = 0;                       ///< What the system sets; 0: the wanted rate.
  const port_info* port = nullptr;
  std::vector<sim::fault> faults{};
  std::chrono::milliseconds stream_time = std::chrono::seconds(10);

  explicit acceptance_bench(std::string_view word) : expected(word) {
    EXPECT_TRUE(sim::use_model(options, word));
  }

  [[nodiscard]] std::vector<acceptance_result> run() {
    // A room with a wall 0.8 m ahead of the lidar, whose cable points to +x; the others are 4 m away.
    const sim::world room{{{4, -4, 4, 4}, {4, 4, -0.8, 4}, {-0.8, 4, -0.8, -4}, {-0.8, -4, 4, -4}},
                          {0.0, 0.0, -ahead_deg}};
    sim::device simulated(room, options, faults);
    sim::device other(room, returns_as.value_or(options));
    sim::virtual_clock clock;
    if (scans) {
      const std::vector<std::uint8_t> start{0xA5, 0x60};
      simulated.write(start, clock.now_ns());
    }
    bench_connector from(simulated, other, clock);
    from.set_baud = set_baud;
    acceptance_options how;
    how.model = expected.empty() ? nullptr : model_named(expected);
    how.stream_time = stream_time;
    how.port = port;
    how.ask = [&](acceptance_action what) -> std::optional<double> {
      if (declines) return std::nullopt;
      if (what == acceptance_action::unplug) simulated.unplug(clock.now_ns() + 1);
      if (what == acceptance_action::plug_in && !stays_unplugged) {
        from.is_second = returns_as.has_value();
        if (!from.is_second) simulated.replug(clock.now_ns() + 1);
      }
      return placed_mm;
    };
    how.on_step = [&](acceptance_step step) {
      if (step == acceptance_step::stream) stream_began_ns = clock.now_ns();
    };
    how.is_cancelled = [this] { return cancels; };
    auto all = run_acceptance(from, how);
    static_cast<void>(simulated.is_plugged(clock.now_ns() + 1'000'000'000));
    motor_turns = simulated.motor_turns();
    settings = simulated.settings();
    seconds = static_cast<double>(clock.now_ns()) / 1e9;
    return all;
  }

  bool motor_turns = true;
  sim::device_settings settings;
  double seconds = 0.0;
  std::int64_t stream_began_ns = 0;
};

inline const acceptance_result& at(const std::vector<acceptance_result>& all,
                                   acceptance_step step) {
  return all.at(static_cast<std::size_t>(step));
}

inline question_answer answer_to(const std::vector<acceptance_result>& all,
                                 acceptance_question question) {
  return answers_of(all).at(static_cast<std::size_t>(question));
}

inline double number_of(const acceptance_result& of, std::string_view name) {
  const auto found = std::ranges::find(of.measurements, name, &evidence::name);
  if (found == of.measurements.end()) return -1.0;
  if (const auto* whole = std::get_if<std::int64_t>(&found->value)) {
    return static_cast<double>(*whole);
  }
  const auto* const number = std::get_if<double>(&found->value);
  return number == nullptr ? -1.0 : *number;
}

/// Everything, for the message of a failed test.
inline std::string all_of(const std::vector<acceptance_result>& results) {
  std::string text;
  for (const acceptance_result& each : results) {
    text += std::string(name_of(each.step)) + " " + std::string(name_of(each.outcome)) + ": " +
            each.text;
    for (const evidence& one : each.measurements) text += " " + one.name + "=" + one.text();
    text += '\n';
  }
  for (const question_answer& each : answers_of(results)) {
    text += std::string(name_of(each.state)) + ": " +
            std::string(open_questions()[static_cast<std::size_t>(each.question)].text) + " " +
            each.text + '\n';
  }
  return text;
}

}  // namespace g4lidar::test
