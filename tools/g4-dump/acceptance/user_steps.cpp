// SPDX-License-Identifier: MIT
// The steps that need a user: targets and the unplug.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "rows.hpp"

namespace g4_tool::acceptance {
namespace {

using enum finding;

std::string_view why_declined(const run_options& options) noexcept {
  return options.ask ? "The user declined." : "There is no user to ask.";
}

/// The direction of a target straight ahead, and in which way an offset of zero fits it.
void bearing(const subject& of, step_result& into, double angle_deg) {
  constexpr double least_deg = 3.0;
  constexpr double allowed_deg = 10.0;
  const double offset_deg = of.zero_offset_deg.value_or(0.0);
  const auto bearing_with = [&](double added_deg) {
    return std::remainder(of.row.turn_deg - angle_deg - added_deg, 360.0);
  };
  into.add("device_angle_deg", angle_deg);
  into.add("robot_bearing_deg", bearing_with(offset_deg));
  if (of.row.zero_angle_divisor == 0) return into.add("zero_is_at_deg", angle_deg);
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
    return into.find(
        agrees,
        fmt::format("An offset of {:.2f} degrees does not show how it is used.", offset_deg));
  }
  into.add("zero_is_at_deg", angle_deg);
  into.add("offset_is", std::string(best.words));
}

/// Whether the target was measured.
bool target(subject& of, step_result& into, user_action where) {
  const auto placed_mm = of.options.ask ? of.options.ask(where) : std::nullopt;
  if (!placed_mm) {
    into.find(not_done, why_declined(of.options));
    return false;
  }
  const bool starts = of.link->start() >= 0;
  into.add("starts", starts);
  static_cast<void>(of.link->survey(spun_up_ns));
  const packet_survey heard = of.link->survey(3'000 * ms);
  of.link->stop();
  if (!starts) return false;
  if (where == user_action::place_near) of.target_degree = heard.directions.nearest();
  const auto range_mm =
      of.target_degree ? heard.directions.range_mm(*of.target_degree) : std::nullopt;
  into.add("placed_mm", *placed_mm);
  into.add("measured_mm", range_mm.value_or(0.0));
  into.add("ratio", range_mm.value_or(0.0) / *placed_mm);
  return range_mm.has_value();
}

}  // namespace

void near_target(subject& of, step_result& into) {
  if (target(of, into, user_action::place_near) && of.target_degree)
    bearing(of, into, static_cast<double>(*of.target_degree) + 0.5);
}

void far_target(subject& of, step_result& into) {
  const double near_ratio = of.number({step::near_target}, "ratio").value_or(0.0);
  if (!target(of, into, user_action::place_far)) return;
  const double ratio = of.number(into, "ratio").value_or(0.0);
  // Two distances: a target that was measured wrongly has no constant ratio.
  constexpr double same = 0.1;
  if (near_ratio > 0.0 && std::abs(ratio / near_ratio - 1.0) <= same)
    return into.add("range_ratio", ratio);
  into.find(observed, fmt::format("The two targets differ by different factors, {:.2f} and {:.2f}.",
                                  near_ratio, ratio));
}

namespace {

using chz = std::optional<std::int32_t>;

/// What a one-way lidar does after it was plugged in.
void returned_one_way(subject& of, step_result& into) {
  const std::int64_t back_ns = of.link->now_ns();
  const std::int64_t first_ns = of.link->wait_for_packet(12'000 * ms);
  const steady_motor motor = first_ns >= 0 ? wait_until_steady(*of.link) : steady_motor{};
  const bool boots = of.link->boots() > 0 || of.link->counts().responses > 0;
  const bool dtr_drives = of.number(into, "low_silences") == 1.0;
  into.add("boots", boots);
  into.add("sends_again", first_ns >= 0);
  if (motor.hz > 0.0) into.add("steady_after_ms", in_ms(motor.since_ns - back_ns));
  if (dtr_drives && boots && !of.boots_after_dtr) into.add("dtr_switches", std::string("motor"));
}

/// `changed`: the frequency that was set before the loss, if it is not the one of `before`.
void returned_two_way(subject& of, step_result& into, chz before, chz changed) {
  const std::int64_t first_ns = of.link->wait_for_packet(3'000 * ms);
  const bool boots = of.link->boots() > 0 || of.link->counts().responses > 0;
  // A boot message may have been sent before the system had the port again.
  into.add("boots", boots);
  if (first_ns >= 0 || boots)
    into.add("unasked", std::string(first_ns >= 0 ? "packets" : "a boot message"));
  if (first_ns >= 0) of.link->stop_scan();
  const bool is_same = !of.identified.empty() && of.is_same();
  into.add("same_lidar", is_same);
  const chz after = before ? of.link->number(command::frequency_query) : std::nullopt;
  if (!changed || !after) return;
  into.add("frequency_before_hz", *changed / 100.0);
  into.add("frequency_after_hz", *after / 100.0);
  if (is_same && changed != before) into.add("settings_kept", after == changed);
}

}  // namespace

void unplug(subject& of, step_result& into) {
  constexpr std::int64_t look_ns = 200 * ms;
  const auto wait_ns = std::chrono::nanoseconds(of.options.plug_time).count();
  if (!of.options.ask) return into.find(not_done, why_declined(of.options));
  // Only a setting that is not the usual one shows whether it is kept.
  const chz before = of.settings.before(setting::frequency);
  chz changed;
  if (before) {
    const int middle = (of.row.frequency.min_dhz + of.row.frequency.max_dhz) * 5;
    of.settings.begin_change(setting::frequency);
    static_cast<void>(of.link->ask(*before < middle ? command::frequency_up_0_1_hz
                                                    : command::frequency_down_0_1_hz));
    changed = of.link->number(command::frequency_query);
  }
  if (!of.options.ask(user_action::unplug)) return into.find(not_done, why_declined(of.options));
  const std::int64_t begin_ns = of.link->now_ns();
  while (!of.link->is_over() && of.link->now_ns() < begin_ns + wait_ns)
    of.link->listen_for(look_ns);
  const auto failure = of.link->failure();
  into.add("connection_lost", failure.has_value());
  if (!failure) return;
  into.add("lost_as", std::string(name_of(failure->code())));
  if (!of.options.ask(user_action::plug_in)) return into.find(not_done, "The user declined.");
  const std::int64_t gone_ns = of.from.now_ns();
  const bool is_back = of.reopen(wait_ns);
  into.add("came_back", is_back);
  if (!is_back) return;
  into.add("back_after_ms", in_ms(of.from.now_ns() - gone_ns));
  if (of.row.motor == motor_kind::dtr) of.link->set_dtr(true);
  of.is_two_way() ? returned_two_way(of, into, before, changed) : returned_one_way(of, into);
}

}  // namespace g4_tool::acceptance
