// SPDX-License-Identifier: MIT
// The doctor's questions: the same ones several times, and what the answers are like.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "doctor_ear.hpp"
#include "doctor_words.hpp"
#include "g4lidar/request.hpp"
#include "g4lidar/response.hpp"

namespace g4_dump {

/// What a device said of itself, as most of its answers have it.
struct device_portrait {
  std::optional<g4lidar::device_information> information{};
  std::optional<g4lidar::health> health{};
  std::optional<std::uint16_t> frequency_chz{};
  std::optional<g4lidar::ranging_frequency> ranging{};
};

/// All questions that were asked. Those that were disturbed by packets or a boot do not count.
class question_book {
 public:
  void add(exchange made);
  [[nodiscard]] const std::vector<exchange>& exchanges() const noexcept { return made_; }
  [[nodiscard]] unsigned answered() const noexcept;
  [[nodiscard]] device_portrait portrait() const;
  /// Diagnoses and numbers.
  void judge(stage_report& report) const;
  /// It has answered, and then nothing came any more.
  [[nodiscard]] bool has_died() const;
  /// So many answers were not as they ought to be that more questions tell nothing more.
  [[nodiscard]] bool is_clear() const;

  /// Later than this, an answer is late.
  static constexpr std::int64_t late_ns = 150'000'000;

 private:
  struct tally {
    unsigned late = 0;
    unsigned very_late = 0;
    unsigned wrong = 0;
    unsigned twice = 0;
    unsigned missing = 0;
    unsigned damaged = 0;
    unsigned missing_at_end = 0;  // in a row, whatever was asked
    unsigned missing_before = 0;  // of the missing, those before that
  };
  [[nodiscard]] tally count() const;
  /// Firmware need not know this question, and this one has never answered it.
  [[nodiscard]] bool is_unknown(g4lidar::command code) const;
  /// Differs from what was answered to the same question most often.
  [[nodiscard]] bool is_odd(const exchange& one) const;
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> usual(g4lidar::command code) const;

  std::vector<exchange> made_;
};

/// Asks all questions that move nothing in the device, in rounds, and adds them to the book.
/// `first_latency_ns`: of an answer that came already.
void ask_all(ear& line, question_book& book, std::int64_t first_latency_ns);

}  // namespace g4_dump
