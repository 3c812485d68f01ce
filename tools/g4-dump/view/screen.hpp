// SPDX-License-Identifier: MIT
// The terminal as a screen, with ncurses.
#pragma once

#include "view/canvas.hpp"

namespace g4_tool {

/// Uses the terminal of standard input and output; one at a time. The destructor restores it, and so do signals
/// that end the program. ^Z restores it, and fg draws it again. Throws a failure if there is no terminal.
class screen {
 public:
  explicit screen(bool colored);
  screen(const screen&) = delete;
  screen& operator=(const screen&) = delete;
  ~screen();

  [[nodiscard]] int columns() const;
  [[nodiscard]] int rows() const;
  /// Writes the changes since the last call.
  void show(const canvas& picture);
  /// The next key that was pressed: a letter, or resized; 0 if there is none.
  [[nodiscard]] int key();
  static constexpr int resized = 1;
  /// Whether the terminal was closed.
  [[nodiscard]] bool is_gone() const;

  /// Whether the locale can show braille.
  [[nodiscard]] static bool has_utf8();
};

/// Blocks all signals in this thread, so that threads that it starts do not handle them.
class blocked_signals {
 public:
  blocked_signals();
  blocked_signals(const blocked_signals&) = delete;
  blocked_signals& operator=(const blocked_signals&) = delete;
  ~blocked_signals();
};

}  // namespace g4_tool
