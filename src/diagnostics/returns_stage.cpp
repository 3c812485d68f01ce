// SPDX-License-Identifier: MIT
// The stage returns: whether something comes back, and from where nothing does.
#include <cmath>
#include <string>
#include <utility>

#include "g4lidar/core/angle.hpp"
#include "stages.hpp"

namespace g4lidar {
namespace {

/// Narrower sectors without a return are not reported.
constexpr int least_blind_deg = 30;
constexpr int full_turn_deg = 360;

}  // namespace

void report_returns(stage_log& log, const stream_statistics& measured, const device_snapshot& known,
                    const model& wanted, const point_filter& directions) {
  const return_map& seen = measured.tally().returns;
  if (!seen.is_round()) {
    return log.skip(diagnostic_stage::returns, "The lidar has not looked in each direction.");
  }
  stage_report report{.stage = diagnostic_stage::returns};
  report.add("samples", seen.samples());
  report.add("returns", seen.returns());
  if (seen.returns() == 0) {
    report.find(diagnosis::no_returns);
    return log.report(std::move(report));
  }
  point_filter wished = directions;
  wished.turn_deg = wanted.turn_deg;
  const float zero_deg = known.zero ? static_cast<float>(known.zero->deg()) : 0.0F;
  const auto bearing_of = [&](float seen_deg) {
    return static_cast<float>(wrap_deg(seen_deg + zero_deg));
  };
  const auto arcs = seen.without_return(least_blind_deg, [&](float middle_deg) {
    return wished.has_direction({.angle_deg = bearing_of(middle_deg)});
  });
  std::string places;
  std::string options;
  for (const direction_arc& arc : arcs) {
    const auto in_words = [&](int degree) {
      const float turned = bearing_of(static_cast<float>(degree));
      return std::to_string(std::lround(bearing_deg(turned, wished.in, wanted.turn_deg)) %
                            full_turn_deg);
    };
    std::string from = in_words(arc.from_deg);
    std::string to = in_words(arc.from_deg + arc.width_deg);
    if (wished.in == frame::robot) std::swap(from, to);  // it is mirrored
    report.add("nothing_from_deg", from);
    report.add("nothing_to_deg", to);
    report.add("nothing_width_deg", arc.width_deg);
    places.append(places.empty() ? "" : "; in ").append(from).append(" to ").append(to);
    places.append(" degrees (").append(std::to_string(arc.width_deg)).append(" wide)");
    options.append(options.empty() ? "" : " ")
        .append("--ignore ")
        .append(from)
        .append(":")
        .append(to);
  }
  if (!arcs.empty()) {
    report.remark.append("Nothing returned in ").append(places).append(", ");
    report.remark += wished.in == frame::robot ? "counter-clockwise from ahead (frame robot)."
                                               : "clockwise from 0 of the lidar (frame vendor).";
    report.remark += arcs.front().width_deg > full_turn_deg / 2
                         ? " Is the window covered there, or is nothing within the range?"
                         : " Is something mounted there?";
    report.remark.append(" Leave it out: ").append(options);
  }
  log.report(std::move(report));
}

}  // namespace g4lidar
