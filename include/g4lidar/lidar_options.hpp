// SPDX-License-Identifier: MIT
// How a lidar is opened and used.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/recording/player.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

class connector;

/// When a running scan is read, and the program woken.
enum class read_pace : std::uint8_t {
  automatic,    ///< As `revolutions`, until next_points() or points() is called; then as `packets`.
  packets,      ///< When a packet is complete: points arrive with little latency.
  revolutions,  ///< When a revolution is complete: a fifth of the system calls. Scans are not later.
};

/// Times and speeds of a lidar's connection; few programs need another value.
struct lidar_tuning {
  std::chrono::milliseconds longest_backoff{
      1000};                                   ///< Between two attempts to reconnect; 1 ms to 1 s.
  std::chrono::milliseconds answer_time{300};  ///< The longest wait for an answer; 10 ms to 10 s.
  std::chrono::milliseconds stall_time{1000};  ///< A scan without a packet; 100 ms to 1 min.
  /// See read_pace. A transport that does not know how many bytes the system keeps is read by packets.
  read_pace pace = read_pace::automatic;
  /// Bytes are read no more often than this, for every `pace`: fewer wake-ups, more latency. 0 to
  /// 100 ms.
  std::chrono::milliseconds batch{0};
  /// The least delay between measurement and arrival, that of the baud rate excluded; see sensor_clock.
  std::chrono::nanoseconds transport_delay{0};
};

/// How a lidar is opened and used. Every option has a default. One that the source cannot use is refused:
/// problem_with_source(). A setting that is not given stays as the
/// device has it; one that is given is set at each start, after a reconnect, and when the device seems
/// to have rebooted.
struct lidar_options {
  /// Which lidar, in the words of transport/source.hpp: empty for the only lidar; `/dev/ttyUSB0`; `sim:`; ...
  std::string device{};
  /// How long open() waits for a device that is not there yet, or cannot be opened yet: after an error that may pass
  /// (error::may_pass()) it tries again twice a second. milliseconds::max(): without limit.
  std::chrono::milliseconds device_wait{0};
  /// Where `device` is no name of a port: whether ports without the USB bridge of a G4 are looked at, too, before and
  /// after a loss. See find_options::probe_all_ports: bytes are sent to whatever is attached there.
  bool probe_all_ports = false;
  /// What sends the bytes; valid as long as the lidar and its scans. Null: what a recording or `sim:`
  /// states, raw bytes show, or a search at the port finds; of a connector of the program a G4. A source that states
  /// another model is refused with bad_option: `sim:`; a recording whose samples have another size, or that is sure of its
  /// model. A device whose packets cannot be read so, or whose number,
  /// rate and size of samples all are those of another model, is refused with other_device; what else contradicts is in
  /// lidar::recognition().
  const g4lidar::model* model = nullptr;
  /// `model` is certain, whatever the lidar reports, or a recording states: without it, a named lidar is refused that
  /// reports the number of another model with samples of the same size, and a recording of such a model.
  bool insist_on_model = false;
  /// Not a byte is sent: for a data wire alone, or on the wire of a lidar that another computer drives. A lidar that
  /// waits for commands stays silent. Requests and settings are refused with not_supported. A lidar that sends whole
  /// packets and does not answer is read so anyhow.
  bool listen_only = false;
  /// The line DTR of the port is not set: a motor that it drives keeps its state, and nothing restarts a silent lidar.
  /// Linux itself raises the line for the first program that opens a port. Without this, DTR is raised for a lidar whose
  /// motor it drives, gets a pulse if the lidar is silent, and is lowered at the end.
  bool leave_dtr = false;
  /// Bits per second, of a serial port and of the one behind `tcp:`; 0: the usual rate of the model.
  std::uint32_t baud = 0;

  std::optional<g4lidar::sample_rate>
      sample_rate{};  ///< Measurements per second: one of those of the model.
  std::optional<scan_frequency> frequency{};     ///< Revolutions per second; a G4 has 5 to 12 Hz.
  std::optional<motor_direction> direction{};    ///< In which direction the head turns.
  std::optional<constant_frequency> constant{};  ///< Whether the lidar regulates its frequency.
  std::optional<low_power> idle{};               ///< Whether the motor stops when idle.
  std::optional<power_down_protection>
      protection{};  ///< Stops when the host sends nothing for 3 s.

  /// What is added to each angle, -360 to 360 degrees: instead of the answer to command 93, which is not asked. For raw
  /// bytes and recordings that do not have the answer, and for a lidar that does not give it. Refused with not_supported
  /// for a model without this command.
  std::optional<g4lidar::zero_angle> zero_angle{};

  bool reconnect = false;      ///< Whether to reconnect after a loss; see lidar::next_event().
  bool partial_scans = false;  ///< Whether try_scan() also gives pieces: scan::is_piece().
  lidar_tuning tuning{};       ///< Times and speeds of the connection.

  playback_options playback{};  ///< How a file is played.
  /// Samples per second of raw bytes, which contain no times; 1 to 1,000,000. The times of points are counted at this
  /// rate. If it is not given, those of a file are counted at first_rate_hz() of the model, and those of a pipe are
  /// estimated from when the bytes are read.
  std::optional<std::uint32_t> raw_sample_rate_hz{};
  /// For a pipe without `raw_sample_rate_hz`: times are counted at first_rate_hz() of the model.
  bool counts_times = false;
  /// Called with the connector of each attempt to open, if it is set: to record, to observe. What it
  /// returns is used instead; its error ends the attempt.
  std::function<result<std::unique_ptr<connector>>(std::unique_ptr<connector>)> wrap{};
  /// Called often while open() reads a file, and every 50 ms between two attempts to open, if it is set;
  /// true ends open() with cancelled. An attempt is not interrupted. Playing a file calls it, too.
  std::function<bool()> is_cancelled{};
};

/// The words of all models: "g4, g4-pro, ...". Allocates.
[[nodiscard]] G4LIDAR_API std::string model_words();
/// Why model_named() finds none: that the label is that of a product with another protocol, or which words there are.
/// Allocates.
[[nodiscard]] G4LIDAR_API std::string why_no_model(std::string_view label);
/// The words of these models: "x2, x2l". Allocates.
[[nodiscard]] G4LIDAR_API std::string model_words(std::span<const g4lidar::model* const> which);

/// What is wrong with `options`, as an error that names the option; nothing if all can be used. *Pure.*
[[nodiscard]] G4LIDAR_API std::optional<error> problem_with(const lidar_options& options) noexcept;

}  // namespace g4lidar
