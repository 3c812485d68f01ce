// SPDX-License-Identifier: MIT
#include "settings.hpp"

#include <algorithm>

#include "g4lidar/core/session/model_requests.hpp"

namespace g4lidar::python {
namespace {

while_scanning allowed(bool interrupt) {
  return interrupt ? while_scanning::stop_and_resume : while_scanning::refuse;
}

const model& model_of(live_lidar& on) {
  return *on.look([](lidar& device) { return candidates_of(device).front(); });
}

}  // namespace

void set(live_lidar& on, const wanted_settings& wanted, bool interrupt) {
  const model& which = model_of(on);
  const auto is_refused = [&](const answer& value) {
    const request change = change_to(value);
    return !has_request(which, change.what) || !is_possible(change, which);
  };
  std::vector<answer> all = wanted.values();
  std::ranges::stable_partition(all, is_refused);  // first, so that nothing is sent
  for (const answer& value : all) {
    on.run([&](lidar& device) { return device.ask(change_to(value), allowed(interrupt)); });
  }
}

nb::dict settings(live_lidar& on, bool interrupt) {
  const model& which = model_of(on);
  nb::dict all;
  const auto add = [&]<class Answer>(const char* name, const request_for<Answer>& query,
                                     request_kind change, auto in_python) {
    all[name] = nb::none();
    if (!has_request(which, query.what)) return;
    const auto ask = [&](lidar& device) -> result<std::optional<Answer>> {
      const auto given = device.ask(query, allowed(interrupt));
      if (given) return *given;
      // Not every TG answers the query of the sample rate, which cannot be set.
      if (given.error() == problem::timeout && !has_request(which, change)) return std::nullopt;
      return tl::unexpected(given.error());
    };
    if (const auto found = on.run(ask)) all[name] = in_python(*found);
  };
  add("frequency_hz", requests::get_scan_frequency(), request_kind::set_scan_frequency,
      [](scan_frequency is) { return is.hz(); });
  add("sample_rate_hz", requests::get_sample_rate(), request_kind::set_sample_rate,
      [](sample_rate is) { return to_hz(is); });
  add("direction", requests::get_direction(), request_kind::set_direction,
      [](motor_direction is) { return nb::cast(is); });
  add("idle", requests::get_low_power(), request_kind::set_low_power,
      [](low_power is) { return is == low_power::on; });
  return all;
}

}  // namespace g4lidar::python
