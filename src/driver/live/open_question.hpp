// SPDX-License-Identifier: MIT
// The request of an ask() of the caller, and its outcome.
#pragma once

#include <optional>
#include <variant>

#include "g4lidar/core/request.hpp"

namespace g4lidar {

/// *Single thread, never allocates.* A request that was woken continues without its caller, who may
/// ask the same again and then waits for the same outcome.
class open_question {
 public:
  /// The caller waits for the outcome of this request.
  void begin(const request& wanted) noexcept { state_ = waiting{wanted}; }
  /// Its outcome. It is dropped if no caller waits.
  void answer(const outcome& done) noexcept {
    if (is_waiting()) state_ = done;
  }
  /// The caller was woken and does not wait any more.
  void leave() noexcept {
    if (const auto* const asked = std::get_if<waiting>(&state_)) state_ = woken{asked->what};
  }
  /// A request that was woken is not continued.
  void forget_woken() noexcept {
    if (std::get_if<woken>(&state_) != nullptr) state_ = std::monostate();
  }
  /// Ends the question; returns its outcome, if there is one.
  [[nodiscard]] std::optional<outcome> end() noexcept {
    const auto* const done = std::get_if<outcome>(&state_);
    std::optional<outcome> found;
    if (done != nullptr) found = *done;
    state_ = std::monostate();
    return found;
  }

  /// Whether a caller waits.
  [[nodiscard]] bool is_waiting() const noexcept {
    return std::get_if<waiting>(&state_) != nullptr;
  }
  /// Whether a caller waits, or has not taken the outcome.
  [[nodiscard]] bool is_open() const noexcept {
    return is_waiting() || std::get_if<outcome>(&state_) != nullptr;
  }
  /// Whether this request was woken, and may still be in progress.
  [[nodiscard]] bool was_woken(const request& wanted) const noexcept {
    const auto* const asked = std::get_if<woken>(&state_);
    return asked != nullptr && asked->what == wanted;
  }

 private:
  struct waiting {
    request what;
  };
  struct woken {
    request what;
  };
  std::variant<std::monostate, waiting, woken, outcome> state_;
};

}  // namespace g4lidar
