// SPDX-License-Identifier: MIT
// The commands of a request, their retry after a lost or impossible answer, and its result.
#pragma once

#include <cstdint>
#include <utility>

#include "g4lidar/core/command.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/core/response.hpp"

namespace g4lidar {

/// The next step of a request.
struct request_step {
  /// What to do.
  enum class action : std::uint8_t {
    start,    ///< Start the scan.
    restart,  ///< Restart the device.
    ask,      ///< Send `code` and wait for its answer.
    doubt,    ///< The answer is impossible: clear the link, then call lost().
    end,      ///< The request has ended with `how` and `value`.
    give_up,  ///< No answer can be obtained.
  };
  action what = action::give_up;
  command code = command::device_info;
  /// For ask: the one possible answer is known, so that no copy of another answer is taken for it.
  bool has_one_answer = false;
  verdict how = verdict::answered;
  answer value{};
};

/// The commands of one request. Has no clock and no connection: it receives valid answers, and
/// reports of lost answers after the link was cleared.
///
/// The answer to a command that changes state is predicted from the last answer. After any other
/// answer, and after none, the setting is queried. A value that was reached by changes is queried
/// once more, because responses have no checksum. (protocol: Commands)
class request_retry {
 public:
  constexpr request_retry() noexcept = default;
  /// The steps of `wanted`, which lidars like `model` have.
  explicit constexpr request_retry(const request& wanted, const model& model = g4_model) noexcept
      : wanted_(wanted),
        which_(&model),
        target_(wanted.what == request_kind::set_sample_rate ? code_of_rate(model, wanted.value)
                                                             : wanted.value) {}

  /// The first step, to a device that is idle and silent.
  [[nodiscard]] constexpr request_step first() const noexcept {
    switch (wanted_.what) {
      case request_kind::stop:
        return end({});
      case request_kind::start:
        return {.what = request_step::action::start};
      case request_kind::restart:
        return {.what = request_step::action::restart};
      default:
        return ask(question());
    }
  }

  /// `heard` must be a possible answer to the last command.
  [[nodiscard]] constexpr request_step answered(const response_view& heard) noexcept {
    if (const auto info = heard.as_device_info()) return end(*info);
    if (const auto state = heard.as_health()) return end(*state);
    if (wanted_.what == request_kind::zero_angle) return measured(zero_angle_of(heard, *which_));
    if (wanted_.what == request_kind::pitch) return measured(pitch_of(heard));
    const auto byte = heard.as_byte();
    if (byte && is_rate() && rate_hz_of_code(*which_, *byte) == 0) return doubt();
    const std::uint16_t value = value_in(heard);
    if (wanted_.what == request_kind::set_protection) return toggled(value);
    if (!is_moving()) return end(as_answer(value));
    switch (waits_for_) {
      case answer_of::query:
        return queried(value);
      case answer_of::move:
        return moved(value);
      case answer_of::confirmation:
        break;
    }
    return confirmed(value);
  }

  /// The answer was missing or impossible, and no bytes are in transit.
  [[nodiscard]] constexpr request_step lost() noexcept {
    const bool may_be_unknown = is_rate() && !which_->rates.is_settable;
    if (++losses_ == max_losses || may_be_unknown) return {};
    waits_for_ = answer_of::query;
    is_known_ = false;
    return ask(question());
  }

 private:
  friend struct session_test_access;
  enum class answer_of : std::uint8_t { query, move, confirmation };

  static constexpr int max_losses = 4;   // of answers, without a change between them
  static constexpr int max_unmoved = 3;  // changes without effect and without an answer
  static constexpr int max_toggles = 8;  // two for each loss
  static constexpr int max_moves = 60;   // more than all steps from one end to the other
  static constexpr int tolerance_chz = 5;
  static constexpr int coarse_chz = 100;
  static constexpr int fine_chz = 10;

  [[nodiscard]] static constexpr request_step ask(command code,
                                                  bool has_one_answer = false) noexcept {
    return {request_step::action::ask, code, has_one_answer, verdict::answered, {}};
  }
  [[nodiscard]] static constexpr request_step end(const answer& value,
                                                  verdict end = verdict::answered) noexcept {
    return {request_step::action::end, command::device_info, false, end, value};
  }
  [[nodiscard]] static constexpr request_step doubt() noexcept {
    return {request_step::action::doubt, command::device_info, false, verdict::answered, {}};
  }

  [[nodiscard]] constexpr bool is_rate() const noexcept {
    return wanted_.what == request_kind::get_sample_rate ||
           wanted_.what == request_kind::set_sample_rate;
  }
  /// A byte, or a frequency without the offset of the model.
  [[nodiscard]] constexpr std::uint16_t value_in(const response_view& heard) const noexcept {
    const auto chz = heard.as_frequency_chz();
    if (!chz) return heard.as_byte().value_or(0);
    const int corrected = int{*chz} + which_->frequency.reply_offset_chz;
    return corrected > 0 ? static_cast<std::uint16_t>(corrected) : std::uint16_t{0};
  }

  /// Whether the request needs commands that change state, and queries of that state.
  [[nodiscard]] constexpr bool is_moving() const noexcept {
    return wanted_.what == request_kind::step_scan_frequency ||
           wanted_.what == request_kind::set_scan_frequency ||
           wanted_.what == request_kind::set_sample_rate;
  }

  /// The first command, which is also repeated after a loss.
  [[nodiscard]] constexpr command question() const noexcept {
    const bool is_one = wanted_.value == 1;
    switch (wanted_.what) {
      case request_kind::
          health:  // alternating: a device answers one of them, and the answer may be lost
        return losses_ % 2 == 0 ? command::health : command::health_vendor;
      case request_kind::get_low_power:
        return command::low_power_query;
      case request_kind::set_low_power:
        return is_one ? command::low_power_on : command::low_power_off;
      case request_kind::get_direction:
        return command::motor_direction_query;
      case request_kind::set_direction:
        return is_one ? command::motor_counter_clockwise : command::motor_clockwise;
      case request_kind::get_scan_frequency:
      case request_kind::step_scan_frequency:
      case request_kind::set_scan_frequency:
        return command::frequency_query;
      case request_kind::set_constant_frequency:
        return is_one ? command::constant_frequency_on : command::constant_frequency_off;
      case request_kind::get_sample_rate:
      case request_kind::set_sample_rate:
        return command::sample_rate_query;
      case request_kind::set_protection:
        return command::protection_toggle;
      case request_kind::zero_angle:
        return command::zero_angle;
      case request_kind::pitch:
        return command::pitch;
      default:
        return command::device_info;
    }
  }

  /// A byte or frequency, in the type of the request.
  [[nodiscard]] constexpr answer as_answer(std::uint16_t value) const noexcept {
    const auto byte = static_cast<std::uint8_t>(value);
    switch (wanted_.what) {
      case request_kind::get_low_power:
      case request_kind::set_low_power:
        return static_cast<low_power>(byte);
      case request_kind::get_direction:
      case request_kind::set_direction:
        return static_cast<motor_direction>(byte);
      case request_kind::set_constant_frequency:
        return static_cast<constant_frequency>(byte);
      case request_kind::get_sample_rate:
      case request_kind::set_sample_rate:
        return static_cast<sample_rate>(rate_hz_of_code(*which_, byte));
      case request_kind::set_protection:
        return static_cast<power_down_protection>(byte);
      default:
        return scan_frequency{value};
    }
  }

  // ---- 93 and 98: an angle beyond a turn is none ----
  template <class Angle>
  [[nodiscard]] static constexpr request_step measured(const std::optional<Angle>& value) noexcept {
    return value ? end(*value) : doubt();
  }

  // ---- D9 has no query: its answers must alternate ----
  constexpr request_step toggled(std::uint16_t value) noexcept {
    if (++moves_ > max_toggles) return {};
    if (is_known_ && value == current_) return doubt();
    is_known_ = true;
    current_ = value;
    if (value == wanted_.value) return end(as_answer(value));
    return ask(command::protection_toggle, true);
  }

  // ---- 09 to 0C and D0: query, change, confirm ----
  constexpr request_step queried(std::uint16_t value) noexcept {
    current_ = value;
    if (!has_origin_) origin_ = value;
    has_origin_ = true;
    if (std::exchange(has_moved_, false)) judge_move();
    return go_on();
  }
  constexpr request_step moved(std::uint16_t value) noexcept {
    if (!is_move_to(value)) {
      denied_ = value == current_;
      return doubt();
    }
    current_ = value;
    count_progress();
    return go_on();
  }
  constexpr request_step confirmed(std::uint16_t value) noexcept {
    if (value == current_) return end(as_answer(value));
    if (++losses_ == max_losses) return {};
    current_ = value;
    return go_on();
  }

  /// The answer to a change was not received; the state has been queried.
  constexpr void judge_move() noexcept {
    if (current_ != before_) return count_progress();
    if (++unmoved_ < max_unmoved && !denied_) return;  // the command itself may have been lost
    (is_coarse_ ? coarse_stuck_ : stuck_) = true;
    count_progress();
  }
  constexpr void count_progress() noexcept {
    has_moved_ = false;
    denied_ = false;
    unmoved_ = 0;
    losses_ = 0;
  }

  [[nodiscard]] constexpr request_step go_on() noexcept {
    if (has_arrived()) {
      waits_for_ = answer_of::confirmation;
      return ask(question());
    }
    if (is_at_end() || moves_ == max_moves) return end(as_answer(current_), verdict_at_end());
    ++moves_;
    before_ = current_;
    has_moved_ = true;
    waits_for_ = answer_of::move;
    return ask(next_move(), true);
  }

  [[nodiscard]] constexpr int missing() const noexcept {
    return static_cast<int>(target_) - static_cast<int>(current_);
  }
  [[nodiscard]] constexpr bool has_arrived() const noexcept {
    if (wanted_.what == request_kind::step_scan_frequency) return current_ != origin_;
    if (wanted_.what == request_kind::set_sample_rate) return missing() == 0;
    return missing() <= tolerance_chz && -missing() <= tolerance_chz;
  }
  [[nodiscard]] constexpr bool is_at_end() const noexcept {
    return stuck_ || (coarse_stuck_ && wanted_.what == request_kind::step_scan_frequency);
  }
  /// A device that refuses the last step to the end of its range is as near as possible.
  [[nodiscard]] constexpr verdict verdict_at_end() const noexcept {
    const bool is_near = missing() < fine_chz && -missing() < fine_chz;
    if (wanted_.what == request_kind::set_scan_frequency && is_near) return verdict::answered;
    return wanted_.what == request_kind::step_scan_frequency ? verdict::answered
                                                             : verdict::not_reached;
  }

  [[nodiscard]] constexpr command next_move() noexcept {
    is_coarse_ = false;
    if (wanted_.what == request_kind::set_sample_rate) return command::sample_rate_next;
    const bool is_up = missing() > 0;
    const int far = is_up ? missing() : -missing();
    move_ = is_up ? command::frequency_up_0_1_hz : command::frequency_down_0_1_hz;
    if (far >= coarse_chz - tolerance_chz && !coarse_stuck_) {
      move_ = is_up ? command::frequency_up_1_hz : command::frequency_down_1_hz;
    }
    if (wanted_.what == request_kind::step_scan_frequency)
      move_ = static_cast<command>(wanted_.value);
    is_coarse_ = move_ == command::frequency_up_1_hz || move_ == command::frequency_down_1_hz;
    return move_;
  }

  /// Whether the last change can have led from `current_` to `value`; at the end of the device's
  /// range a step may be shorter.
  [[nodiscard]] constexpr bool is_move_to(std::uint16_t value) const noexcept {
    if (wanted_.what == request_kind::set_sample_rate) {
      return value == (current_ + 1) % rate_count(*which_);
    }
    const bool is_up = move_ == command::frequency_up_0_1_hz || move_ == command::frequency_up_1_hz;
    const int by = is_up ? value - current_ : current_ - value;
    return by > 0 && by <= (is_coarse_ ? coarse_chz : fine_chz);
  }

  request wanted_{request_kind::device_info};
  const model* which_ = &g4_model;
  std::uint16_t target_ = 0;  // the wanted value, or its code
  answer_of waits_for_ = answer_of::query;
  command move_ = command::frequency_query;
  std::uint16_t origin_ = 0;   // the first value
  std::uint16_t current_ = 0;  // the last value
  std::uint16_t before_ = 0;   // the value before the last change
  std::uint8_t losses_ = 0;
  std::uint8_t unmoved_ = 0;
  std::uint8_t moves_ = 0;
  bool has_origin_ = false;
  bool is_known_ = false;   // for the protection: `current_` holds an answer
  bool has_moved_ = false;  // the effect of a change is not known yet
  bool denied_ = false;     // the answer reported no change
  bool is_coarse_ = false;  // the change was a step by 1 Hz
  bool coarse_stuck_ = false;
  bool stuck_ = false;
};

}  // namespace g4lidar
