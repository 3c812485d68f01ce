// SPDX-License-Identifier: MIT
// The cases through the C interface, in virtual time.
#include <g4lidar.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "c/c_handles.hpp"
#include "table.hpp"

namespace cases {
namespace {

using namespace g4lidar_c_test;

std::string text_in(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// "10:20"; without the first number it is 0.
std::pair<double, double> two_numbers(const std::string& text) {
  const std::size_t at = text.find(':');
  return {at == 0 ? 0.0 : std::stod(text), std::stod(text.substr(at + 1))};
}

/// The options of a case, and the memory that they refer to.
struct settings {
  std::map<std::string, std::string> texts;
  g4lidar_options opening = defaults();
  g4lidar_filter_options filter{};
  g4lidar_outlier_options speckle{};
  g4lidar_outlier_options edges{};
  g4lidar_sector ignored{};
  g4lidar_mask* mask = nullptr;
  g4lidar_shaper_options shape = shaper_defaults();

  explicit settings(const json& of) {
    g4lidar_filter_options_init(&filter, sizeof filter);
    g4lidar_outlier_options_init(&speckle, sizeof speckle);
    g4lidar_outlier_options_init(&edges, sizeof edges);
    filter.frame = G4LIDAR_ROBOT;
    shape.filter = &filter;
    const json options = options_of(of);
    for (const auto& [name, value] : options.items()) {
      texts[name] = text_of(value);
      value.is_boolean() ? take_flag(name) : take(name, texts[name]);
    }
    texts["source"] = source_of(of);
    opening.device = texts["source"].c_str();
  }
  settings(const settings&) = delete;
  settings& operator=(const settings&) = delete;
  ~settings() { g4lidar_mask_free(mask); }

  void take_flag(const std::string& name) {
    for (const auto& [each, member] : {std::pair{"listen_only", &opening.listen_only},
                                       {"leave_dtr", &opening.leave_dtr},
                                       {"reconnect", &opening.reconnect},
                                       {"probe_all_ports", &opening.probe_all_ports}})
      if (name == each) *member = true;
  }
  void take(const std::string& name, const std::string& text) {
    if (name == "model") opening.model = text.c_str();
    if (name == "baud") opening.baud = static_cast<std::uint32_t>(std::stoul(text));
    if (name == "frequency") opening.frequency_chz = std::stoi(text) * 100;
    if (name == "sample_rate") opening.sample_rate_hz = std::stoi(text);
    if (name == "direction") opening.direction = G4LIDAR_COUNTER_CLOCKWISE;
    if (name == "stall_time") opening.stall_time_ms = std::stoi(text);
    if (name == "zero_angle") {
      opening.has_zero_angle = true;
      opening.zero_angle_cdeg = std::stoi(text) * 100;
    }
    if (name == "fov") {
      const auto [begin, end] = two_numbers(text);
      filter.field_of_view = {begin, end};
    }
    if (name == "ignore") {
      const auto [begin, end] = two_numbers(text);
      ignored = {begin, end};
      filter.ignored_sectors = &ignored;
      filter.ignored_sector_count = 1;
    }
    if (name == "range") {
      const auto [least, greatest] = two_numbers(text);
      filter.least_range_mm = static_cast<float>(1000 * least);
      filter.greatest_range_mm = static_cast<float>(1000 * greatest);
    }
    if (name == "mask") {
      const std::string polygons = text_in(text);
      EXPECT_EQ(g4lidar_mask_parse(polygons.c_str(), &mask, nullptr), G4LIDAR_OK);
      filter.masks = g4lidar_mask_polygons(mask, &filter.mask_count);
    }
    if (name == "edges") shape.edges = &edges;
    if (name != "speckle") return;
    shape.speckle = &speckle;
    if (text == "on") return;
    speckle.near_m = 0.001F;  // the limits of the only case that has some
    speckle.near_ratio = 0.0001F;
    speckle.near_count = 4;
  }
};

outcome outcome_of(const g4lidar_error& why) {
  return {g4lidar_result_name(why.code), std::string(why.message) + " " + why.advice};
}

outcome outcome_of(const g4lidar_scan& last, const shaper& by) {
  outcome seen;
  seen.model = last.model;
  seen.samples = static_cast<double>(last.point_count);
  seen.frequency_hz = static_cast<double>(last.frequency_hz);
  seen.longest_m = static_cast<double>(last.longest_range_mm) * 1e-3;
  const auto kept = kept_by(by);
  std::vector<g4lidar_xy> places(kept.size());
  EXPECT_EQ(g4lidar_to_xy(kept.data(), kept.size(), G4LIDAR_ROBOT, last.turn_deg, places.data()),
            G4LIDAR_OK);
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i].range_mm > 0) seen.add(places[i].x_m, places[i].y_m, kept[i].intensity);
  return seen;
}

outcome run(const json& of) {
  settings given(of);
  simulator device;
  g4lidar_lidar* opened = nullptr;
  g4lidar_error why{};
  int code = G4LIDAR_OK;
  if (is_simulated(of) && of.contains("expect")) {
    device = simulate(source_of(of).c_str());
    code = g4lidar_open_simulated(device.get(), &given.opening, &opened, &why);
  } else {
    code = g4lidar_open_with(&given.opening, &opened, &why);
  }
  const lidar it(opened);
  if (code != G4LIDAR_OK || g4lidar_start(opened, &why) != G4LIDAR_OK) return outcome_of(why);
  const std::string model = g4lidar_get_recognition(opened)->model;
  given.shape.model = model.c_str();
  const shaper by = make(given.shape);
  outcome seen{"timeout", "no whole scan"};
  const g4lidar_scan* scan = nullptr;
  for (int i = 0; i < 20 && g4lidar_wait_scan(opened, 10'000, &scan, &why) == G4LIDAR_OK; ++i) {
    EXPECT_EQ(
        g4lidar_shaper_shape(by.get(), scan->points, scan->point_count, scan->is_piece, nullptr, 0),
        G4LIDAR_OK);
    if (scan->is_whole) seen = outcome_of(*scan, by);
  }
  return seen;
}

class C : public testing::TestWithParam<json> {};

TEST_P(C, DoesIt) { check(GetParam(), "c", run(GetParam())); }

INSTANTIATE_TEST_SUITE_P(Case, C, testing::ValuesIn(of_door("c")), name_in_test);

}  // namespace
}  // namespace cases
