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
#include "subject.hpp"

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
  bool (*has)(const subject&);  ///< Whether it is done with this lidar.
  std::string_view missing;     ///< Why it is not.
  /// Sends, listens, and states facts.
  void (*measure)(subject&, step_result&);
  setting changes = setting::none;  ///< To be set back behind the step.
};

/// What an expectation follows from.
struct known {
  const subject& all;
  const step_result& now;
  const model& row = all.row;
  bool is_two_way = all.is_two_way();
  /// The number of a fact of this step, or else of an earlier one.
  [[nodiscard]] double number(std::string_view fact, double otherwise = 0.0) const {
    return all.number(now, fact).value_or(otherwise);
  }
};

/// What is expected of a fact of a step.
struct check_row {
  step of;
  std::string_view fact;
  expected (*by_table)(const known&);
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
[[nodiscard]] std::vector<question_answer> answers_of(const model& which,
                                                      std::span<const step_result> results);

// What the steps do.
void bridge(subject& of, step_result& into);
void listening(subject& of, step_result& into);
void identity(subject& of, step_result& into);
void queries(subject& of, step_result& into);
void protection(subject& of, step_result& into);
void frequency(subject& of, step_result& into);
void sample_rate(subject& of, step_result& into);
void start_and_stop(subject& of, step_result& into);
void dtr(subject& of, step_result& into);
void stream(subject& of, step_result& into);
void sample_bits(subject& of, step_result& into);
void ct_information(subject& of, step_result& into);
void time_packets(subject& of, step_result& into);
void near_target(subject& of, step_result& into);
void far_target(subject& of, step_result& into);
void unplug(subject& of, step_result& into);

}  // namespace g4_tool::acceptance
