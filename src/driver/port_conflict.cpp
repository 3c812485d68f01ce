// SPDX-License-Identifier: MIT
// A lock stops processes that open the port later and respect locks. A process that opened it
// before, and processes of root, can still read the bytes of the device: usually half of each
// answer.
#include "port_conflict.hpp"

#include <termios.h>

#include <new>
#include <string>

#include "core/one_of.hpp"
#include "transport/custom_baud.hpp"
#include "transport/port_holder.hpp"
#include "transport/system_calls.hpp"

namespace g4lidar {
namespace {

bool can_come_of_a_port_conflict(problem what) noexcept {
  using enum problem;
  return is_one_of(what, silence, garbage, does_not_stop, timeout, wrong_answer, stalled, brown_out,
                   interference);
}

/// No permission is needed for this, so it also detects processes of root.
bool has_other_settings(const transport& port) noexcept {
  termios now{};
  if (port.native_handle() < 0 || ::tcgetattr(port.native_handle(), &now) != 0) return false;
  if ((now.c_lflag & (ICANON | ECHO)) != 0 || (now.c_iflag & IXON) != 0) return true;
  const std::uint32_t baud = custom_baud(real_system_calls().ioctl, port.native_handle());
  return baud != 0 && !is_near(baud, port.baud());
}

error looked_into(const error& why, const transport& port) {
  const std::string path(port.name());
  if (const std::string program = port_conflict(path); !program.empty()) {
    return {why.doing(), problem::interference, path + ", also used by " + program};
  }
  if (has_other_settings(port)) {
    return {why.doing(), problem::interference, path + ", whose settings were changed"};
  }
  return why;
}

}  // namespace

error with_port_conflict(const error& why, const transport& port) noexcept {
  if (!can_come_of_a_port_conflict(why.code()) || !port.name().starts_with('/')) return why;
  try {
    return looked_into(why, port);
  } catch (const std::bad_alloc&) {
    return why;
  }
}

}  // namespace g4lidar
