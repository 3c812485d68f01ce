// SPDX-License-Identifier: MIT
// The steps that need a user: targets and the unplug.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "kit_rows.hpp"

namespace g4_tool::acceptance {
namespace {

using enum finding;

std::string_view why_declined(const run_options& options) noexcept {
  return options.ask ? "The user declined." : "There is no user to ask.";
}

/// The direction of a target straight ahead, and in which way an offset of zero fits it.
void bearing(const tested_lidar& lidar, step_result& result, double angle_deg) {
  constexpr double least_deg = 3.0;
  constexpr double allowed_deg = 10.0;
  const double offset_deg = lidar.zero_offset_deg.value_or(0.0);
  const auto bearing_with = [&](double added_deg) {
    return std::remainder(lidar.row.turn_deg - angle_deg - added_deg, 360.0);
  };
  result.add("device_angle_deg", angle_deg);
  result.add("robot_bearing_deg", bearing_with(offset_deg));
  if (lidar.row.zero_angle_divisor == 0) return result.add("zero_is_at_deg", angle_deg);
  // One of them must be clearly the best.
  struct reading {
    double added_deg;
    std::string_view words;
  };
  const std::array readings{reading{offset_deg, "to be added"}, reading{0.0, "already applied"},
                            reading{-offset_deg, "to be subtracted"}};
  const auto distance = [&](const reading& each) { return std::abs(bearing_with(each.added_deg)); };
  const double step_deg = std::abs(std::remainder(offset_deg, 360.0));
  const reading& best = *std::ranges::min_element(readings, {}, distance);
  if (step_deg < least_deg || distance(best) > std::min(allowed_deg, step_deg / 3.0)) {
    return result.find(
        agrees,
        fmt::format("An offset of {:.2f} degrees does not show how it is used.", offset_deg));
  }
  result.add("zero_is_at_deg", angle_deg);
  result.add("offset_is", std::string(best.words));
}

/// Whether the target was measured.
bool target(tested_lidar& lidar, step_result& result, user_action place) {
  const auto placed_mm = lidar.options.ask ? lidar.options.ask(place) : std::nullopt;
  if (!placed_mm) {
    result.find(not_done, why_declined(lidar.options));
    return false;
  }
  const bool starts = lidar.link->start() >= 0;
  result.add("starts", starts);
  static_cast<void>(lidar.link->survey(spun_up_ns));
  const packet_survey heard = lidar.link->survey(3'000 * ms);
  lidar.link->stop();
  if (!starts) return false;
  if (place == user_action::place_near) lidar.target_degree = heard.directions.nearest();
  const auto range_mm =
      lidar.target_degree ? heard.directions.range_mm(*lidar.target_degree) : std::nullopt;
  result.add("placed_mm", *placed_mm);
  result.add("measured_mm", range_mm.value_or(0.0));
  result.add("ratio", range_mm.value_or(0.0) / *placed_mm);
  return range_mm.has_value();
}

}  // namespace

void near_target(tested_lidar& lidar, step_result& result) {
  if (target(lidar, result, user_action::place_near) && lidar.target_degree)
    bearing(lidar, result, static_cast<double>(*lidar.target_degree) + 0.5);
}

void far_target(tested_lidar& lidar, step_result& result) {
  const double near_ratio = lidar.number({step::near_target}, "ratio").value_or(0.0);
  if (!target(lidar, result, user_action::place_far)) return;
  const double ratio = lidar.number(result, "ratio").value_or(0.0);
  // Two distances: a target that was measured wrongly has no constant ratio.
  constexpr double same = 0.1;
  if (near_ratio > 0.0 && std::abs(ratio / near_ratio - 1.0) <= same)
    return result.add("range_ratio", ratio);
  result.find(observed,
              fmt::format("The two targets differ by different factors, {:.2f} and {:.2f}.",
                          near_ratio, ratio));
}

namespace {

using chz = std::optional<std::int32_t>;

/// Sets another frequency: only a setting that is not the usual one shows whether it is kept. Returns what the lidar
/// then has.
chz change_frequency(tested_lidar& lidar, std::int32_t before_chz) {
  const int middle_chz = (lidar.row.frequency.min_chz + lidar.row.frequency.max_chz) / 2;
  lidar.settings.begin_change(setting::frequency);
  static_cast<void>(lidar.link->ask(before_chz < middle_chz ? command::frequency_up_0_1_hz
                                                            : command::frequency_down_0_1_hz));
  return lidar.link->number(command::frequency_query);
}

/// How the connection broke; nothing if it did not.
std::optional<error> wait_for_loss(lidar_link& link, std::int64_t wait_ns) {
  constexpr std::int64_t look_ns = 200 * ms;
  const std::int64_t begin_ns = link.now_ns();
  while (!link.is_over() && link.now_ns() < begin_ns + wait_ns) link.listen_for(look_ns);
  return link.failure();
}

/// What a one-way lidar does after it was plugged in.
void returned_one_way(tested_lidar& lidar, step_result& result) {
  const std::int64_t back_ns = lidar.link->now_ns();
  const std::int64_t first_ns = lidar.link->wait_for_packet(12'000 * ms);
  const steady_motor motor = first_ns >= 0 ? wait_until_steady(*lidar.link) : steady_motor{};
  const bool boots = lidar.link->boots() > 0 || lidar.link->counts().responses > 0;
  const bool dtr_drives = lidar.number(result, "low_silences") == 1.0;
  result.add("boots", boots);
  result.add("sends_again", first_ns >= 0);
  if (motor.hz > 0.0) result.add("steady_after_ms", in_ms(motor.since_ns - back_ns));
  if (dtr_drives && boots && !lidar.boots_after_dtr)
    result.add("dtr_switches", std::string("motor"));
}

/// `changed`: the frequency that was set before the loss, if it is not the one of `before`.
void returned_two_way(tested_lidar& lidar, step_result& result, chz before, chz changed) {
  const std::int64_t first_ns = lidar.link->wait_for_packet(3'000 * ms);
  const bool boots = lidar.link->boots() > 0 || lidar.link->counts().responses > 0;
  // A boot message may have been sent before the system had the port again.
  result.add("boots", boots);
  if (first_ns >= 0 || boots)
    result.add("unasked", std::string(first_ns >= 0 ? "packets" : "a boot message"));
  if (first_ns >= 0) lidar.link->stop_scan();
  const bool is_same = !lidar.identified.empty() && lidar.is_same();
  result.add("same_lidar", is_same);
  const chz after = before ? lidar.link->number(command::frequency_query) : std::nullopt;
  if (!changed || !after) return;
  result.add("frequency_before_hz", *changed / 100.0);
  result.add("frequency_after_hz", *after / 100.0);
  if (is_same && changed != before) result.add("settings_kept", after == changed);
}

}  // namespace

void lose_and_return(tested_lidar& lidar, step_result& result) {
  const auto wait_ns = std::chrono::nanoseconds(lidar.options.plug_time).count();
  if (!lidar.options.ask) return result.find(not_done, why_declined(lidar.options));
  const chz before = lidar.settings.before(setting::frequency);
  const chz changed = before ? change_frequency(lidar, *before) : std::nullopt;
  if (!lidar.options.ask(user_action::unplug))
    return result.find(not_done, why_declined(lidar.options));
  const auto failure = wait_for_loss(*lidar.link, wait_ns);
  result.add("connection_lost", failure.has_value());
  if (!failure) return;
  result.add("lost_as", std::string(name_of(failure->code())));
  if (!lidar.options.ask(user_action::plug_in)) return result.find(not_done, "The user declined.");
  const std::int64_t gone_ns = lidar.from.now_ns();
  const bool is_back = lidar.reopen(wait_ns);
  result.add("came_back", is_back);
  if (!is_back) return;
  result.add("back_after_ms", in_ms(lidar.from.now_ns() - gone_ns));
  if (lidar.row.motor == motor_kind::dtr) lidar.link->set_dtr(true);
  lidar.is_two_way() ? returned_two_way(lidar, result, before, changed)
                     : returned_one_way(lidar, result);
}

}  // namespace g4_tool::acceptance
