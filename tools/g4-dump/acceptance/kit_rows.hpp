// SPDX-License-Identifier: MIT
// The kit as rows: what is done, what is expected with which tolerance, what it answers, what is set back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kept_settings.hpp"
#include "kit.hpp"
#include "tested_lidar.hpp"

namespace g4_tool::acceptance {

/// Which numbers are right; yes is 1, and no is 0.
struct expected {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool is_known = true;  ///< False: the table does not state it.
};

/// A step.
struct step_row {
  step of;
  std::string_view name;
  bool (*has)(const tested_lidar&);  ///< Whether it is done with this lidar.
  std::string_view missing;          ///< Why it is not.
  /// Sends, listens, and states facts.
  void (*measure)(tested_lidar&, step_result&);
  setting changes = setting::none;  ///< To be set back behind the step.
};

/// What an expectation follows from.
struct known_facts {
  const tested_lidar& lidar;
  const step_result& now;
  const model& row = lidar.row;
  bool is_two_way = lidar.is_two_way();
  /// The number of a fact of this step, or else of an earlier one.
  [[nodiscard]] double number(std::string_view fact, double otherwise = 0.0) const {
    return lidar.number(now, fact).value_or(otherwise);
  }
};

/// What is expected of a fact of a step.
struct check_row {
  step of;
  std::string_view fact;
  expected (*by_table)(const known_facts&);
  bool only_refutes = false;     ///< A right value proves nothing.
  std::string_view advice = {};  ///< Where it is wrong.
};

/// A query of the step `queries`.
struct query_row {
  std::uint8_t code;
  std::string_view name;
  std::size_t length;  ///< Of the content of its answer.
  presence (*by_table)(const model&);
};

/// A question about the family that only a real device answers.
struct question_row {
  std::string_view text;
  step asked_by;
  bool (*arises)(const model&);
  /// Facts of any steps: the first one is only stated where it decides the question, the others add to it.
  std::array<std::string_view, 4> answered_by;
};

/// What a run shows about an open question.
struct question_answer {
  enum class state : std::uint8_t { open, does_not_arise, answered } how;
  std::string text;  ///< The answer, or the reason why there is none.
};

[[nodiscard]] std::span<const step_row> step_rows() noexcept;
[[nodiscard]] std::span<const check_row> check_rows() noexcept;
[[nodiscard]] std::span<const query_row> query_rows() noexcept;
[[nodiscard]] std::span<const question_row> question_rows() noexcept;

/// The answers to the open questions, in their order.
[[nodiscard]] std::vector<question_answer> answers_of(const model& model,
                                                      std::span<const step_result> results);

// What the steps do.
void bridge(tested_lidar& lidar, step_result& result);
void listening(tested_lidar& lidar, step_result& result);
void identity(tested_lidar& lidar, step_result& result);
void queries(tested_lidar& lidar, step_result& result);
void protection(tested_lidar& lidar, step_result& result);
void frequency(tested_lidar& lidar, step_result& result);
void sample_rate(tested_lidar& lidar, step_result& result);
void start_and_stop(tested_lidar& lidar, step_result& result);
void dtr(tested_lidar& lidar, step_result& result);
void stream(tested_lidar& lidar, step_result& result);
void sample_bits(tested_lidar& lidar, step_result& result);
void ct_information(tested_lidar& lidar, step_result& result);
void time_packets(tested_lidar& lidar, step_result& result);
void near_target(tested_lidar& lidar, step_result& result);
void far_target(tested_lidar& lidar, step_result& result);
void lose_and_return(tested_lidar& lidar, step_result& result);

}  // namespace g4_tool::acceptance
