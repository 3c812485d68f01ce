// SPDX-License-Identifier: MIT
// Sends all queries several times, and collects statistics of the replies.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "link_monitor.hpp"

namespace g4lidar {

/// What is known about a device.
struct device_snapshot {
  std::optional<device_information> information{};
  std::optional<health> condition{};
  std::optional<scan_frequency> frequency{};      ///< As set; without the offset of replies.
  std::optional<std::uint32_t> sample_rate_hz{};  ///< As set.
  std::optional<zero_angle> zero{};               ///< The offset of zero.

  /// The information or the health, if the reply contains it.
  void take(const response_view& reply);
  /// The frequency, the sample rate or the offset of zero, if this is the reply of a lidar like `model` to such a command.
  void take_setting(command asked, const response_view& reply, const model& model);
};

/// All commands that were sent. Those that were disturbed by packets, a boot or a pause of the host
/// are not counted.
class reply_statistics {
 public:
  void add(exchange made) { made_.push_back(std::move(made)); }
  [[nodiscard]] const std::vector<exchange>& exchanges() const noexcept { return made_; }
  [[nodiscard]] std::ptrdiff_t answered() const noexcept;
  /// From most of its replies, which are those of a lidar like `model`.
  [[nodiscard]] device_snapshot snapshot(const model& model) const;
  /// Adds diagnoses and numbers. If the host paused, a few late replies are its own.
  void judge(stage_report& report, bool host_paused, const model& model) const;
  /// Whether a query that each lidar like `model` answers was never answered, and others were.
  [[nodiscard]] bool has_mute_question(const model& model) const;
  /// The lidar is of another model than the one whose queries it got: what it never answers, it does not know.
  void may_know_less() noexcept { knows_less_ = true; }
  /// There were replies, and later none.
  [[nodiscard]] bool has_died(const model& model) const;
  /// So many replies were wrong that further commands are useless.
  [[nodiscard]] bool is_clear(const model& model) const;

 private:
  struct tally {
    unsigned late = 0;
    unsigned very_late = 0;
    unsigned wrong = 0;
    unsigned twice = 0;
    unsigned missing = 0;
    unsigned damaged = 0;
    unsigned missing_at_end = 0;  // consecutive, for any command
    unsigned missing_before = 0;  // the missing ones before these
  };
  [[nodiscard]] tally count(const model& model) const;
  /// A query that firmware, or a lidar whose number is not that of `model`, need not support, and without any reply.
  [[nodiscard]] bool is_unknown(command code, const model& model) const;
  /// Whether the command 93 was not answered with an angle.
  [[nodiscard]] bool lacks_zero(const model& model) const;
  /// Differs from the most frequent reply to the same command.
  [[nodiscard]] bool is_odd(const exchange& one) const;
  /// The most frequent reply; empty if there is none.
  [[nodiscard]] bytes usual(command code) const;

  std::vector<exchange> made_;
  bool knows_less_ = false;
};

/// Sends all queries that `model` has, in rounds, and adds the replies. `first_latency_ns`: that of an
/// earlier reply.
void ask_all(link_monitor& link, reply_statistics& replies, const model& model,
             std::int64_t first_latency_ns);

}  // namespace g4lidar
