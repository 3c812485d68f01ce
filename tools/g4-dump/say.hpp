// SPDX-License-Identifier: MIT
// Words for people, on standard error.
#pragma once

#include <unistd.h>

#include <string_view>

namespace g4_dump {

/// Writes to standard error in one go. That nobody can hear it is no reason to stop.
inline void say(std::string_view words) noexcept {
  while (!words.empty()) {
    const ssize_t count = ::write(2, words.data(), words.size());
    if (count <= 0) return;
    words.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace g4_dump
