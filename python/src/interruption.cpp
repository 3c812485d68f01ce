// SPDX-License-Identifier: MIT
#include "interruption.hpp"

#include <nanobind/nanobind.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstddef>

namespace g4lidar::python {
namespace {

pthread_t main_thread;
std::atomic<lidar*> waits{nullptr};
std::array<struct sigaction, 3> handlers_of_python;

extern "C" void wake_and_forward(int number, siginfo_t* info, void* context) {
  const int kept_errno = errno;
  if (lidar* const waiting = waits.load()) waiting->wake();
  const std::size_t i = number == SIGINT ? 0 : number == SIGTERM ? 1 : 2;
  const struct sigaction& python = handlers_of_python[i];
  if ((python.sa_flags & SA_SIGINFO) != 0) {
    python.sa_sigaction(number, info, context);
  } else {
    python.sa_handler(number);
  }
  errno = kept_errno;
}

bool is_handler(const struct sigaction& action) noexcept {
  return (action.sa_flags & SA_SIGINFO) != 0 ||
         (action.sa_handler != SIG_DFL && action.sa_handler != SIG_IGN);
}

bool is_ours(const struct sigaction& action) noexcept {
  return (action.sa_flags & SA_SIGINFO) != 0 && action.sa_sigaction == &wake_and_forward;
}

}  // namespace

void interruption::import() {
  const auto threading = nanobind::module_::import_("threading");
  main_thread = nanobind::cast<pthread_t>(threading.attr("main_thread")().attr("ident"));
  // In a child, the thread that called fork() is the main thread.
  static_cast<void>(::pthread_atfork(nullptr, nullptr, [] { main_thread = ::pthread_self(); }));
}

bool handler_raises() { return PyErr_CheckSignals() != 0; }

interruption::interruption(lidar& waiting) noexcept {
  if (pthread_equal(pthread_self(), main_thread) == 0) return;
  before_ = waits.exchange(&waiting);
  if (before_ != nullptr) return;  // within another call, whose handlers serve this one, too
  for (std::size_t i = 0; i < signals.size(); ++i) {
    struct sigaction& python = handlers_of_python[i];
    if (::sigaction(signals[i], nullptr, &python) != 0 || !is_handler(python)) continue;
    struct sigaction ours = python;
    ours.sa_flags |= SA_SIGINFO;
    ours.sa_sigaction = &wake_and_forward;
    replaced_[i] = ::sigaction(signals[i], &ours, nullptr) == 0;
  }
}

interruption::~interruption() {
  if (pthread_equal(pthread_self(), main_thread) == 0) return;
  waits.store(before_);
  for (std::size_t i = 0; i < signals.size(); ++i) {
    struct sigaction now{};
    if (!replaced_[i] || ::sigaction(signals[i], nullptr, &now) != 0) continue;
    // A handler in Python may have set another.
    if (is_ours(now)) ::sigaction(signals[i], &handlers_of_python[i], nullptr);
  }
}

}  // namespace g4lidar::python
