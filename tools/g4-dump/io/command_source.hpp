// SPDX-License-Identifier: MIT
// The common parts of the verbs that send commands to a device.
#pragma once

#include <nlohmann/json.hpp>

#include "cli/common_options.hpp"
#include "cli/exit_code.hpp"
#include "cli/verbs.hpp"
#include "io/source_word.hpp"

namespace g4_tool {

class output;

/// Throws a failure if the source is a file, which cannot answer.
void refuse_files(const common_options& options, g4lidar::task doing);
/// The same if the user wants the device to be listened to only.
void refuse_listening(const common_options& options);

/// A device that is opened for commands, which stops it. Logs whether the device was scanning. (Discovery by serial
/// number or among several devices has stopped it before.)
class command_source {
 public:
  /// `doing`: the task in the error for a file. Throws a failure.
  command_source(const common_options& options, g4lidar::task doing);

  [[nodiscard]] g4lidar::lidar& lidar() noexcept { return source_.lidar(); }
  /// The models between which the bytes of the device do not decide, that as which it is read first.
  [[nodiscard]] std::span<const g4lidar::model* const> candidates() noexcept {
    return lidar().recognition().candidates;
  }
  /// Whether the device was scanning.
  [[nodiscard]] bool was_scanning() const noexcept { return was_scanning_; }

 private:
  bool was_scanning_ = false;
  opened_source source_;
};

/// `made` with SOURCE and the options of the device; with --json and --output where `has_output`.
[[nodiscard]] verb device_verb(verb made, exit_code (*run)(const common_options&),
                               bool has_output = false);

/// Writes an object as a line of JSON or as lines "name  value" with `width` columns for the name. In
/// these null is "unknown", and an object in the object, such as "skipped", gives lines "skipped_noise".
void write_object(output& out, const nlohmann::ordered_json& value, std::size_t width,
                  bool as_json);

}  // namespace g4_tool
