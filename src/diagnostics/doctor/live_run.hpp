// SPDX-License-Identifier: MIT
// The stages of a device, with an open transport and its clock. Queries, a start and stops are
// sent: no setting is changed, and the motor is stopped at the end.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "diagnostics/link_monitor.hpp"
#include "diagnostics/reply_statistics.hpp"
#include "diagnostics/stages.hpp"
#include "diagnostics/stream_statistics.hpp"
#include "first_contact.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// One run. *Single thread.*
class live_run {
 public:
  /// Reports the stages from baud_rate on to `log`, which must outlive this. `may_pulse_dtr`: as in
  /// search_options.
  live_run(std::unique_ptr<transport> opened, stage_log& log, bool may_pulse_dtr);
  live_run(const live_run&) = delete;
  live_run& operator=(const live_run&) = delete;
  ~live_run() = default;

  void run();

 private:
  enum class scan_state : std::uint8_t {
    runs,
    silent,  ///< No more bytes arrive.
    over,    ///< The connection or the run has ended.
  };
  /// The state of a device whose scan has become silent.
  enum class fate : std::uint8_t { resumed, booted, answers, dead, over };
  /// Since the last start command.
  struct start_record {
    std::int64_t sent_ns = 0;
    std::int64_t kept_alive_ns = 0;  // the last start command, as keep-alive
    std::uint64_t boots_before = 0;
    std::int64_t first_packet_ns = 0;
    bool has_header = false;
    bool has_introduced_itself = false;  // without a query
    bool is_spinning_up = false;         // this was reported as an activity
  };

  /// The stage baud_rate; `answers` where nothing arrives. Returns whether there is a device to continue with.
  bool find_device();
  /// Whether commands are sent to the lidar.
  [[nodiscard]] bool talks() const noexcept {
    return !log_.options().listen_only && !lidar_.is_one_way();
  }
  /// The stages answers, identity, health.
  bool interview();
  /// The stage motor. Returns whether the scan runs.
  bool start_motor();
  void measure_scan();
  void report_stream();

  /// Starts it until its packets show the size of its samples.
  void see_samples();
  /// What CT bytes state about a lidar that answers nothing.
  void read_information();
  /// The motor of a lidar that answered to the start has never turned.
  [[nodiscard]] diagnosis of_never_started() const noexcept;
  /// Stops the scan and the motor, as far as that is possible. False: it continues.
  bool end();
  void start_scan();
  /// Waits until the head has its speed, or will not reach it.
  [[nodiscard]] scan_state warm_up(stream_statistics& measured);
  [[nodiscard]] scan_state listen_once(stream_statistics& measured);
  [[nodiscard]] bool is_of_other_size() const;
  bool follow_samples();
  /// How long the scan may be silent at this time.
  [[nodiscard]] std::int64_t patience_ns() const;
  void follow(const observed_event& observed);
  [[nodiscard]] fate fate_of_silent();
  /// The scan became silent during the measurement. Returns whether it continues.
  bool revive(std::int64_t& until_ns);
  bool restart_scan(std::int64_t& until_ns);
  /// The scan was silent for a while and continued.
  void find_stall();
  /// Whether this program was suspended since the start.
  [[nodiscard]] bool is_host_busy() const noexcept;
  /// Adds the error that ended the connection, if there is one.
  void add_failure(stage_report& report);

  stage_log& log_;
  examined_lidar lidar_;
  link_monitor link_;
  reply_statistics replies_;
  device_snapshot device_;
  stream_statistics measured_;
  stage_report answer_{.stage = diagnostic_stage::answers};
  stage_report stream_{.stage = diagnostic_stage::stream};
  start_record started_;
  bool keeps_alive_ = false;  // with keep-alives, because the protection is on
  first_contact contact_;
  std::int64_t measured_ns_ = 0;
  std::int64_t gap_ns_ = 0;          // for which a scan was silent, the last time
  std::int64_t longest_gap_ns_ = 0;  // of those that are not of the host
  unsigned restarts_ = 0;
  bool has_motor_line_ = false;  // DTR
  std::string reading_;          // as what, where the samples decided it
};

}  // namespace g4lidar
