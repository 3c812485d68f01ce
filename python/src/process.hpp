// SPDX-License-Identifier: MIT
// What was made before fork() belongs to the parent process.
#pragma once

#include <nanobind/nanobind.h>
#include <unistd.h>

#include <memory>
#include <string>
#include <utility>

#include "gil.hpp"

namespace g4lidar::python {

/// The process in which this was made.
class process {
 public:
  [[nodiscard]] bool is_this_one() const noexcept { return id_ == ::getpid(); }
  /// Raises RuntimeError in a process made by fork(). `what`: "this lidar".
  void check(const char* what) const {
    if (is_this_one()) return;
    const std::string text =
        std::string(what) +
        " was opened before fork() and belongs to the parent process: open it in this process";
    PyErr_SetString(PyExc_RuntimeError, text.c_str());
    throw nanobind::python_error();
  }

 private:
  pid_t id_ = ::getpid();
};

/// A value that a process made by fork() neither uses nor destroys.
template <class Value>
class of_process {
 public:
  explicit of_process(Value&& made) : value_(std::make_unique<Value>(std::move(made))) {}
  of_process(const of_process&) = delete;
  of_process& operator=(const of_process&) = delete;
  ~of_process() {
    if (!maker_.is_this_one()) static_cast<void>(value_.release());
  }

  /// Raises RuntimeError in a process made by fork().
  [[nodiscard]] Value& get(const char* what) const {
    maker_.check(what);
    return *value_;
  }

 private:
  process maker_;
  std::unique_ptr<Value> value_;
};

}  // namespace g4lidar::python
