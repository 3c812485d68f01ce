// SPDX-License-Identifier: MIT
#include "setup_sequence.hpp"

namespace g4lidar {

request request_of(setup_step step, const lidar_options& options) noexcept {
  const auto set = [](const auto& option, request otherwise) {
    return option ? requests::set(*option) : otherwise;
  };
  switch (step) {
    case setup_step::identify:
      return requests::device_info();
    case setup_step::stop:
      return requests::stop();
    case setup_step::health:
      return requests::health();
    case setup_step::ranging:
      return set(options.ranging, requests::get_ranging());
    case setup_step::frequency:
      return set(options.frequency, requests::get_scan_frequency());
    case setup_step::direction:
      return set(options.direction, requests::get_direction());
    case setup_step::constant:
      return set(options.constant, requests::health());
    case setup_step::idle:
      return set(options.idle, requests::get_low_power());
    case setup_step::protection:
      return set(options.protection, requests::health());
    case setup_step::start:
      break;
  }
  return requests::start();
}

}  // namespace g4lidar
