// SPDX-License-Identifier: MIT
// The lock of the interpreter (GIL), also for threads that still run when the program ends.
#pragma once

#include <Python.h>
#include <unistd.h>

#include <exception>
#include <functional>
#include <mutex>

namespace g4lidar::python {

/// Calls what waits for the GIL, or runs code in Python, which gives it to others now and then. If the interpreter has
/// ended by then, Python ends the thread by unwinding it, which ends the program in functions of C++ that do not throw,
/// or catch all: the thread stays here instead. Not inline: else these callers end the program.
/// What nanobind calls while it converts arguments (`__float__`, `__getitem__`) is not covered.
template <class Call>
[[gnu::noinline]] decltype(auto) in_python(const Call& call) {
  try {
    return call();
  } catch (...) {
    if (std::current_exception()) throw;  // of C++
    while (true) ::pause();
  }
}

/// Releases the GIL while it exists. A thread that wants it back when the interpreter has ended waits for ever, as in
/// Python 3.14; earlier versions end the thread there, which ends the program, because of functions that do not throw.
class without_gil {
 public:
  without_gil() : state_(PyEval_SaveThread()) {}
  without_gil(const without_gil&) = delete;
  without_gil& operator=(const without_gil&) = delete;
  ~without_gil();

 private:
  PyThreadState* state_;
};

/// Takes the GIL while it exists, in a thread that may have released it; the same at the end of the program.
class with_gil {
 public:
  with_gil();
  with_gil(const with_gil&) = delete;
  with_gil& operator=(const with_gil&) = delete;
  ~with_gil() { PyGILState_Release(state_); }

 private:
  PyGILState_STATE state_;
};

/// Locks the mutex. Other threads run during the wait, and so do handlers of signals: raises what they raise. `again` is
/// called before each wait of 50 ms. Needs the GIL.
[[nodiscard]] std::unique_lock<std::timed_mutex> lock_of(std::timed_mutex& mutex,
                                                         const std::function<void()>& again = {});

}  // namespace g4lidar::python
