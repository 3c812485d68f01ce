// SPDX-License-Identifier: MIT
#include "gil.hpp"

#include <nanobind/nanobind.h>

#include <chrono>

namespace g4lidar::python {

without_gil::~without_gil() {
  in_python([this] { PyEval_RestoreThread(state_); });
}

with_gil::with_gil() : state_(in_python(&PyGILState_Ensure)) {}

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
