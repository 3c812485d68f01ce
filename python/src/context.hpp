// SPDX-License-Identifier: MIT
// The statement "with" of Python.
#pragma once

#include <nanobind/nanobind.h>

namespace g4lidar::python {

namespace nb = nanobind;

/// Makes `made` usable in a `with`, at whose end `end` is called. `signature`: that of __enter__, valid forever.
template <class Class, class End>
void bind_context(nb::class_<Class>& made, const char* signature, End end) {
  made.def(
          "__enter__", [](nb::handle self) { return nb::borrow(self); }, nb::sig(signature))
      .def(
          "__exit__", [end](Class& of, const nb::args&) { (of.*end)(); },
          nb::sig("def __exit__(self, *args: object) -> None"));
}

}  // namespace g4lidar::python
