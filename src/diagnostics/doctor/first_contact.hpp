// SPDX-License-Identifier: MIT
// The first bytes of a run: which lidar is attached, at which baud rate, and whether it answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "diagnostics/link_monitor.hpp"
#include "diagnostics/reply_statistics.hpp"
#include "diagnostics/stages.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/discovery.hpp"

namespace g4lidar {

/// The lidar of a run, as far as it is known.
struct examined_lidar {
  const model* which = &g4_model;
  bool is_named = false;                   ///< By the user: it is not replaced by another one.
  std::vector<const model*> candidates{};  ///< If it was recognised: all that send such bytes.
  bool was_scanning = false;               ///< Before the run; of a two-way lidar.
  bool is_deaf = false;                    ///< It scans and ignores commands.
  bool has_baud = false;                   ///< The connection has a rate.
  bool is_met = false;                     ///< It has answered, or sends packets.

  [[nodiscard]] bool is_one_way() const noexcept { return which->link == link_kind::one_way; }
  /// Whether a stop or a start may be sent: what is attached may be any device else.
  [[nodiscard]] bool takes_commands() const noexcept { return is_named || is_met; }
  [[nodiscard]] bool is_driven_by_dtr() const noexcept { return which->motor == motor_kind::dtr; }
};

/// *Single thread.*
class first_contact {
 public:
  enum class state : std::uint8_t {
    none,  ///< Nothing that makes sense has arrived.
    made,  ///< The run can go on.
    refused,  ///< Another lidar, or another baud rate, than was expected: the reports have the diagnosis.
  };
  /// What the run shares with this, and what must outlive this.
  struct parts {
    stage_log& log;
    link_monitor& link;
    reply_statistics& replies;
    examined_lidar& lidar;
    stage_report& answers;
  };

  /// `may_pulse_dtr`: as in search_options.
  first_contact(parts used, bool may_pulse_dtr) noexcept
      : of_(used), may_pulse_dtr_(may_pulse_dtr) {}

  /// Searches, and asks what was found. All queries are asked if the first is answered. `baud` is the stage baud_rate.
  [[nodiscard]] state make(stage_report& baud);
  /// Stops a scan. False if it does not stop.
  bool make_quiet();
  /// Adds to the stage answers that it was scanning, or does not listen.
  void report_scanning();

 private:
  [[nodiscard]] state unknown(stage_report& baud);
  [[nodiscard]] bool ask();
  void ask_the_rest(exchange last);
  [[nodiscard]] bool recognise(const exchange& first);
  [[nodiscard]] state search(stage_report& baud);
  [[nodiscard]] state judge_failure(const error& why, stage_report& baud);
  [[nodiscard]] bool may_be_named(const recognised_lidar& found) const;
  void wait_for_late_answers();
  /// The lidar that was found is not the one that was named.
  void contradict(stage_report& baud, const recognised_lidar& found);
  [[nodiscard]] bool is_expected_rate(std::uint32_t baud) const noexcept;
  [[nodiscard]] bool scans_when_started();

  parts of_;
  bool may_pulse_dtr_;
  std::int64_t asked_ns_ = -1;  // the first query without a reply
  std::string tried_;           // by the search, where something arrived: bytes and rates
  std::uint64_t garbage_ = 0;   // bytes, where no lidar was found
};

}  // namespace g4lidar
