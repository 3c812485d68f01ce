// SPDX-License-Identifier: MIT
// What many lives come to.
#pragma once

#include <cstdint>
#include <string>

#include "life.hpp"

namespace g4lidar::lives {

class summary {
 public:
  void add(const life_plan& plan, const life_report& lived);

  [[nodiscard]] std::uint64_t failed() const { return failed_; }
  /// What is wrong with all of them together; empty if nothing is.
  [[nodiscard]] std::string problem() const;
  /// Several lines.
  [[nodiscard]] std::string text() const;

 private:
  std::uint64_t lives_ = 0;
  std::uint64_t failed_ = 0;
  std::uint64_t healthy_ = 0;
  life_report sum_;
  double longest_recovery_ = 0.0;  // as a part of what is allowed
  double recoveries_s_ = 0.0;
};

}  // namespace g4lidar::lives
