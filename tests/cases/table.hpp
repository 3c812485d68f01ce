// SPDX-License-Identifier: MIT
// The table of cases, cases.json: what each door of the library is given, and what has to come out. Expected numbers are
// those of the simulated world, of the models' data sheets, and of the options.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cases {

using nlohmann::json;

/// Something that a lidar has seen, in the frame of the robot.
struct hit {
  double bearing_deg = 0;
  double range_m = 0;
  unsigned intensity = 0;
};

/// What came out of a door. What it does not show stays empty.
struct outcome {
  std::string error{};  ///< The problem or the exit code; empty: none.
  std::string words{};
  std::optional<std::string> model{};
  std::optional<double> samples{};
  std::optional<double> frequency_hz{};
  std::optional<double> shortest_m{};  ///< That the model measures.
  std::optional<double> longest_m{};
  std::vector<hit> hits{};

  void add(float x_m, float y_m, unsigned intensity = 0) {
    const auto x = static_cast<double>(x_m);
    const auto y = static_cast<double>(y_m);
    hits.push_back({std::atan2(y, x) * 180 / std::numbers::pi, std::hypot(x, y), intensity});
  }
};

inline const std::string directory = G4LIDAR_SOURCE_DIR "/tests/cases";

inline const json& table() {
  static const json all = json::parse(std::ifstream(directory + "/cases.json"));
  return all;
}

/// A text of the table, whose $ is the directory of the table.
inline std::string text_of(const json& value) {
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  if (text.starts_with("$")) text.replace(0, 1, directory);
  if (const auto at = text.find("=$/"); at != std::string::npos) text.replace(at + 1, 1, directory);
  return text;
}

/// The cases that a door can be given.
inline std::vector<json> of_door(const std::string& door) {
  std::vector<json> all;
  for (const json& each : table().at("cases")) {
    if (!each.contains("not") || !each.at("not").contains(door)) all.push_back(each);
  }
  return all;
}

inline std::string source_of(const json& of) { return text_of(of.at("source")); }
inline bool is_simulated(const json& of) { return source_of(of).starts_with("sim:"); }
inline json options_of(const json& of) { return of.value("options", json::object()); }

inline std::string name_in_test(const testing::TestParamInfo<json>& of) {
  return of.param.at("name");
}

/// The words of a command line; `flag` gives the name that an option of the table has there.
template <class Flag>
std::vector<std::string> words_of(const json& of, const Flag& flag) {
  std::vector<std::string> words;
  const json options = options_of(of);
  for (const auto& [name, value] : options.items()) {
    words.push_back(flag(name));
    if (!value.is_boolean()) words.back() += "=" + text_of(value);
  }
  return words;
}

/// How far away the nearest thing is in this direction, within 5 degrees; 0: there is none.
inline double nearest(const outcome& seen, double bearing_deg) {
  double least = 0;
  for (const hit& each : seen.hits) {
    if (std::fabs(std::remainder(each.bearing_deg - bearing_deg, 360)) > 5) continue;
    if (least == 0 || each.range_m < least) least = each.range_m;
  }
  return least;
}

/// No hit between two bearings, and if `outside`, hits in every other direction.
inline void check_directions(double begin, double end, bool outside, const outcome& seen) {
  std::vector<bool> is_seen(360);
  const double width = end - begin;
  for (const hit& each : seen.hits) {
    const double behind = std::remainder(each.bearing_deg - begin - width / 2, 360) + width / 2;
    EXPECT_FALSE(behind > 0.01 && behind < width - 0.01) << each.bearing_deg;
    is_seen.at(static_cast<std::size_t>(std::floor(each.bearing_deg + 720)) % 360) = true;
  }
  if (!outside) return;
  EXPECT_NEAR(static_cast<double>(std::ranges::count(is_seen, true)), 360 - width, 2);
}

template <class Seen, class Check>
void check_one(const json& want, const std::string& name, const std::string& door, const Seen& seen,
               const Check& check) {
  if (!want.contains(name)) return;
  const json hidden = table().at("unseen").value(door, json::array());
  ASSERT_EQ(seen.has_value(), std::ranges::find(hidden, json(name)) == hidden.end()) << name;
  if (seen) check(*seen);
}

inline void check_hits(const json& want, const outcome& seen) {
  json walls = want;
  if (want.contains("walls"))
    walls.update({{"ahead", 1}, {"left", 2}, {"behind", 4}, {"right", 3}});
  int bearing_deg = 0;
  for (const char* const name : {"ahead", "left", "behind", "right"}) {
    const double wanted_m = walls.value(name, nearest(seen, bearing_deg));
    EXPECT_NEAR(nearest(seen, bearing_deg), wanted_m, 0.02) << name;
    bearing_deg += 90;
  }
  if (want.contains("none")) {
    check_directions(want["none"][0], want["none"][1], want.contains("outside"), seen);
  } else {
    EXPECT_GT(seen.hits.size(), 100U);
  }
  if (want.contains("between")) {
    for (const hit& each : seen.hits) {
      ASSERT_GE(each.range_m, want["between"][0].get<double>() - 1e-4);
      ASSERT_LE(each.range_m, want["between"][1].get<double>() + 1e-4);
    }
  }
  if (!want.contains("intensity") || seen.hits.empty()) return;
  const unsigned most = want["intensity"];  // 0: it measures none
  const auto greatest = std::ranges::max(seen.hits, {}, &hit::intensity).intensity;
  EXPECT_LE(greatest, most);
  EXPECT_GE(greatest, (most + 1) / 4);
}

/// Whether this came out.
inline void check(const json& of, const std::string& door, const outcome& seen) {
  if (of.contains("error")) {
    const json& want = of["error"];
    const std::string problem = want[0];
    EXPECT_TRUE(seen.error == problem ||
                seen.error == std::to_string(table().at("exit_codes").at(problem).get<int>()))
        << seen.error << ": " << seen.words;
    for (std::size_t i = 1; i < want.size(); ++i)
      EXPECT_NE(seen.words.find(want[i].get<std::string>()), std::string::npos) << seen.words;
    return;
  }
  ASSERT_EQ(seen.error, "") << seen.words;
  const json& want = of.at("expect");
  check_one(want, "model", door, seen.model,
            [&](auto& is) { EXPECT_EQ(is, want["model"].get<std::string>()); });
  check_one(want, "samples", door, seen.samples, [&](double is) {
    EXPECT_NEAR(is, want["samples"], 0.01 * want["samples"].get<double>() + 2);
  });
  check_one(want, "frequency", door, seen.frequency_hz, [&](double is) {
    EXPECT_NEAR(is, want["frequency"], 0.01 * want["frequency"].get<double>());
  });
  for (const auto& [name, found] :
       {std::pair{"shortest_m", seen.shortest_m}, std::pair{"longest_m", seen.longest_m}}) {
    check_one(want, name, door, found, [&](double is) { EXPECT_NEAR(is, want[name], 1e-5); });
  }
  check_hits(want, seen);
}

}  // namespace cases
