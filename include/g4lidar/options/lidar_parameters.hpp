// SPDX-License-Identifier: MIT
// The parameters of a lidar by their names, for nodes and servers: settings of the device, filters, and what cannot
// change while it runs.
#pragma once

#include <map>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/options/option_table.hpp"

namespace g4lidar {

/// The values of one lidar. Functions without another word: only in the thread that reads it.
class G4LIDAR_API lidar_parameters {
 public:
  /// With the filters `start`.
  explicit lidar_parameters(filter_settings start = {});

  /// The filters now.
  [[nodiscard]] const filter_settings& filters() const noexcept { return now_; }
  /// A copy of them. *Any thread.*
  [[nodiscard]] filter_settings current_filters() const;
  /// What cannot change, and what is known of the device. *Any thread.*
  void fix(std::string_view name, parameter_value value);
  /// Asks the device for its settings, before a scan.
  void read_device(lidar& device);
  /// Sets all of them, or none: why not, or empty. `device`: null while there is none, so that no setting can be made.
  /// Blocks as lidar::ask().
  [[nodiscard]] std::string change(lidar* device, std::span<const named_value> wanted);
  /// *Any thread.*
  [[nodiscard]] parameter_value value(const parameter& of) const;
  /// limits_of() this lidar: of its model, as soon as that is known. *Any thread.*
  [[nodiscard]] parameter_limits limits(const parameter& of) const;

 private:
  using device_change = std::pair<const parameter*, answer>;
  [[nodiscard]] std::string set_device(lidar* device, std::span<const device_change> changes);
  [[nodiscard]] const model* known_model() const;

  mutable std::mutex mutex_;  // protects the next two; the thread reads the first one without
  filter_settings now_;
  std::map<std::string, parameter_value, std::less<>> values_;
};

}  // namespace g4lidar
