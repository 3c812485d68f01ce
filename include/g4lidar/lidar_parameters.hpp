// SPDX-License-Identifier: MIT
// The parameters of a lidar by their names, for nodes and servers: settings of the device, filters, and what cannot
// change while it runs.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/export/mask.hpp"
#include "g4lidar/filter_text.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "g4lidar/setting_table.hpp"

namespace g4lidar {

/// The index is the type in rcl_interfaces/ParameterType. Nothing: not known yet.
using parameter_value = std::variant<std::monostate, bool, std::int64_t, double, std::string>;
/// A parameter by its name.
using named_value = std::pair<std::string, parameter_value>;

/// What a parameter changes.
enum class parameter_kind : std::uint8_t {
  device,     ///< A setting of the device, made while it scans.
  filter,     ///< What is published of the next scans.
  read_only,  ///< Nothing: it cannot change while the program runs.
};

/// A row of the table.
struct parameter {
  std::string_view name;                  ///< "frequency".
  std::uint8_t type;                      ///< The index in parameter_value.
  parameter_kind kind;                    ///< What it changes.
  std::string description;                ///< With its unit.
  std::string constraints;                ///< The values, where they are not a range.
  std::array<double, 3> range{};          ///< From, to, step; all 0: none.
  const setting_info* setting = nullptr;  ///< Of a device.
};

/// All of them, sorted by their names. Valid forever.
[[nodiscard]] G4LIDAR_API std::span<const parameter> all_parameters();
/// Null if there is none.
[[nodiscard]] G4LIDAR_API const parameter* find_parameter(std::string_view name);
/// The row for a lidar of this model: its values or limits instead of those of all models. `constraints` states
/// where the model does not have the setting.
[[nodiscard]] G4LIDAR_API parameter limited_to(const model& which, const parameter& of);
/// The value as one of a type, the index in parameter_value, as people write it: 10 or "10" for 10.0, "on" or "true" for
/// true, true or "true" for "on", an infinite number for "inf". Nothing if it is none. *Allocates.*
[[nodiscard]] G4LIDAR_API parameter_value converted(const parameter_value& from, std::uint8_t type);
/// The value of a setting as the device gave it; nothing for an answer that is of none.
[[nodiscard]] G4LIDAR_API parameter_value value_of(const answer& given);
/// The value that a setting is to have; errors as those of value_in().
[[nodiscard]] G4LIDAR_API result<answer> answer_of(const setting_info& of,
                                                   const parameter_value& wanted,
                                                   const model* which = nullptr);

/// The values of one lidar. Functions without another word: only in the thread that reads it.
class G4LIDAR_API lidar_parameters {
 public:
  /// `how`: what no parameter changes; its filter and its marks are those of `start`, and its masks those of `mask`.
  /// `shaper` shapes by them, and outlives this.
  lidar_parameters(const shaping_options& how, filter_settings start, g4lidar::mask mask,
                   scan_shaper& shaper);

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
  /// The row of this lidar: limited_to() its model, as soon as that is known. *Any thread.*
  [[nodiscard]] parameter row(const parameter& of) const;

 private:
  using device_change = std::pair<const parameter*, answer>;
  [[nodiscard]] std::string set_device(lidar* device, std::span<const device_change> changes);
  void shape();
  [[nodiscard]] const model* known_model() const;

  shaping_options how_;
  g4lidar::mask mask_;
  scan_shaper& shaper_;
  mutable std::mutex mutex_;  // protects the next two; the thread reads the first one without
  filter_settings now_;
  std::map<std::string, parameter_value, std::less<>> values_;
};

}  // namespace g4lidar
