// SPDX-License-Identifier: MIT
// The bytes of a live device: when they are read, which of them make points, and the session.
#pragma once

#include <atomic>
#include <cstdint>

#include "driver/point_pipeline.hpp"
#include "driver/receiver.hpp"
#include "driver/spin_up.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/recording/contents.hpp"
#include "link/connection.hpp"
#include "link/device_link.hpp"
#include "link/identity_reader.hpp"
#include "live_stage.hpp"
#include "survey/change_signs.hpp"
#include "survey/unrecognised_bytes.hpp"

namespace g4lidar {

/// The parts of a round on an open connection. *Single thread.* What it is made of must outlive it. The
/// session of a one-way lidar has nothing to do: the stage alone decides whether it scans.
class live_stream {
 public:
  struct parts {
    g4lidar::connection& connection;
    point_pipeline& pipeline;
    g4lidar::receiver& receiver;
    spin_up& motor;
    const live_stage& stage;
    const std::atomic<bool>& takes_points;  ///< See scan_source::take_points().
  };

  live_stream(const parts& used, const lidar_options& options);

  [[nodiscard]] session& talk() noexcept { return link_.talk(); }
  [[nodiscard]] const session& talk() const noexcept { return link_.talk(); }

  /// What the device has reported unasked.
  [[nodiscard]] identity_reader& reported() noexcept { return reported_; }
  /// What was received and sent since the connection was opened; a request begins by clearing it.
  [[nodiscard]] unrecognised_bytes& heard() noexcept { return heard_; }
  /// Whether the bridge has negotiated as telnet does, when the connection began.
  [[nodiscard]] bool speaks_telnet() const noexcept {
    return changes_.change() == stream_change::telnet;
  }

  /// The connection was opened.
  void begin();
  /// Sends the commands of the session.
  [[nodiscard]] result<void> send();
  /// Passes the time to the session, when it is due. Bytes that arrived while the program was
  /// suspended are processed before that.
  [[nodiscard]] result<void> look_if_due();
  /// One read, which waits for bytes until the deadline. A packet that does not continue is cut off.
  [[nodiscard]] result<void> receive(std::int64_t deadline_ns);
  /// Parses until there is a scan (true), or until nothing is left.
  [[nodiscard]] bool parse();
  /// Nothing follows: the held bytes are parsed again.
  void cut();
  /// Decodes the received bytes. Scans that are completed here are not taken.
  void flush();

  /// Packets of a device that is being stopped are discarded. A scan that continues after any
  /// interruption begins a new stream of points.
  void follow_delivery();
  /// The motor is started, or was interrupted: the points that follow are a new stream.
  void begin_points();
  /// The device is one like `model`, and goes on. Only if everything that was received is parsed.
  void become(const model& model);
  /// For a recording: what happens here.
  void record(recorded_event::kind what);
  /// Uses the sample rate, if it is the answer.
  void learn(const answer& heard);

  /// Sets the line DTR where it drives the motor, which starts at an edge to high. Without a connection, and with
  /// lidar_options::leave_dtr, nothing happens.
  [[nodiscard]] result<void> set_motor(bool on);
  /// When the line has been low for long enough, so that the motor may be started.
  [[nodiscard]] std::int64_t motor_ready_ns() const noexcept { return motor_ready_ns_; }

  /// Whether packets of a wanted scan come, or are resumed.
  [[nodiscard]] bool is_scanning() const noexcept {
    return parts_.stage == live_stage::scanning && (link_.listens() || talk().is_scanning());
  }

  /// When something is due, if nothing arrives.
  [[nodiscard]] std::int64_t next_deadline_ns() const noexcept;
  /// The time until which bytes need not be read.
  [[nodiscard]] std::int64_t rest_until_ns() const noexcept;

  /// `why`, or a process on the port that explains more than its effects.
  [[nodiscard]] error error_after(const error& why) const;

 private:
  [[nodiscard]] std::int64_t now_ns() const noexcept { return parts_.connection.now_ns(); }
  [[nodiscard]] reading how_to_read() const noexcept;

  parts parts_;
  read_pace pace_;
  device_link link_;
  motor_kind motor_;
  bool leaves_dtr_;
  identity_reader reported_;
  unrecognised_bytes heard_;
  change_signs changes_;  // of what came before the device was identified
  std::uint32_t sample_rate_hz_;
  std::int64_t motor_ready_ns_ = 0;
  bool is_line_high_ = false;  // DTR, as far as it is known
};

}  // namespace g4lidar
