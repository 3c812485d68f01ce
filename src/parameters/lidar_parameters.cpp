// SPDX-License-Identifier: MIT
#include "g4lidar/options/lidar_parameters.hpp"

#include <algorithm>
#include <vector>

#include "options/option_access.hpp"

namespace g4lidar {

lidar_parameters::lidar_parameters(filter_settings start) : now_(std::move(start)) {
  const point_filter& filter = now_.filter;
  now_.grid.longest_mm = filter.greatest_range_mm;
  fix("range_min", static_cast<double>(filter.least_range_mm) / 1e3);
  fix("range_max", std::min(static_cast<double>(filter.greatest_range_mm) / 1e3, 100.0));
}

filter_settings lidar_parameters::current_filters() const {
  const std::lock_guard lock(mutex_);
  return now_;
}

void lidar_parameters::fix(std::string_view name, parameter_value value) {
  const std::lock_guard lock(mutex_);
  values_.insert_or_assign(std::string(name), std::move(value));
}

parameter_value lidar_parameters::value(const parameter& of) const {
  const std::lock_guard lock(mutex_);
  const auto at = values_.find(of.name);
  return at == values_.end() ? parameter_value() : at->second;
}

const model* lidar_parameters::known_model() const {
  const parameter_value known = value(*find_parameter("model"));
  const auto* const word = std::get_if<std::string>(&known);
  return word != nullptr ? model_named(*word) : nullptr;
}

parameter_limits lidar_parameters::limits(const parameter& of) const {
  return limits_of(of, known_model());
}

void lidar_parameters::read_device(lidar& device) {
  for (const parameter& each : all_parameters()) {
    if (each.setting == nullptr || !each.setting->query) continue;
    const auto given = device.ask(*each.setting->query);
    if (given)
      fix(each.name, value_of(*given));
    else if (given.error().is_fatal())
      return;  // the next read of the lidar finds it
  }
}

std::string lidar_parameters::set_device(lidar* device, std::span<const device_change> changes) {
  if (!changes.empty() && device == nullptr) return "the lidar is not connected";
  std::vector<std::pair<const parameter*, parameter_value>> before;
  for (const auto& [known, wanted] : changes) {
    const auto given = device->ask(change_to(wanted), while_scanning::stop_and_resume);
    if (given) {
      before.emplace_back(known, value(*known));
      fix(known->name, value_of(*given));
      continue;
    }
    for (const auto& [earlier, old] : before) {
      const auto back = answer_of(*earlier->setting, old);
      if (!back) continue;  // was not known
      if (device->ask(change_to(*back), while_scanning::stop_and_resume)) fix(earlier->name, old);
    }
    return given.error().message();
  }
  return {};
}

std::string lidar_parameters::change(lidar* device, std::span<const named_value> wanted) {
  std::vector<std::pair<std::string_view, parameter_value>> values;  // of the filters
  std::vector<device_change> changes;
  filter_settings next = now_;
  for (const auto& [name, given] : wanted) {
    const parameter* const known = find_parameter(name);
    if (known == nullptr) return "there is no such parameter";
    if (known->kind != parameter_kind::filter && known->setting == nullptr)
      return std::string(known->name) + ": it cannot change while the program runs";
    const auto value = value_for(*known, given);
    if (!value) return value.error();
    if (known->setting != nullptr) {
      const auto change = answer_of(*known->setting, *value, known_model());
      if (!change) return std::string(change.error().subject());
      changes.emplace_back(known, *change);
    } else {
      const std::string wrong = set_filter(next, known->name, word_of(*value));
      if (!wrong.empty()) return std::string(known->name) + ": " + wrong;
      values.emplace_back(known->name, *value);
    }
  }
  if (next.filter.greatest_range_mm < next.filter.least_range_mm)
    return "range_min, range_max: the range ends before it begins";
  if (std::string reason = set_device(device, changes); !reason.empty()) return reason;
  if (values.empty()) return {};
  {
    const std::lock_guard lock(mutex_);
    now_ = std::move(next);
    now_.grid.longest_mm = now_.filter.greatest_range_mm;
  }
  for (const auto& [name, value] : values) fix(name, value);
  return {};
}

}  // namespace g4lidar
