// SPDX-License-Identifier: MIT
// Signals end a waiting call: while a call of the main thread waits, the signals that Python handles also wake the
// lidar. The handlers of Python are called in every case.
#pragma once

#include <array>
#include <csignal>

#include "g4lidar/lidar.hpp"

namespace g4lidar::python {

/// While this exists, SIGINT, SIGTERM and SIGALRM wake `waiting`, if Python has a handler for them. Does nothing in
/// threads other than the main thread: Python calls its handlers there.
class interruption {
 public:
  explicit interruption(lidar& waiting) noexcept;
  interruption(const interruption&) = delete;
  interruption& operator=(const interruption&) = delete;
  ~interruption();

  /// Asks Python for its main thread. Needs the GIL.
  static void import();

 private:
  static constexpr std::array signals{SIGINT, SIGTERM, SIGALRM};
  std::array<bool, signals.size()> replaced_{};
  lidar* before_ = nullptr;
};

/// A thread that is made while this exists gets no signals: they are those of the other threads.
class without_signals {
 public:
  without_signals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  without_signals(const without_signals&) = delete;
  without_signals& operator=(const without_signals&) = delete;
  ~without_signals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_{};
};

/// For reading_options::is_cancelled, where the GIL is held: calls the handlers of signals that came; true if one
/// raised. Then value_of() raises the same.
[[nodiscard]] bool handler_raises();

}  // namespace g4lidar::python
