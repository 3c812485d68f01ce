// SPDX-License-Identifier: MIT
// The sums of many simulation runs.
#pragma once

#include <cstdint>
#include <string>

#include "simulation_run.hpp"

namespace g4lidar::simulation {

class summary {
 public:
  void add(const run_parameters& parameters, const run_report& report);

  [[nodiscard]] std::uint64_t failed() const { return failed_; }
  /// What is wrong with all of them together; empty if nothing is.
  [[nodiscard]] std::string problem() const;
  /// Several lines.
  [[nodiscard]] std::string text() const;

 private:
  std::uint64_t runs_ = 0;
  std::uint64_t failed_ = 0;
  std::uint64_t healthy_ = 0;
  run_report sum_;
  double longest_recovery_ = 0.0;  // as a part of what is allowed
  double recoveries_s_ = 0.0;
};

}  // namespace g4lidar::simulation
