// SPDX-License-Identifier: MIT
// The steps of an acceptance run.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acceptance_link.hpp"
#include "g4lidar/diagnostics/acceptance.hpp"
#include "g4lidar/transport/connector.hpp"

namespace g4lidar {

/// One run. *Single thread.*
class acceptance_run {
 public:
  acceptance_run(connector& from, const acceptance_options& options)
      : from_(from),
        options_(options),
        which_(options.model != nullptr ? options.model : &g4_model) {}

  [[nodiscard]] std::vector<acceptance_result> run();

 private:
  [[nodiscard]] bool open();
  /// Closes the connection, and opens it again, with attempts for so long.
  [[nodiscard]] bool reopen(std::int64_t wait_ns);
  [[nodiscard]] bool recognise(transport& port);
  void take(acceptance_result& into);
  [[nodiscard]] bool is_possible(acceptance_result& into) const;

  // The steps.
  void bridge(acceptance_result& into);
  void listening(acceptance_result& into);
  void identity(acceptance_result& into);
  void queries(acceptance_result& into);
  void protection(acceptance_result& into);
  void frequency(acceptance_result& into);
  void sample_rate(acceptance_result& into);
  void start_and_stop(acceptance_result& into);
  void dtr(acceptance_result& into);
  void dtr_start(acceptance_result& into);
  void stream(acceptance_result& into);
  void sample_bits(acceptance_result& into) const;
  void ct_information(acceptance_result& into) const;
  void time_packets(acceptance_result& into) const;
  void target(acceptance_result& into, acceptance_action where);
  void unplug(acceptance_result& into);

  [[nodiscard]] bool is_two_way() const noexcept { return which_->link == link_kind::two_way; }
  [[nodiscard]] std::uint32_t baud() const noexcept {
    if (options_.baud != 0) return options_.baud;
    return found_baud_ != 0 ? found_baud_ : which_->bauds[0];
  }

  connector& from_;
  const acceptance_options& options_;
  const model* which_;
  std::unique_ptr<acceptance_link> link_;  // null: there is no connection
  std::string why_closed_{};               // why there is no link
  std::uint32_t found_baud_ = 0;           // by the search
  std::vector<acceptance_result> results_;
  std::unique_ptr<stream_survey> surveyed_;  // null: there was no stream
  std::optional<std::size_t> target_degree_;
  std::vector<std::uint8_t> identified_;   // the content of the answer to 90
  std::optional<double> zero_offset_deg_;  // of the answer to 93
  std::optional<double> near_ratio_;       // measured range to placed distance
  bool dtr_drives_ = false;                // a low DTR stopped it
  bool boots_after_dtr_ = false;           // and when it rose, it booted
};

}  // namespace g4lidar
