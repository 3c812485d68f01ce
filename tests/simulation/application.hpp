// SPDX-License-Identifier: MIT
// The application of a simulation run: each call that it makes is checked.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "environment.hpp"
#include "invariant_checker.hpp"
#include "parameters.hpp"
#include "simulation_run.hpp"
#include "text.hpp"

namespace g4lidar::simulation {

/// *Single thread.*
class application {
 public:
  application(const run_parameters& parameters, bool verbose);
  application(const application&) = delete;
  application& operator=(const application&) = delete;

  [[nodiscard]] std::int64_t now() const { return environment_.clock.now_ns(); }
  [[nodiscard]] bool has_passed() const { return checker_.failure().empty(); }
  /// Revolutions over all lidars of this run.
  [[nodiscard]] std::uint64_t scans() const { return checker_.scans(); }

  void log(const std::string& what) const {
    if (verbose_) std::printf("%11.6f  %s\n", in_seconds(now()), what.c_str());
  }
  void fail(const std::string& what);

  /// One act as it was drawn.
  void act();
  /// As an application should: opens and starts where needed, and reads a scan.
  void read_calmly();
  /// Nothing is drawn any more that could wake it.
  void calm_down();
  /// Closes the lidar, after which the device must be idle and silent.
  void finish();
  /// What was found out. The lidar is gone then.
  [[nodiscard]] run_report report();

 private:
  template <class Call>
  std::int64_t within(std::int64_t limit_ns, const char* name, Call&& call);
  void check_progress();
  void print_events();
  void print_state();
  void wake();
  void sleep_until(std::int64_t until_ns);
  void act_once();
  bool be_scanning();
  void open();
  void close(bool politely);
  void start();
  void stop();
  void ask();
  void read_scan(std::chrono::milliseconds timeout);
  void read_points(std::chrono::milliseconds timeout);
  void process();
  void judge(const error& what);

  const run_parameters& parameters_;
  bool verbose_;
  dice dice_;
  environment environment_;
  invariant_checker checker_;
  std::unique_ptr<lidar> lidar_;
  bool wants_scan_ = false;
  std::uint64_t taken_ = 0;  // by next_points()
  std::int64_t printed_s_ = 0;
  std::int64_t awake_ns_ = 0;  // since it slept
  std::int64_t acted_ns_ = 0;
  int acts_ = 0;
  run_report report_;
};

}  // namespace g4lidar::simulation
