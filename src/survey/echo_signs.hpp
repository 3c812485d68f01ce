// SPDX-License-Identifier: MIT
// Signs that what was sent comes back: from a loop-back, or from a console.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/command.hpp"
#include "text_signs.hpp"

namespace g4lidar {

/// Who sends back what was sent.
enum class echo_kind : std::uint8_t {
  none,
  loop_back,  ///< Nothing else arrives: the wires of both directions are connected.
  console,    ///< Text arrives, too: a program that waits for words echoes them.
};

/// *Single thread, never allocates.*
class echo_signs {
 public:
  void sent(bytes command) noexcept {
    if (command.size() > awaited_.size() - size_) size_ = 0;
    for (const std::uint8_t byte : command.first(std::min(command.size(), awaited_.size())))
      awaited_[size_++] = byte;
  }
  void received(bytes data) noexcept {
    for (const std::uint8_t byte : data) {
      if (is_echo(byte)) {
        ++echoed_;
      } else {
        ++(is_of_text(byte) ? text_ : others_);
      }
      last_ = byte;
    }
  }

  [[nodiscard]] echo_kind kind() const noexcept {
    constexpr std::uint64_t two_commands = 4;
    if (echoed_ < two_commands || others_ > 0) return echo_kind::none;
    return text_ == 0 ? echo_kind::loop_back : echo_kind::console;
  }

 private:
  /// Whether this was sent next. Commands may be lost, at another rate; then this is the begin of one, or its second byte.
  [[nodiscard]] bool is_echo(std::uint8_t byte) noexcept {
    for (std::size_t at = 0; at < size_; ++at) {
      const bool follows = at == 0 || byte == command_start || awaited_[at - 1] == last_;
      if (awaited_[at] != byte || !follows) continue;
      std::copy(awaited_.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                awaited_.begin() + static_cast<std::ptrdiff_t>(size_), awaited_.begin());
      size_ -= at + 1;
      return true;
    }
    return false;
  }

  std::array<std::uint8_t, 64> awaited_{};
  std::size_t size_ = 0;
  std::uint8_t last_ = 0;
  std::uint64_t echoed_ = 0;
  std::uint64_t text_ = 0;
  std::uint64_t others_ = 0;
};

}  // namespace g4lidar
