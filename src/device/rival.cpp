// SPDX-License-Identifier: MIT
// A lock keeps out those who come later and respect it. Who came before, and the programs of root,
// may still read what the device sends: half of each answer, most often.
#include "rival.hpp"

#include <termios.h>

#include <new>
#include <string>

#include "custom_baud.hpp"
#include "port_holder.hpp"
#include "system_calls.hpp"

namespace g4lidar {
namespace {

bool can_come_of_rivals(problem what) noexcept {
  switch (what) {
    case problem::silence:
    case problem::garbage:
    case problem::does_not_stop:
    case problem::timeout:
    case problem::wrong_answer:
    case problem::stalled:
    case problem::brown_out:
    case problem::interference:
      return true;
    default:
      return false;
  }
}

/// Nobody needs leave to see this: not even root's programs can hide it.
bool has_other_settings(const transport& line) noexcept {
  termios now{};
  if (line.native_handle() < 0 || ::tcgetattr(line.native_handle(), &now) != 0) return false;
  if ((now.c_lflag & (ICANON | ECHO)) != 0 || (now.c_iflag & IXON) != 0) return true;
  const std::uint32_t baud = custom_baud(real_system_calls().ioctl, line.native_handle());
  return baud != 0 && !is_near(baud, line.baud());
}

error looked_into(const error& why, const transport& line) {
  const std::string path(line.name());
  if (const std::string rival = port_rival(path); !rival.empty()) {
    return {why.doing(), problem::interference, path + ", also used by " + rival};
  }
  if (has_other_settings(line)) {
    return {why.doing(), problem::interference, path + ", whose settings were changed"};
  }
  return why;
}

}  // namespace

error with_rivals(const error& why, const transport& line) noexcept {
  if (!can_come_of_rivals(why.what()) || !line.name().starts_with('/')) return why;
  try {
    return looked_into(why, line);
  } catch (const std::bad_alloc&) {
    return why;
  }
}

}  // namespace g4lidar
