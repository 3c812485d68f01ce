// SPDX-License-Identifier: MIT
// The steps that need a user: targets and the unplug.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "acceptance_run.hpp"

namespace g4lidar {
namespace {

using enum acceptance_verdict;
using enum answer_state;
using q = acceptance_question;

std::string_view why_declined(const acceptance_options& options) noexcept {
  return options.ask ? "The user declined." : "There is no user to ask.";
}

/// With two digits behind the point.
std::string rounded(double value) {
  const auto hundredths = std::llround(std::abs(value) * 100.0);
  const std::string rest = std::to_string(hundredths % 100);
  return (value < 0.0 && hundredths != 0 ? "-" : "") + std::to_string(hundredths / 100) + "." +
         (rest.size() < 2 ? "0" : "") + rest;
}

/// Compares the direction of a target straight ahead with the turn of the table.
void bearing(acceptance_result& into, double angle_deg, const model& which,
             std::optional<double> zero_offset_deg) {
  constexpr double allowed_deg = 10.0;
  const double offset_deg = zero_offset_deg.value_or(0.0);
  const auto bearing_with = [&](double added_deg) {
    return std::remainder(which.turn_deg - angle_deg - added_deg, 360.0);
  };
  const double stated_deg = bearing_with(offset_deg);
  into.add("device_angle_deg", angle_deg);
  into.add("robot_bearing_deg", stated_deg);
  const bool is_ahead = std::abs(stated_deg) <= allowed_deg;
  into.add_finding(is_ahead ? agrees : differs,
                   is_ahead ? "It is straight ahead, by the turn of the table."
                            : "By the turn of the table it is " + rounded(stated_deg) +
                                  " degrees from straight ahead.");
  const std::string zero =
      "Straight ahead is at " + rounded(angle_deg) + " degrees, as the device sends it.";
  if (!zero_offset_deg) {
    if (which.zero_angle_divisor != 0) {
      return into.add_answer(q::zero_direction, not_decided, zero + " 93 was not answered.");
    }
    return into.add_answer(q::zero_direction, answered, zero);
  }
  // The readings of the offset, of which one must be clearly the best.
  struct reading {
    double added_deg;
    std::string_view words;
  };
  const std::array readings{reading{offset_deg, " The offset is to be added."},
                            reading{0.0, " The offset is already applied."},
                            reading{-offset_deg, " The offset is to be subtracted."}};
  const auto distance = [&](const reading& each) { return std::abs(bearing_with(each.added_deg)); };
  const double step_deg = std::abs(std::remainder(offset_deg, 360.0));
  const reading& best = *std::ranges::min_element(readings, {}, distance);
  constexpr double least_deg = 3.0;
  if (step_deg < least_deg) {
    return into.add_answer(q::zero_direction, not_decided,
                           zero + " An offset of " + rounded(offset_deg) +
                               " degrees is too small to show whether it is applied.");
  }
  const bool is_clear = distance(best) <= std::min(allowed_deg, step_deg / 3.0);
  into.add_answer(q::zero_direction, is_clear ? answered : not_decided,
                  zero + (is_clear ? std::string(best.words)
                                   : " An offset of " + rounded(offset_deg) +
                                         " degrees does not fit clearly in one way."));
}

}  // namespace

void acceptance_run::target(acceptance_result& into, acceptance_action where) {
  const auto placed_mm = options_.ask ? options_.ask(where) : std::nullopt;
  if (!placed_mm) return into.add_finding(not_done, why_declined(options_));
  if (link_->start() < 0) {
    link_->stop();
    return into.add_finding(differs, "No packet came.");
  }
  static_cast<void>(link_->survey(spun_up_ns));
  direction_survey seen(*which_);
  std::int64_t until_ns = link_->monitor().now_ns() + 3'000 * ms;
  link_->monitor().listen(until_ns, {.event = [&](const observed_event& found) {
                            const auto* const packet = std::get_if<packet_view>(&found.what);
                            if (packet != nullptr) seen.take(*packet);
                          }});
  link_->stop();
  if (where == acceptance_action::place_near) target_degree_ = seen.nearest();
  const auto range_mm = target_degree_ ? seen.range_mm(*target_degree_) : std::nullopt;
  if (!range_mm) return into.add_finding(differs, "Nothing was measured in this direction.");
  const double angle_deg = static_cast<double>(*target_degree_) + 0.5;
  const double ratio = *range_mm / *placed_mm;
  into.add("placed_mm", *placed_mm);
  into.add("measured_mm", *range_mm);
  into.add("ratio", ratio);
  const double allowed_mm = std::max(30.0, 0.05 * *placed_mm);
  const bool is_near = std::abs(*range_mm - *placed_mm) <= allowed_mm;
  into.add_finding(is_near ? agrees : differs, is_near ? "The range is that of the target."
                                                       : "The range is not that of the target.");
  if (where == acceptance_action::place_near) {
    near_ratio_ = ratio;
    return bearing(into, angle_deg, *which_, zero_offset_deg_);
  }
  // Two distances: a target that was measured wrongly has no constant ratio.
  constexpr double same = 0.1;
  const bool is_constant = near_ratio_ && std::abs(ratio / *near_ratio_ - 1.0) <= same;
  into.add_answer(
      q::range_unit, is_constant ? answered : not_decided,
      is_constant
          ? (is_near ? "It is."
                     : "It is not: ranges are " + rounded(ratio) + " of what they should be.")
          : "The two targets differ by different factors, " + rounded(near_ratio_.value_or(0.0)) +
                " and " + rounded(ratio) + ".");
}

void acceptance_run::unplug(acceptance_result& into) {
  constexpr std::int64_t look_ns = 200 * ms;
  const auto wait_ns = std::chrono::nanoseconds(options_.plug_time).count();
  const auto step_frequency = [this](bool up) {
    using enum command;
    return link_->ask(static_cast<std::uint8_t>(up ? frequency_up_0_1_hz : frequency_down_0_1_hz))
        .number();
  };
  const auto frequency = [this]() -> std::optional<std::int32_t> {
    if (which_->frequency.max_dhz == 0) return std::nullopt;
    return link_->ask(static_cast<std::uint8_t>(command::frequency_query)).number();
  };
  if (which_->frequency.max_dhz == 0) {
    into.add_answer(q::kept_settings, not_applicable, "The model has no setting that is known.");
  }
  if (!options_.ask) return into.add_finding(not_done, why_declined(options_));
  // Only a setting that is not the usual one shows whether it is kept.
  const auto before = frequency();
  const auto middle = (which_->frequency.min_dhz + which_->frequency.max_dhz) * 5;
  const bool is_up = before && *before < middle;
  const auto changed = before ? step_frequency(is_up) : std::nullopt;
  const auto set_back = [&] {
    link_->monitor().ignore_cancel();
    if (changed && changed != before) static_cast<void>(step_frequency(!is_up));
  };
  if (!options_.ask(acceptance_action::unplug)) {
    set_back();
    return into.add_finding(not_done, why_declined(options_));
  }
  const std::int64_t begin_ns = link_->monitor().now_ns();
  while (!link_->monitor().is_over() && link_->monitor().now_ns() < begin_ns + wait_ns)
    link_->monitor().listen_for(look_ns);
  const auto failure = link_->monitor().failure();
  if (!failure) {
    set_back();
    const bool is_cancelled = options_.is_cancelled && options_.is_cancelled();
    return is_cancelled ? into.add_finding(not_done, "Interrupted.")
                        : into.add_finding(differs, "The connection was not lost.");
  }
  into.add("lost_as", std::string(name_of(failure->code())));
  if (!options_.ask(acceptance_action::plug_in)) {
    return into.add_finding(not_done, "The user declined.");
  }
  const std::int64_t gone_ns = from_.now_ns();
  if (!reopen(wait_ns)) return into.add_finding(differs, "The lidar did not come back.");
  into.add("back_after_ms", in_ms(from_.now_ns() - gone_ns));
  const bool is_one_way = !is_two_way();
  if (is_one_way && which_->motor == motor_kind::dtr) static_cast<void>(link_->set_dtr(true));
  const std::int64_t back_ns = link_->monitor().now_ns();
  const std::int64_t first_ns = link_->wait_for_packet(is_one_way ? 12'000 * ms : 3'000 * ms);
  const bool is_steady = is_one_way && first_ns >= 0 && link_->wait_until_steady() > 0.0;
  const double steady_ms = in_ms(link_->monitor().now_ns() - back_ns);
  const bool boots = link_->monitor().boots() > 0 || link_->monitor().counts().responses > 0;
  into.add("boots", std::string(boots ? "yes" : "no"));
  if (is_one_way) {
    if (is_steady) {
      into.add("steady_after_ms", steady_ms);
      if (!dtr_drives_) {
        into.add_answer(q::spin_up, answered,
                        spin_up_words(first_ns, steady_ms) + " Counted since the port was open.");
      }
    }
    if (dtr_drives_ && boots && !boots_after_dtr_) {
      into.add_answer(q::dtr_cut, answered,
                      "The motor: it sends a boot message at power-on, and not when DTR rises.");
    }
    return into.add_finding(first_ns >= 0 ? agrees : differs,
                            first_ns >= 0 ? "It sends again." : "It does not send again.");
  }
  // A boot message may have been sent before the system had the port again.
  into.add_answer(
      q::unasked_bytes, boots || first_ns >= 0 ? answered : not_decided,
      std::string(first_ns >= 0 ? "After power-on it sends packets"
                                : "After power-on it sends no packets") +
          (boots ? ", and a boot message." : ", and no boot message since the port was open."));
  raw_reply got;
  constexpr int tries = 5;
  for (int i = 0; i < tries && got.content().empty(); ++i) {
    got = link_->ask(static_cast<std::uint8_t>(command::device_info), 1'000 * ms);
  }
  const bool is_same = !identified_.empty() && std::ranges::equal(got.content(), identified_);
  into.add_finding(is_same ? agrees : differs,
                   is_same ? "The same lidar answers." : "Another lidar answers, or none.");
  const auto after = frequency();
  if (!before || !changed || !after) return;
  into.add("frequency_before_hz", *changed / 100.0);
  into.add("frequency_after_hz", *after / 100.0);
  const bool is_kept = after == changed;
  const bool is_decided = is_same && changed != before;
  into.add_answer(q::kept_settings, is_decided ? answered : not_decided,
                  !is_decided ? "The setting could not be changed, or it is another lidar."
                  : is_kept   ? "The scan frequency does."
                              : "The scan frequency does not.");
  if (is_decided && is_kept) static_cast<void>(step_frequency(!is_up));
}

}  // namespace g4lidar
