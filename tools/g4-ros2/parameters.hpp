// SPDX-License-Identifier: MIT
// The parameters of a lidar in ROS 2: settings of the device, filters, and what cannot change while it runs.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "cli/common_options.hpp"
#include "cli/settings.hpp"
#include "g4lidar/export/mask.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4_tool {

/// The index is the type in rcl_interfaces/ParameterType. Nothing: not known yet.
using parameter_value = std::variant<std::monostate, bool, std::int64_t, double, std::string>;
using named_value = std::pair<std::string, parameter_value>;

enum class parameter_kind : unsigned char { device, filter, read_only };

struct parameter {
  std::string_view name;
  std::uint8_t type;  ///< The index in parameter_value.
  parameter_kind kind;
  std::string description;  ///< With its unit.
  std::string constraints;
  std::array<double, 3> range{};          ///< From, to, step; all 0: none.
  const setting_info* setting = nullptr;  ///< Of a device.
};

/// All of them, sorted by their names.
[[nodiscard]] std::span<const parameter> all_parameters();
/// Null if there is none.
[[nodiscard]] const parameter* find_parameter(std::string_view name);

/// The values for one lidar.
class lidar_parameters {
 public:
  /// `how`: the filters at the start; `words`: some of them as text. `shaper` shapes by them, for messages of this
  /// lidar or for merging, and outlives this. Throws a failure for a mask that cannot be read.
  lidar_parameters(const common_options& how, const std::map<std::string, std::string>& words,
                   bool merges, scan_shaper& shaper);

  /// The filters now. Only in the thread of the reader.
  [[nodiscard]] const common_options& filters() const noexcept { return how_; }

  /// What cannot change.
  void fix(std::string_view name, parameter_value value);
  /// Asks the device for its settings, before a scan. Only in the thread of the reader.
  void read_device(g4lidar::lidar& device);
  /// Sets all of them, or none: why not, or empty. `device`: null while there is none. Blocks as lidar::ask(). Only in
  /// the thread of the reader.
  [[nodiscard]] std::string change(g4lidar::lidar* device, std::span<const named_value> wanted);
  /// *Any thread.*
  [[nodiscard]] parameter_value value(const parameter& of) const;

 private:
  using device_change = std::pair<const parameter*, setting_change>;
  [[nodiscard]] std::string set_device(g4lidar::lidar* device,
                                       std::span<const device_change> changes);
  void keep(std::string_view name, parameter_value value);

  void shape_by(const common_options& how);

  common_options how_;
  bool merges_;
  g4lidar::mask mask_;
  scan_shaper& shaper_;
  mutable std::mutex mutex_;
  std::map<std::string, parameter_value, std::less<>> values_;
};

}  // namespace g4_tool
