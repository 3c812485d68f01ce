// SPDX-License-Identifier: MIT
#include "setting_keywords.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <map>
#include <variant>

#include "g4lidar/core/request.hpp"
#include "g4lidar/lidar_options.hpp"

namespace g4lidar::python {
namespace {

while_scanning allowed(bool interrupt) {
  return interrupt ? while_scanning::stop_and_resume : while_scanning::refuse;
}

const model& model_of(live_lidar& on) {
  return *on.look([](lidar& device) { return device.recognition().model; });
}

template <class Number>
void check(const setting_info& setting, Number wanted, int most) {
  if (wanted >= 0 && wanted <= most) return;
  raise(error(task::configuring, problem::bad_option,
              std::string(keyword_of(setting)) + ": 0 to " + std::to_string(most) + ", not " +
                  nb::repr(nb::cast(wanted)).c_str()));
}

struct as_python {
  nb::object operator()(sample_rate is) const { return nb::cast(to_hz(is)); }
  nb::object operator()(scan_frequency is) const { return nb::cast(is.hz()); }
  nb::object operator()(motor_direction is) const { return nb::cast(is); }
  template <class Other>
  nb::object operator()(const Other& is) const {
    return nb::cast(number_of(answer(is)) == 2);  // on
  }
};

}  // namespace

const char* keyword_of(const setting_info& which) {
  static std::map<const setting_info*, std::string> all;  // guarded by the GIL
  std::string& made = all[&which];
  if (!made.empty()) return made.c_str();
  made = which.name;
  if (!which.unit.empty()) made.append("_").append(which.unit);
  std::ranges::transform(made, made.begin(), [](unsigned char c) { return std::tolower(c); });
  return made.c_str();
}

answer value_for(const setting_info& setting, int wanted) {
  check(setting, wanted, UINT16_MAX);
  return sample_rate{static_cast<std::uint16_t>(wanted)};
}

answer value_for(const setting_info& setting, double wanted) {
  check(setting, wanted, UINT16_MAX / 100);
  return scan_frequency::hz(wanted);
}

zero_angle zero_angle_from(double deg, const model* model) {
  constexpr double beyond = 1000.0;
  const double limited = std::isnan(deg) ? beyond : std::clamp(deg, -beyond, beyond);
  lidar_options of;
  of.model = model != nullptr ? model : model_named("tg15");  // one that has it
  of.zero_angle = zero_angle{static_cast<std::int32_t>(std::lround(100.0 * limited))};
  if (const auto wrong = problem_with(of)) raise(*wrong);
  return *of.zero_angle;
}

void set(live_lidar& live, std::vector<answer> wanted, bool interrupt) {
  const model& which = model_of(live);
  const auto is_refused = [&](const answer& value) {
    const request change = change_to(value);
    return !has_request(which, change.what) || !is_possible(change, which);
  };
  std::ranges::stable_partition(wanted, is_refused);  // first, so that nothing is sent
  for (const answer& value : wanted) {
    live.run([&](lidar& device) { return device.ask(change_to(value), allowed(interrupt)); });
  }
}

nb::dict settings(live_lidar& live, bool interrupt) {
  const model& which = model_of(live);
  nb::dict all;
  for (const setting_info& each : all_settings()) {
    if (!each.query) continue;
    auto value = all[keyword_of(each)];
    value = nb::none();
    if (!has_request(which, each.query->what)) continue;
    const auto ask = [&](lidar& device) -> result<std::optional<answer>> {
      const auto given = device.ask(*each.query, allowed(interrupt));
      if (given) return *given;
      // Not every TG answers the query of the sample rate, which cannot be set.
      if (given.error() == problem::timeout && !has_request(which, each.change))
        return std::nullopt;
      return tl::unexpected(given.error());
    };
    if (const auto found = live.run(ask)) value = std::visit(as_python(), *found);
  }
  return all;
}

}  // namespace g4lidar::python
