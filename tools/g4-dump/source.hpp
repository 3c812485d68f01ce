// SPDX-License-Identifier: MIT
// What the word SOURCE means, and the lidar behind it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common_options.hpp"
#include "g4lidar/connector.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/recording_reader.hpp"
#include "g4lidar/replay.hpp"

namespace g4_dump {

enum class source_kind : unsigned char {
  device,     ///< A port, a bridge, a number: what lidar_options::device names.
  recording,  ///< A file with times, which is a device too.
  bytes,      ///< Raw bytes without times, in a file or a pipe; `-`.
  simulated,  ///< `sim:`
};

/// By its form, and what lies there. A name that is none of a file is a device's.
[[nodiscard]] source_kind kind_of(const std::string& source);
/// Whether these are the first bytes of a recording.
[[nodiscard]] bool begins_as_recording(std::span<const std::uint8_t> bytes) noexcept;
/// The path of a source that is a file, without "file:".
[[nodiscard]] std::string path_of(const std::string& source);

/// Puts something between the lines and the driver, such as one that records.
using line_wrapper =
    std::function<std::unique_ptr<g4lidar::connector>(std::unique_ptr<g4lidar::connector>)>;

/// The device of `sim:...` on a pseudo-terminal, as long as somebody keeps it.
struct simulated_port {
  std::string path;
  std::shared_ptr<const void> kept;
};
/// Throws a failure, or bad_value.
[[nodiscard]] simulated_port serve_simulated(const std::string& source);

/// The same where that can fail.
using line_tap = std::function<g4lidar::result<std::unique_ptr<g4lidar::connector>>(
    std::unique_ptr<g4lidar::connector>)>;

/// How a source is opened.
struct opening {
  g4lidar::lidar_options how{};        ///< But for device, baud and reconnect.
  line_tap tap{};                      ///< Called at each attempt, where it is set.
  g4lidar::replay_options played{};    ///< Of a recording.
  std::uint32_t bytes_rate_hz = 9000;  ///< Samples a second of raw bytes in a file.
};

/// A lidar, and the simulated device that it is on, if it is on one.
class opened_source {
 public:
  /// Opens anything but raw bytes. `how` is as it is to be but for device, baud and reconnect. With
  /// loss_rule::wait it tries until there is one or a signal comes (`interrupted`). Throws a failure.
  explicit opened_source(const common_options& options, g4lidar::lidar_options how = {},
                         const line_wrapper& wrap = {});
  /// The same, and raw bytes too, see byte_line.hpp.
  opened_source(const common_options& options, const opening& wish);
  opened_source(const opened_source&) = delete;
  opened_source& operator=(const opened_source&) = delete;
  ~opened_source();

  [[nodiscard]] g4lidar::lidar& lidar() noexcept {
    return *lidar_;  // NOLINT(bugprone-unchecked-optional-access): made by the constructor
  }

  /// What is wrong with the recording that is played, as far as it was read; nothing of all else.
  [[nodiscard]] g4lidar::recording_damage damage() const {
    return played_ == nullptr ? g4lidar::recording_damage{} : played_->damage();
  }

 private:
  friend simulated_port serve_simulated(const std::string& source);
  class simulation;
  void open(const common_options& options, const opening& wish);

  std::unique_ptr<simulation> simulation_;             // outlives the lidar
  const g4lidar::recording_reader* played_ = nullptr;  // the lidar's
  std::optional<g4lidar::lidar> lidar_;
};

}  // namespace g4_dump
