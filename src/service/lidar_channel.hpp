// SPDX-License-Identifier: MIT
// A lidar of a service: its reader, its diagnosis, its settings, and the shaping of its scans.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/background_reader.hpp"
#include "g4lidar/diagnostics/running_diagnosis.hpp"
#include "g4lidar/lidar_service.hpp"
#include "g4lidar/motion/odometry_feed.hpp"
#include "g4lidar/options/lidar_parameters.hpp"
#include "g4lidar/scan_shaper.hpp"

namespace g4lidar {

class service_core;

class lidar_channel final : private reader_listener {
 public:
  /// Loads the odometry of a recording, if it is needed. `core` outlives it.
  lidar_channel(service_lidar lidar, std::size_t index, service_core& core);

  [[nodiscard]] background_reader& reader() noexcept { return reader_; }
  [[nodiscard]] const background_reader& reader() const noexcept { return reader_; }
  [[nodiscard]] const service_lidar& about() const noexcept { return about_; }
  [[nodiscard]] const running_diagnosis& diagnosis() const noexcept { return diagnosis_; }
  [[nodiscard]] const lidar_parameters& settings() const noexcept { return settings_; }
  [[nodiscard]] const g4lidar::model* model() const noexcept { return model_; }
  [[nodiscard]] bool is_file() const noexcept { return is_file_; }
  /// Not at the end of a file, nor where it was cancelled.
  [[nodiscard]] bool is_failure(const error& why) const noexcept;
  [[nodiscard]] bool has_odometry() const noexcept { return has_odometry_; }
  /// Makes settings, and from now on each time when it is opened: why not, or empty. `then` is called when they are made;
  /// if it gives a reason, they are undone, as far as their earlier values are known. In its thread.
  [[nodiscard]] std::string set(lidar* device, const std::vector<named_value>& wanted,
                                const std::function<std::string()>& then);
  /// See service_scan. In its thread.
  [[nodiscard]] std::optional<std::int64_t> ahead_ns() const;

 private:
  void on_open(lidar& device) override;
  void on_scan(const scan& found) override;
  void on_points(std::span<const point> found) override;
  void on_event(const lidar_event& what) override;
  void on_state(reader_state state, const std::optional<error>& why) override;

  [[nodiscard]] lidar_options observed_options();
  void follow_motion(std::span<const point> points);
  void show_model(const g4lidar::model& now);
  void want(const named_value& setting);

  const service_lidar about_;
  const std::size_t index_;
  service_core& core_;
  const bool is_file_;
  odometry_feed feed_;
  bool has_odometry_ = false;
  running_diagnosis diagnosis_;
  const sim::simulated_source* simulation_ = nullptr;
  lidar_parameters settings_;
  std::vector<named_value> wanted_;  // the settings, in the thread
  std::atomic<const g4lidar::model*> model_ = nullptr;
  background_reader reader_;  // its thread ends first
};

}  // namespace g4lidar
