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

/// Whether a console sends this beside text: a bell, a backspace, the begin of a colour.
[[nodiscard]] constexpr bool is_of_terminal(std::uint8_t byte) noexcept {
  return byte == 0x07 || byte == 0x08 || byte == 0x1B;
}

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
        ++now_.echoed;
      } else {
        ++(is_of_text(byte) || is_of_terminal(byte) ? now_.text : others_);
      }
      last_ = byte;
    }
  }

  /// Bytes of another baud rate follow. A rate at which other bytes came, too, shows nothing: they may have been garbled.
  void tune() noexcept {
    if (others_ == 0) {
      earlier_.echoed += now_.echoed;
      earlier_.text += now_.text;
    }
    now_ = {};
    others_ = size_ = 0;
  }

  [[nodiscard]] echo_kind kind() const noexcept {
    constexpr std::uint64_t two_commands = 4;
    if (earlier_.echoed + now_.echoed < two_commands || others_ > 0) return echo_kind::none;
    return earlier_.text + now_.text == 0 ? echo_kind::loop_back : echo_kind::console;
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
  struct counts {
    std::uint64_t echoed = 0;
    std::uint64_t text = 0;
  };
  counts earlier_;  // at other rates
  counts now_;
  std::size_t others_ = 0;
};

}  // namespace g4lidar
