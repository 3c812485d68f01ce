// SPDX-License-Identifier: MIT
// What the word SOURCE means, and the lidar behind it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "cli/common_options.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/replay.hpp"
#include "g4lidar/sim/odometry.hpp"
#include "g4lidar/sim/setup.hpp"
#include "g4lidar/transport/connector.hpp"

namespace g4_tool {

class output;

enum class source_kind : unsigned char {
  device,     ///< A port, a bridge, a number: what lidar_options::device names.
  recording,  ///< A file with times, which is a device too.
  bytes,      ///< Raw bytes without times, in a file or a pipe; `-`.
  simulated,  ///< `sim:`
};

/// By its form, and what lies there. A name that is none of a file is a device's.
[[nodiscard]] source_kind kind_of(const std::string& source);
/// The path of a source that is a file, without "file:".
[[nodiscard]] std::string path_of(const std::string& source);

/// The world and the path that a setup names, or the built-in rooms; not in the file that `out` writes.
/// Throws a failure.
[[nodiscard]] sim::world load_scene(const sim::setup& setup, const output* out = nullptr);

using simulated_port = std::shared_ptr<const sim::background_pty>;
/// The way of a simulated robot, without errors.
struct simulated_robot {
  sim::odometry way;
  std::int64_t begin_ns;  ///< Its time 0, by the clock of the transport.
};
/// The device of `sim:...`, and the robot that carries it if it has a path. Throws a failure, or
/// bad_value.
[[nodiscard]] simulated_port serve_simulated(const std::string& source,
                                             std::optional<simulated_robot>* robot = nullptr);

/// Puts something between the driver and the connections, such as one that records.
using connector_tap = std::function<result<std::unique_ptr<connector>>(std::unique_ptr<connector>)>;
/// The same for each connection.
using transport_tap = std::function<std::unique_ptr<transport>(std::unique_ptr<transport>)>;

/// How a source is opened.
struct opening {
  lidar_options how{};                 ///< But for device, baud and reconnect.
  connector_tap tap{};                 ///< Called at each attempt, where it is set.
  transport_tap each{};                ///< Called for each connection, where it is set.
  replay_options played{};             ///< Of a recording.
  std::uint32_t bytes_rate_hz = 9000;  ///< Samples a second of raw bytes in a file.
};

/// A lidar, and the simulated device that it is on, if it is on one.
class opened_source {
 public:
  /// With loss_rule::wait it tries until there is one or a signal comes (`interrupted`). Throws a
  /// failure.
  explicit opened_source(const common_options& options, const opening& wish = {});
  opened_source(const opened_source&) = delete;
  opened_source& operator=(const opened_source&) = delete;
  ~opened_source() = default;

  [[nodiscard]] g4lidar::lidar& lidar() noexcept {
    return *lidar_;  // NOLINT(bugprone-unchecked-optional-access): made by the constructor
  }

  /// The simulated robot that carries the lidar; null if there is none, or if it has no path.
  [[nodiscard]] simulated_robot* robot() noexcept { return robot_ ? &*robot_ : nullptr; }

  /// The reader of the recording that is played; null for every other source.
  [[nodiscard]] const g4lidar::recording_reader* recording() const noexcept { return played_; }
  /// What is wrong with the recording that is played, as far as it was read; nothing of all else.
  [[nodiscard]] g4lidar::recording_damage damage() const {
    return played_ == nullptr ? g4lidar::recording_damage{} : played_->damage();
  }

 private:
  simulated_port simulation_;  // outlives the lidar
  std::optional<simulated_robot> robot_;
  const g4lidar::recording_reader* played_ = nullptr;  // the lidar's
  std::optional<g4lidar::lidar> lidar_;
};

}  // namespace g4_tool
