// SPDX-License-Identifier: MIT
// The acceptance kit with one simulated lidar, in virtual time.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "acceptance/kit_rows.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/sim/world.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4_tool::acceptance::test {

namespace sim = g4lidar::sim;

/// The replies to some commands, by their codes, which the lidar does not get.
using other_replies = std::map<std::uint8_t, std::vector<std::uint8_t>>;

/// A port whose system sets another rate than the wanted one, and reports it; and whose lidar has other replies.
class odd_port final : public forwarding_transport {
 public:
  odd_port(std::unique_ptr<transport> inner, std::uint32_t baud, const other_replies& replies)
      : forwarding_transport(std::move(inner)), baud_(baud), replies_(replies) {}
  [[nodiscard]] std::uint32_t baud() const noexcept override {
    return baud_ != 0 ? baud_ : inner().baud();
  }
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    const auto other = data.size() == 2 ? replies_.find(data[1]) : replies_.end();
    if (other == replies_.end()) return inner().write(data, deadline_ns);
    reply_ = &other->second;
    return {};
  }
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    if (reply_ == nullptr) return inner().read(out, deadline_ns);
    const auto* const reply = std::exchange(reply_, nullptr);
    std::ranges::copy(*reply, out.begin());
    return received{reply->size(), now_ns()};
  }

 private:
  std::uint32_t baud_;
  const other_replies& replies_;
  const std::vector<std::uint8_t>* reply_ = nullptr;  // to be read next
};

/// Connects to one device after the other: to the second when the first was unplugged.
class bench_connector final : public connector {
 public:
  bench_connector(sim::device& first, sim::device& second, sim::virtual_clock& clock)
      : first_(first, clock), second_(second, clock) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    auto port = (is_second ? second_ : first_).connect();
    if (!port || (set_baud == 0 && replies.empty())) return port;
    return std::make_unique<odd_port>(*std::move(port), set_baud, replies);
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return first_.now_ns(); }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override {
    return first_.pause(deadline_ns);
  }
  void wake() noexcept override { first_.wake(); }

  bool is_second = false;
  std::uint32_t set_baud = 0;  // 0: the wanted one
  other_replies replies{};

 private:
  sim::virtual_connector first_;
  sim::virtual_connector second_;
};

/// One simulated lidar, the model that is expected, and the user who serves the run.
struct bench {
  sim::device_options options;
  std::string_view expected = "g4";
  double placed_mm = 800.0;
  double ahead_deg = 0.0;  ///< The direction of the targets, counter-clockwise from straight ahead.
  double back_m = 4.0;     ///< The distance of the wall behind the lidar.
  double post_m = 0.0;     ///< The distance of a post before this wall; 0: there is none.
  bool declines = false;
  std::int64_t cancelled_at_ns = never_ns;
  std::optional<step> throws_after{};  ///< As where a result cannot be written.
  bool scans = false;                  ///< A program has left it scanning.
  bool stays_unplugged = false;
  std::optional<sim::device_options> returns_as{};  ///< Another lidar is plugged in.
  std::uint32_t set_baud = 0;                       ///< What the system sets; 0: the wanted rate.
  other_replies replies{};
  const port_info* port = nullptr;
  std::vector<sim::fault> faults{};
  std::chrono::milliseconds stream_time = std::chrono::seconds(10);

  explicit bench(std::string_view word) : expected(word) {
    EXPECT_TRUE(sim::use_model(options, word));
  }

  [[nodiscard]] std::vector<step_result> run() {
    // A room with a wall 0.8 m ahead of the lidar, whose cable points to +x; the others are 4 m away.
    sim::world room{{{back_m, -4, back_m, 4},
                     {back_m, 4, -0.8, 4},
                     {-0.8, 4, -0.8, -4},
                     {-0.8, -4, back_m, -4}},
                    {0.0, 0.0, -ahead_deg}};
    if (post_m > 0.0) room.walls.push_back({post_m, -0.05, post_m, 0.05});
    sim::device simulated(room, options, faults);
    sim::device other(room, returns_as.value_or(options));
    sim::virtual_clock clock;
    if (scans) {
      const std::vector<std::uint8_t> start{0xA5, 0x60};
      simulated.write(start, clock.now_ns());
    }
    bench_connector from(simulated, other, clock);
    from.set_baud = set_baud;
    from.replies = replies;
    run_options how;
    how.model = model_named(expected);
    how.stream_time = stream_time;
    how.port = port;
    how.ask = [&](user_action what) -> std::optional<double> {
      if (declines) return std::nullopt;
      if (what == user_action::unplug) simulated.unplug(clock.now_ns() + 1);
      if (what == user_action::plug_in && !stays_unplugged) {
        from.is_second = returns_as.has_value();
        if (!from.is_second) simulated.replug(clock.now_ns() + 1);
      }
      return placed_mm;
    };
    how.on_step = [&](step now) { begun_ns[now] = clock.now_ns(); };
    how.on_result = [&](const step_result& done) {
      if (done.of == throws_after) throw std::runtime_error("no room");
    };
    how.on_lost_settings = [this](const std::string& words) { lost_settings = words; };
    how.is_cancelled = [&] { return clock.now_ns() >= cancelled_at_ns; };
    const auto look = [&] {
      static_cast<void>(simulated.is_plugged(clock.now_ns() + 1'000'000'000));
      motor_turns = simulated.motor_turns();
      settings = simulated.settings();
      end_ns = clock.now_ns();
    };
    try {
      auto [all, lost] = acceptance::run(from, how);
      failure = lost;
      look();
      return all;
    } catch (const std::runtime_error&) {
      look();
      return {};
    }
  }

  // What is there after the run.
  bool motor_turns = true;
  sim::device_settings settings;
  std::optional<error> failure{};
  std::string lost_settings{};
  std::int64_t end_ns = 0;
  std::map<step, std::int64_t> begun_ns{};
};

inline const step_result& at(const std::vector<step_result>& all, step of) {
  return all.at(static_cast<std::size_t>(of));
}

/// The answer to the question with this text.
inline question_answer answer_to(const bench& of, const std::vector<step_result>& all,
                                 std::string_view text) {
  const auto row = std::ranges::find_if(question_rows(), [&](const question_row& each) {
    return each.text.find(text) != std::string_view::npos;
  });
  return answers_of(*model_named(of.expected), all)
      .at(static_cast<std::size_t>(row - question_rows().begin()));
}

inline double number_of(const step_result& of, std::string_view name) {
  const auto found = std::ranges::find(of.facts, name, &evidence::name);
  if (found == of.facts.end()) return -1.0;
  if (const auto* whole = std::get_if<std::int64_t>(&found->value)) {
    return static_cast<double>(*whole);
  }
  const auto* const number = std::get_if<double>(&found->value);
  return number == nullptr ? -1.0 : *number;
}

/// Everything, for the message of a failed test.
inline std::string all_of(const std::vector<step_result>& results) {
  std::string text;
  for (const step_result& each : results) {
    text +=
        std::string(name_of(each.of)) + " " + std::string(name_of(each.outcome)) + ": " + each.text;
    for (const evidence& one : each.facts) text += " " + one.name + "=" + one.text();
    text += '\n';
  }
  return text;
}

/// For the names of tests.
inline std::string test_name(std::string_view word) {
  std::string name(word);
  std::ranges::replace(name, '-', '_');
  return name;
}

}  // namespace g4_tool::acceptance::test
