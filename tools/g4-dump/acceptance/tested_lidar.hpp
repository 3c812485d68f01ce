// SPDX-License-Identifier: MIT
// The lidar of a run, and what is known of it so far.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/settings.hpp"
#include "kept_settings.hpp"
#include "kit.hpp"
#include "link.hpp"
#include "survey.hpp"

namespace g4_tool::acceptance {

/// *Single thread.*
class tested_lidar {
 public:
  tested_lidar(connector& connects, const run_options& wanted);

  /// Opens the connection.
  [[nodiscard]] result<void> open();
  /// Closes it, and opens it again, with attempts for so long.
  [[nodiscard]] bool reopen(std::int64_t wait_ns, bool may_be_cancelled = true);
  /// Where nothing valid comes at the rate of the model: the rate at which a lidar is found, which is used from now on
  /// and stated in `result`. False if there is none, or the user has given the rate.
  bool find_baud(step_result& result);
  /// The device has sent this: with old firmware it differs from its model.
  void identify(const device_information& information);
  /// Reads samples as the bytes show them, if some devices of the model have such.
  void adapt_layout();
  /// Whether the lidar of this connection is the one of the beginning; another one has settings of its own.
  [[nodiscard]] bool is_same();

  [[nodiscard]] bool is_two_way() const noexcept { return row.link == link_kind::two_way; }
  /// The number of a fact of this step, or else of the last step that has it.
  [[nodiscard]] std::optional<double> number(const step_result& now, std::string_view fact) const;

  connector& from;
  const run_options& options;
  model row;                           ///< What it is compared with.
  std::unique_ptr<lidar_link> link{};  ///< Null: there is no connection.
  kept_settings settings{};
  std::vector<step_result> results{};
  std::unique_ptr<packet_survey> surveyed{};  ///< Null: there was no stream.
  std::optional<std::size_t> target_degree{};
  std::vector<std::uint8_t> identified{};   ///< The content of the answer to 90.
  std::optional<double> zero_offset_deg{};  ///< Of the answer to 93.
  std::optional<error> why_closed{};        ///< Why there is no connection.
  bool boots_after_dtr = false;             ///< It sent a boot message when DTR rose.

 private:
  std::uint32_t baud_;
};

/// Sets the device information that the content of an answer to 90 contains; nothing if it contains none.
[[nodiscard]] std::optional<device_information> information_in(bytes content) noexcept;

}  // namespace g4_tool::acceptance
