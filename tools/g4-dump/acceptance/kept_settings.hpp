// SPDX-License-Identifier: MIT
// The settings of a lidar as they were before the first step that changes one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "link.hpp"

namespace g4_tool::acceptance {

/// What a step changes, and what is to be set back behind it.
enum class setting : std::uint8_t { none, frequency, sample_rate, protection };

/// *Single thread.* A setting that could not be read is not known, and is not to be changed; but the protection can
/// only be switched, and its answer shows what it was.
class kept_settings {
 public:
  using value = std::optional<std::int32_t>;  // as the lidar answers it: 0.01 Hz, a code, 1 for off

  /// Reads the settings that the model has: once, before the first change.
  void remember(lidar_link& link, const model& model);
  [[nodiscard]] const value& before(setting setting) const { return at(setting).before; }
  /// A command that changes it is sent next.
  void begin_change(setting setting) { at(setting).is_changed = true; }
  /// D0 or D9 was answered with this number the first time, and shows what was set before. `values`: how many
  /// there are.
  void learn_from(setting setting, std::int32_t first_answer, std::int32_t values);
  /// Its command was not answered, and has changed nothing.
  void has_none(setting setting);
  [[nodiscard]] bool is_changed() const;

  /// Sets everything back that was changed, with retries. Returns whether it is as before. The lidar is idle.
  [[nodiscard]] bool restore(lidar_link& link);
  /// What is not as before, in the words of `g4-dump set`: "frequency=10 sample_rate=9000".
  [[nodiscard]] std::string words(const model& model) const;

 private:
  struct kept {
    value before{};
    bool is_changed = false;
  };
  [[nodiscard]] const kept& at(setting setting) const {
    return all_.at(static_cast<std::size_t>(setting));
  }
  [[nodiscard]] kept& at(setting setting) { return all_.at(static_cast<std::size_t>(setting)); }

  bool is_remembered_ = false;
  std::array<kept, 4> all_{};
};

}  // namespace g4_tool::acceptance
