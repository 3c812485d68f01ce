// SPDX-License-Identifier: MIT
#include "gil.hpp"

#include <nanobind/nanobind.h>
#include <unistd.h>

#include <chrono>

namespace g4lidar::python {
namespace {

/// Keeps a thread that is ended while this exists.
class last_place {
 public:
  last_place() = default;
  last_place(const last_place&) = delete;
  last_place& operator=(const last_place&) = delete;
  ~last_place() {
    while (may_end_) ::pause();
  }
  void leave() noexcept { may_end_ = false; }

 private:
  volatile bool may_end_ = true;
};

/// Not inline: callers that do not throw would end the program instead of destroying the last_place.
[[gnu::noinline]] void take_back(PyThreadState* state) {
  last_place here;
  PyEval_RestoreThread(state);
  here.leave();
}

[[gnu::noinline]] PyGILState_STATE take() {
  last_place here;
  const PyGILState_STATE state = PyGILState_Ensure();
  here.leave();
  return state;
}

}  // namespace

without_gil::~without_gil() { take_back(state_); }

with_gil::with_gil() : state_(take()) {}

std::unique_lock<std::timed_mutex> lock_of(std::timed_mutex& mutex,
                                           const std::function<void()>& again) {
  std::unique_lock held(mutex, std::try_to_lock);
  while (!held) {
    if (again) again();
    {
      const without_gil free;
      static_cast<void>(held.try_lock_for(std::chrono::milliseconds(50)));
    }
    if (!held && PyErr_CheckSignals() != 0) throw nanobind::python_error();
  }
  return held;
}

}  // namespace g4lidar::python
