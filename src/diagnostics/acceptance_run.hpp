// SPDX-License-Identifier: MIT
// The steps of an acceptance run. Commands are sent as they are, and replies kept as bytes: the session
// would hide what is to be found out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "g4lidar/diagnostics/acceptance.hpp"
#include "g4lidar/transport/connector.hpp"
#include "link_monitor.hpp"
#include "stream_survey.hpp"

namespace g4lidar {

/// The bytes that came after a command.
struct raw_reply {
  std::vector<std::uint8_t> data{};
  std::int64_t first_ns = -1;  ///< From the command to its first byte; -1: nothing came.
  std::int64_t begin = -1;     ///< The place of a response in `data`; -1: there is none.

  [[nodiscard]] bool is_response() const noexcept { return begin >= 0; }
  /// The content of the response.
  [[nodiscard]] bytes content() const noexcept;
  /// The content as a number, little-endian, of 1 or 4 bytes.
  [[nodiscard]] std::optional<std::int32_t> number() const noexcept;
  /// "a55a0100000004 02", at most 32 bytes.
  [[nodiscard]] std::string text() const;
};

/// One run. *Single thread.*
class acceptance_run {
 public:
  acceptance_run(connector& from, const acceptance_options& options)
      : from_(from), options_(options), which_(*options.model) {}

  [[nodiscard]] std::vector<acceptance_result> run();

 private:
  [[nodiscard]] bool open();
  void take(acceptance_result& into);
  [[nodiscard]] bool is_possible(acceptance_step step, std::string& why_not) const;

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
  void stream(acceptance_result& into);
  void sample_bits(acceptance_result& into) const;
  void ct_information(acceptance_result& into) const;
  void time_packets(acceptance_result& into) const;
  void target(acceptance_result& into, acceptance_action where);
  void unplug(acceptance_result& into);

  // What the steps are made of.
  [[nodiscard]] raw_reply ask(std::uint8_t code, std::int64_t patience_ns = 400 * ms);
  void send(std::uint8_t code);
  /// Waits for a packet; how long it took, or -1.
  [[nodiscard]] std::int64_t wait_for_packet(std::int64_t patience_ns);
  /// Waits until nothing has arrived for 150 ms; when the last byte came after now, or -1.
  [[nodiscard]] std::int64_t wait_for_silence(std::int64_t patience_ns);
  /// Starts the motor, in the way of the model. How long the first packet took, or -1.
  std::int64_t start();
  void stop();
  [[nodiscard]] std::uint32_t baud() const noexcept {
    return options_.baud != 0 ? options_.baud : which_.bauds[0];
  }
  [[nodiscard]] bool is_two_way() const noexcept { return which_.link == link_kind::two_way; }
  /// Sets the line; false if there is none.
  bool set_dtr(bool high);
  /// A scan of this length.
  [[nodiscard]] stream_survey survey(std::int64_t time_ns);
  /// Changes the frequency by `code` until it does not change any more; the last reply.
  [[nodiscard]] std::optional<std::int32_t> go_to_limit(std::uint8_t code);

  connector& from_;
  const acceptance_options& options_;
  const model& which_;
  std::optional<link_monitor> link_;
  std::optional<error> open_error_;
  std::vector<acceptance_result> results_;
  std::optional<stream_survey> surveyed_;
  std::optional<std::size_t> target_degree_;
  std::vector<std::uint8_t> identified_;  // the content of the answer to 90
};

}  // namespace g4lidar
