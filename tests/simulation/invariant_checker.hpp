// SPDX-License-Identifier: MIT
// Checks the invariants of a simulation run from outside, at each call of the driver to its transport.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "environment.hpp"
#include "g4lidar/lidar.hpp"
#include "parameters.hpp"
#include "sample_matcher.hpp"

namespace g4lidar::simulation {

/// How far the times of points were from the truth, 5 s and more after the last break and the last sleep.
struct time_counts {
  std::uint64_t settled = 0;  ///< Points.
  std::uint64_t ahead = 0;    ///< Of all points: delivered before they were measured, as it seems.
  std::uint64_t late = 0;     ///< More than 1 ms off.
  double sum_of_squares = 0.0;  ///< In ns^2.
  std::int64_t worst_ns = 0;
};

/// *Single thread.* The first thing that is wrong is kept; what follows from it is not looked for.
class invariant_checker {
 public:
  invariant_checker(const run_parameters& parameters, environment& on)
      : parameters_(&parameters), environment_(&on), matcher_(parameters.device.scanner.format) {}

  /// A lidar is there and is watched; it is not, any more.
  void begin(lidar& opened);
  void moved(lidar& here) { lidar_ = &here; }
  void end();
  /// The application has done something behind which packets may be passed over, and the clock of
  /// the samples begins anew.
  void breaks() {
    is_broken_ = true;
    broke_ns_ = environment_->clock.now_ns();
  }
  /// The same, again and again until it is over.
  void is_breaking(bool now) {
    is_breaking_ = now;
    breaks();
  }

  /// Before each call of a transport, and after each call of the driver.
  void look();
  /// The application calls.
  void app_call() { ++app_calls_; }
  /// Points as a call gave them: a stretch of those that the ring gave.
  void check_stretch(std::span<const point> points, const char* whose);
  void check_scan(const scan& found);
  void check_taken(std::uint64_t taken, bool all);
  /// It is read as what it is, and a number that contradicts this is reported.
  void check_recognition();

  void fail(const std::string& what);
  [[nodiscard]] const std::string& failure() const { return failure_; }
  [[nodiscard]] const truth_counts& truths() const { return matcher_.counts(); }
  [[nodiscard]] const time_counts& times() const { return times_; }
  /// Revolutions over all lidars of this run.
  [[nodiscard]] std::uint64_t scans() const { return scans_before_ + last_.scans; }
  [[nodiscard]] std::uint64_t holes() const { return holes_; }

 private:
  void take_truth();
  void take_points();
  void settle(bool all);
  void check(const known_point& found);
  void check_time(const known_point& found);
  void check_counts();
  void check_calls();

  const run_parameters* parameters_;
  environment* environment_;
  lidar* lidar_ = nullptr;
  std::optional<lidar_ring::reader> reader_;
  sample_matcher matcher_;
  std::deque<known_point> history_;
  lidar_counts last_;
  std::uint64_t scans_before_ = 0;
  std::uint64_t read_ = 0;    // of the ring
  std::uint64_t missed_ = 0;  // of the ring
  std::uint64_t passed_over_ = 0;
  std::uint64_t holes_ = 0;
  std::int64_t last_time_ns_ = 0;
  std::int64_t last_index_ = -1;
  std::int64_t steady_since_ns_ = 0;
  bool is_broken_ = true;
  bool is_breaking_ = false;
  std::int64_t broke_ns_ = 0;  // points from before then may still come
  time_counts times_;
  transport_calls calls_then_;
  std::uint64_t app_calls_ = 0;
  std::uint64_t app_calls_then_ = 0;
  std::int64_t second_began_ns_ = 0;
  std::vector<sim::sent_sample> samples_ = std::vector<sim::sent_sample>(4096);
  std::vector<point> points_ = std::vector<point>(16384);
  std::string failure_;
};

}  // namespace g4lidar::simulation
