// SPDX-License-Identifier: MIT
// The valid options of a device.
#include "sim/exact.hpp"

#include "g4lidar/sim/device_options.hpp"

#include <algorithm>

namespace g4lidar::sim {
namespace {

bool is_duration(std::int64_t ns) noexcept { return ns >= 0 && ns <= 60'000'000'000; }

}  // namespace

std::string_view problem_with(const device_options& options) noexcept {
  if (const std::string_view problem = problem_with(options.scanner); !problem.empty()) {
    return problem;
  }
  const auto& serial = options.info.serial_digits;
  if (!std::all_of(serial.begin(), serial.end(), [](char c) { return c >= '0' && c <= '9'; })) {
    return "the serial number must be 16 decimal digits";
  }
  if (options.baud < 1'200 || options.baud > 10'000'000) {
    return "the baud rate must be 1200 to 10000000";
  }
  if (!is_duration(options.batch_min_ns) || !is_duration(options.batch_max_ns) ||
      options.batch_min_ns > options.batch_max_ns || options.batch_max_ns > 1'000'000'000) {
    return "bytes must wait in the bridge for 0 to 1 s, the least first";
  }
  if (!is_duration(options.reaction_ns) || !is_duration(options.standstill_ns) ||
      !is_duration(options.boot_ns) || !is_duration(options.first_answer_ns) ||
      !is_duration(options.header_ns) || !is_duration(options.silence_ns) ||
      !is_duration(options.stop_ns) || !is_duration(options.dtr_low_ns)) {
    return "reaction, standstill, boot, first answer, scan header, silence, stop and a low DTR "
           "must take "
           "0 to 60 s";
  }
  if (options.acceleration_mhz_per_s < 1 || options.acceleration_mhz_per_s > 100'000'000) {
    return "the motor must gain 0.001 to 100000 Hz a second";
  }
  if (options.highest_frequency_chz < options.scanner.scan_frequency_chz ||
      options.highest_frequency_chz > options.scanner.format.max_frequency_chz) {
    return "the highest scan frequency must be from the device's own to that of the model";
  }
  if (options.motor_drift_ppm > 100'000 || options.free_motor_drift_ppm > 100'000) {
    return "the motor must drift by at most a tenth";
  }
  if (options.motor_drift_period_ns < 1'000'000 ||
      options.motor_drift_period_ns > 1'000'000'000'000) {
    return "the motor must drift within 1 ms to 1000 s";
  }
  if (options.time_packet_ns != 0 &&
      (options.time_packet_ns < 1'000'000 || !is_duration(options.time_packet_ns))) {
    return "time packets must come every 1 ms to 60 s, or never (0)";
  }
  if (options.zero_angle_cdeg < -36'000 || options.zero_angle_cdeg > 36'000) {
    return "the direction of zero must be -360 to 360 degrees";
  }
  return {};
}

}  // namespace g4lidar::sim
