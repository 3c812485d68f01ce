// SPDX-License-Identifier: MIT
// The cases through lidar::open() and scan_shaper; and that the table is complete.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "g4lidar/cartesian.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/options/option_table.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "g4lidar/sim/setup.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "table.hpp"

namespace cases {
namespace {

using namespace g4lidar;
using namespace std::chrono_literals;

TEST(Table, NamesACaseOnce_AndADoorThatCannotHaveItWithAKnownReason) {
  std::set<std::string> names;
  const json doors = table().at("doors");
  for (const json& each : table().at("cases")) {
    EXPECT_TRUE(names.insert(each.at("name")).second) << each;
    EXPECT_NE(each.contains("expect"), each.contains("error")) << each;
    const json others = each.value("not", json::object());
    for (const auto& [door, reason] : others.items()) {
      EXPECT_NE(std::ranges::find(doors, json(door)), doors.end()) << each;
      EXPECT_NE(door, "library") << each;
      EXPECT_TRUE(table().at("reasons").contains(reason.get<std::string>())) << each;
    }
  }
}

/// What the options of a case set.
struct settings {
  lidar_options opening;
  filter_settings filters;
  g4lidar::mask mask;
  outcome wrong;

  void take(const std::string& name, const json& value) {
    const parameter* const row = find_parameter(name);
    std::string why;
    if (row == nullptr) {
      why = "unknown option";
    } else if (name == "mask") {
      auto read = load_mask(text_of(value));
      if (auto* const made = std::get_if<g4lidar::mask>(&read)) {
        mask = std::move(*made);
        return;
      }
      wrong = {"bad_file", std::get<std::string>(read)};
      return;
    } else if (row->kind == parameter_kind::filter) {
      why = set_filter(filters, name, text_of(value));
    } else if (value.is_boolean()) {
      why = set_option(opening, *row, value.get<bool>());
    } else {
      why = set_option(opening, *row, converted(text_of(value), row->type));
    }
    if (!why.empty()) wrong = {"bad_option", name + ": " + why};
  }
};

outcome outcome_of(const error& why) { return {std::string(name_of(why.code())), why.message()}; }

outcome outcome_of(const scan& last, scan_shaper& shaper) {
  outcome seen;
  seen.model = last.model->word;
  seen.samples = static_cast<double>(last.points.size());
  seen.frequency_hz = static_cast<double>(last.measured_frequency_hz());
  seen.shortest_m = last.model->range.min_mm * 1e-3;
  seen.longest_m = last.model->range.max_mm * 1e-3;
  for (const point& each : shaper.kept()) {
    if (each.is_no_return()) continue;
    const xy_point at = to_xy(each, frame::robot, last.model->turn_deg);
    seen.add(at.x_m, at.y_m, each.intensity);
  }
  return seen;
}

outcome run(const json& of) {
  settings given;
  given.filters.filter.in = frame::robot;
  const json options = options_of(of);
  for (const auto& [name, value] : options.items()) given.take(name, value);
  if (!given.wrong.error.empty()) return given.wrong;
  given.opening.device = source_of(of);
  sim::virtual_clock clock;
  std::optional<sim::device> device;
  if (is_simulated(of) && of.contains("expect")) {
    const auto how = std::get<sim::setup>(sim::parse_setup(source_of(of)));
    device.emplace(std::get<sim::world>(sim::load_world(how.world_file)), how.device, how.faults);
    if (given.opening.model == nullptr && !how.model.empty())
      given.opening.model = model_named(how.model);
  }
  auto lidar =
      device ? lidar::open(std::make_unique<sim::virtual_connector>(*device, clock), given.opening)
             : lidar::open(given.opening);
  if (!lidar) return outcome_of(lidar.error());
  if (const auto started = lidar->start(); !started) return outcome_of(started.error());
  shaping_options shape{.filter = given.filters.complete_filter(), .marks = given.filters.marks};
  shape.filter.masks = given.mask.polygons();
  scan_shaper shaper(shape);
  outcome seen{"timeout", "no whole scan"};
  for (int i = 0; i < 20; ++i) {
    const auto next = lidar->wait_scan(10s);
    if (!next) break;
    shaper.shape(*next);
    if (next->is_whole()) seen = outcome_of(*next, shaper);
  }
  return seen;
}

class Library : public testing::TestWithParam<json> {};

TEST_P(Library, DoesIt) { check(GetParam(), "library", run(GetParam())); }

INSTANTIATE_TEST_SUITE_P(Case, Library, testing::ValuesIn(of_door("library")), name_in_test);

}  // namespace
}  // namespace cases
