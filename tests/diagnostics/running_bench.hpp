// SPDX-License-Identifier: MIT
// A simulated lidar that a driver reads in virtual time, and its running diagnosis.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "diagnostics/doctor_bench.hpp"
#include "g4lidar/diagnostics/running_diagnosis.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar::test {

/// Wraps each transport of another connector, and states the model of the lidar as that of a port does.
class wrapping_connector final : public forwarding_connector {
 public:
  wrapping_connector(std::unique_ptr<connector> from, wrapper wrap, const model* which = nullptr)
      : forwarding_connector(std::move(from)), wrap_(std::move(wrap)), which_(which) {}
  [[nodiscard]] connector_traits traits() const noexcept override {
    connector_traits known = forwarding_connector::traits();
    known.recognised.model = which_;
    known.recognised.by = which_ != nullptr ? known_by::number : known_by::nothing;
    return known;
  }
  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    auto port = inner().connect();
    if (!port || !wrap_) return port;
    return wrap_(std::move(*port));
  }

 private:
  wrapper wrap_;
  const model* which_;
};

/// How a program uses a lidar.
struct use {
  sim::device_options device{};
  std::vector<sim::fault> faults{};
  wrapper wrap{};
  lidar_options options{};
  running_diagnosis_options judged{};
  const model* numbered = nullptr;  ///< Recognised by its number, not named.
  std::int64_t seconds = 20;
  bool takes_points = false;  // next_points(), not try_scan()
  /// Called once a second with the time.
  std::function<void(lidar&, std::int64_t second)> each_second{};
};

/// What a program has seen that looked once a second.
struct seen {
  std::vector<std::vector<stage_report>> looks{};

  /// The names of all diagnoses that were ever reported, in the order of the enumeration.
  [[nodiscard]] std::string diagnoses() const {
    std::set<diagnosis> all;
    for (const auto& stages : looks) {
      for (const auto& stage : stages) all.insert(stage.diagnoses.begin(), stage.diagnoses.end());
    }
    std::string text;
    for (const diagnosis what : all)
      text.append(text.empty() ? "" : " ").append(describe(what).name);
    return text;
  }
  /// Those of one look.
  [[nodiscard]] std::string diagnoses(std::size_t look) const {
    return seen{{looks.at(look)}}.diagnoses();
  }
};

inline std::ostream& operator<<(std::ostream& out, const seen& all) {
  for (std::size_t i = 0; i < all.looks.size(); ++i) {
    examined one;
    one.stages = all.looks[i];
    out << "\nlook " << i << one;
  }
  return out;
}

inline seen watch(const use& how) {
  using namespace std::chrono_literals;
  sim::device simulated(sim::built_in_world(), how.device, how.faults);
  sim::virtual_clock clock;
  running_diagnosis judge(how.judged);
  auto from = std::make_unique<wrapping_connector>(
      std::make_unique<sim::virtual_connector>(simulated, clock), how.wrap,
      how.numbered != nullptr ? how.numbered : how.options.model);
  auto opened = lidar::open(judge.observe(std::move(from)), how.options);
  seen all;
  if (!opened) {
    judge.add(opened.error());
    all.looks.push_back(judge.stages());
    return all;
  }
  if (const auto started = opened->start(); !started) {
    judge.add(started.error());
    if (std::getenv("SHOW")) std::fprintf(stderr, "start: %s\n", started.error().message().c_str());
    all.looks.push_back(judge.stages());
  }
  std::int64_t looked_s = 0;
  bool is_over = false;
  while (!is_over && clock.now_ns() < how.seconds * 1'000'000'000) {
    const auto got = how.takes_points ? result<void>(opened->next_points(200ms).map([](auto) {}))
                                      : result<void>(opened->try_scan(200ms).map([](auto) {}));
    while (const auto event = opened->next_event()) judge.add(*event);
    if (!got && got.error() == problem::not_scanning) {
      clock.advance_to(clock.now_ns() + 100'000'000);
    } else {
      is_over = !got && got.error().is_fatal();
    }
    if (!got) judge.add(got.error());
    if (is_over && std::getenv("SHOW")) std::fprintf(stderr, "%s\n", got.error().message().c_str());
    const std::int64_t now_s = clock.now_ns() / 1'000'000'000;
    if (!is_over && now_s == looked_s) continue;
    looked_s = now_s;
    all.looks.push_back(judge.stages());
    if (how.each_second) how.each_second(*opened, now_s);
  }
  return all;
}

}  // namespace g4lidar::test
