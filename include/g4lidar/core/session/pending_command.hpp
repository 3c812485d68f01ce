// SPDX-License-Identifier: MIT
// One command over a connection that loses, delays and repeats bytes: which response answers it.
#pragma once

#include <cstdint>
#include <utility>

#include "g4lidar/core/command.hpp"
#include "g4lidar/core/model_record.hpp"
#include "g4lidar/core/response.hpp"

namespace g4lidar {

/// The `reply` of command.hpp for a kind of response. *Pure.*
[[nodiscard]] constexpr reply as_reply(response_kind kind) noexcept {
  switch (kind) {
    case response_kind::scan_started:
      return reply::scan_started;
    case response_kind::device_info:
      return reply::device_info;
    case response_kind::health:
      return reply::health;
    case response_kind::byte:
      return reply::byte;
    case response_kind::frequency:
      return reply::frequency;
    case response_kind::pitch:
      return reply::pitch;
  }
  return reply::none;
}

/// Whether `heard` can be a true answer to `code` of a lidar of any model. *Pure.* (protocol: Commands)
[[nodiscard]] constexpr bool can_answer(command code, const response_view& heard) noexcept {
  const auto traits = traits_of(code);
  if (!traits || traits->answered_by != as_reply(heard.kind())) return false;
  const auto byte = heard.as_byte();
  const bool is_frequency = traits->answered_by == reply::frequency && code != command::zero_angle;
  if (!byte) return !is_frequency || heard.as_frequency_chz();
  if (traits->fixed_answer) return *byte == *traits->fixed_answer;
  if (code == command::sample_rate_query) return *byte < all_rate_codes;
  return *byte < (code == command::sample_rate_next ? 3 : 2);
}

/// The state of a pending command.
enum class question_state : std::uint8_t {
  waiting,   ///< Nothing to do.
  send,      ///< Send code_to_send().
  answered,  ///< The last response is the answer.
  lost,      ///< There was no answer, and the link is clear: no late answer will arrive.
  silent,    ///< There was no answer, also not to the query that every device answers.
};

/// A command, and what to do if its answer is missing or impossible: the link is cleared with a
/// query that every device answers, and everything that arrives before that answer is discarded.
///
/// If a copy of an earlier answer may be in transit that could be taken for the answer to this
/// command, the link is cleared before the command is sent. (protocol: Commands, late replies)
class pending_command {
 public:
  /// Sends `code`. A has_one_answer command has one possible answer, known to the caller; it needs no
  /// clear link.
  constexpr void ask(command code, bool has_one_answer) noexcept {
    code_ = code;
    clears_ = 0;
    is_early_ = !has_one_answer && is_doubtful(code);
    is_early_ ? ask_known() : ask_itself();
  }

  /// The answer was lost, is impossible, or was interrupted by packets: clears the link.
  constexpr void clear() noexcept {
    is_slow_ = true;
    clears_ = 0;
    ask_known();
  }

  /// A response has arrived while this command is pending.
  [[nodiscard]] constexpr question_state take(const response_view& heard) noexcept {
    return is_clearing_ ? take_known(heard) : take_answer(heard);
  }

  /// No answer has arrived in time.
  [[nodiscard]] constexpr question_state late() noexcept {
    if (!is_clearing_) {
      clear();
    } else if (clears_ == max_clears) {
      return question_state::silent;
    } else {
      is_slow_ = true;
      ask_known();
    }
    return question_state::send;
  }

  /// An unrequested response: there may be copies of it.
  constexpr void take_unasked(const response_view& heard) noexcept {
    doubt_ = static_cast<std::uint8_t>(doubt_ | bit(heard.kind()));
  }
  /// Nothing is known about bytes in transit.
  constexpr void doubt_all() noexcept { doubt_ = all_kinds; }
  /// Another request begins: the device is assumed to be fast again.
  constexpr void be_quick() noexcept { is_slow_ = false; }

  /// The code of the command.
  [[nodiscard]] constexpr command code() const noexcept { return code_; }
  /// The code to send for it: the command, or the query that clears the link.
  [[nodiscard]] constexpr command code_to_send() const noexcept { return sent_; }
  /// Whether the link is being cleared.
  [[nodiscard]] constexpr bool is_clearing() const noexcept { return is_clearing_; }
  /// Whether to wait twice the usual time: after a loss the device may be slow.
  [[nodiscard]] constexpr bool is_patient() const noexcept {
    const bool is_last = is_clearing_ && clears_ == max_clears;
    return is_last || (is_slow_ && !is_clearing_);
  }

 private:
  friend struct session_test_access;
  static constexpr int max_clears = 3;
  static constexpr std::uint8_t all_kinds = 0xFF;

  [[nodiscard]] static constexpr std::uint8_t bit(response_kind kind) noexcept {
    return static_cast<std::uint8_t>(1U << static_cast<unsigned>(kind));
  }

  /// A device information is true, whenever it was requested.
  [[nodiscard]] constexpr bool is_doubtful(command code) const noexcept {
    const auto traits = traits_of(code);
    if (!traits || code == command::device_info) return false;
    for (const response_layout& layout : response_layouts) {
      if (traits->answered_by == as_reply(layout.kind)) return (doubt_ & bit(layout.kind)) != 0;
    }
    return false;
  }

  constexpr void ask_itself() noexcept {
    is_clearing_ = is_early_ = false;
    sent_ = code_;
  }

  /// Never the pending command, and alternating, so that a late answer is not taken for the answer
  /// to the next attempt.
  constexpr void ask_known() noexcept {
    const bool is_second = clears_++ == 1;
    sent_ = is_second ? command::health : command::device_info;
    if (code_ == command::device_info) sent_ = is_second ? command::health_vendor : command::health;
    if (code_ == command::health || code_ == command::health_vendor) sent_ = command::device_info;
    is_clearing_ = true;
  }

  [[nodiscard]] constexpr question_state take_known(const response_view& heard) noexcept {
    if (!can_answer(sent_, heard)) return question_state::waiting;
    doubt_ = bit(heard.kind());
    if (!is_early_) return question_state::lost;
    ask_itself();
    return question_state::send;
  }

  [[nodiscard]] constexpr question_state take_answer(const response_view& heard) noexcept {
    if (can_answer(code_, heard)) {
      doubt_ = bit(heard.kind());  // all earlier queries are answered; this one possibly twice
      return question_state::answered;
    }
    if ((doubt_ & bit(heard.kind())) != 0) return question_state::waiting;  // a copy
    clear();
    return question_state::send;
  }

  command code_ = command::device_info;
  command sent_ = command::device_info;
  std::uint8_t doubt_ =
      all_kinds;  // kinds of answers that may arrive without a query, one bit each
  std::uint8_t clears_ = 0;
  bool is_clearing_ = false;
  bool is_early_ = false;  // the link is cleared before the command instead of after it
  bool is_slow_ = false;
};

}  // namespace g4lidar
