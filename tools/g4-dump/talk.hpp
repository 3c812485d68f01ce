// SPDX-License-Identifier: MIT
// What the verbs that ask or tell a device have in common.
#pragma once

#include <nlohmann/json.hpp>

#include "common_options.hpp"
#include "g4lidar/error.hpp"
#include "source.hpp"
#include "verb.hpp"

namespace g4_dump {

class output;

/// Throws a failure where the source is a file, which nobody answers from.
void refuse_files(const common_options& options, g4lidar::task doing);

/// Listens for a moment whether it scans, and opens it, which stops it; that it did scan is told.
/// (A lidar that had to be looked for, by its number or among several, was stopped by that already.)
class talking_source {
 public:
  /// `doing` is what a file is refused with. Throws a failure.
  talking_source(const common_options& options, g4lidar::task doing);

  [[nodiscard]] g4lidar::lidar& lidar() noexcept { return source_.lidar(); }
  /// Whether it had to be stopped first.
  [[nodiscard]] bool was_scanning() const noexcept { return was_scanning_; }

 private:
  bool was_scanning_ = false;
  opened_source source_;
};

/// --json, into `flag`.
[[nodiscard]] option_row json_row(std::shared_ptr<bool> flag);

/// One line of JSON; what is no UTF-8 is replaced.
void write_line(output& out, const nlohmann::ordered_json& value);

/// The exit codes that every verb on a device can have.
[[nodiscard]] std::vector<int> talk_exits();

}  // namespace g4_dump
