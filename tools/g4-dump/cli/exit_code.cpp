// SPDX-License-Identifier: MIT
#include "exit_code.hpp"

namespace g4_dump {

exit_code exit_code_for(const g4lidar::error& why, bool was_running) noexcept {
  using enum g4lidar::problem;
  switch (why.code()) {
    case bad_option:
    case bad_setting:
    case scanning:
    case not_scanning:
      return exit_code::usage;
    case no_port:
    case several_ports:
    case not_serial:
    case cannot_connect:
      return exit_code::no_device;
    case permission:
      return exit_code::permission;
    case busy:
    case interference:
      return exit_code::busy;
    case silence:
    case garbage:
    case bad_baud_rate:
    case timeout:
    case wrong_answer:
      return was_running ? exit_code::lost : exit_code::silent;
    case other_device:
      return exit_code::not_a_g4;
    case unhealthy:
    case does_not_stop:
    case not_reached:
    case brown_out:
      return exit_code::unhealthy;
    case gone:
    case reconnecting:
    case stalled:
      return exit_code::lost;
    case read_only:
    case end_of_input:
    case g4lidar::problem::bad_file:
      return exit_code::bad_file;
    case cancelled:
    case system:
      break;
  }
  return was_running ? exit_code::lost : exit_code::bad_file;
}

}  // namespace g4_dump
