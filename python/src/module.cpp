// SPDX-License-Identifier: MIT
// The Python module g4lidar._g4lidar; g4lidar/__init__.py makes its names public.
#include <nanobind/nanobind.h>

#include "live_lidar.hpp"
#include "simulator.hpp"

extern const char* const build_version;

namespace g4lidar::python {

void bind_decode(nb::module_& module);
void bind_doctor(nb::module_& module);
void bind_recording(nb::module_& module);

namespace {

/// The arrays, the signals and the list of open lidars belong to one interpreter.
void refuse_subinterpreter() {
  if (PyInterpreterState_GetID(PyInterpreterState_Get()) == 0) return;
  PyErr_SetString(PyExc_ImportError, "g4lidar works in the main interpreter only");
  throw nb::python_error();
}

}  // namespace
}  // namespace g4lidar::python

NB_MODULE(_g4lidar, module) {
  using namespace g4lidar::python;
  refuse_subinterpreter();
  interruption::import();
  nanobind::set_leak_warnings(
      false);  // of objects that exist at the end of a program: nothing is printed
  module.doc() = "The compiled part of g4lidar.";
  module.attr("_version") = build_version;
  bind_arrays(module);
  bind_errors(module);
  bind_scan(module);
  bind_shaping(module);
  bind_filters(module);
  bind_decode(module);
  bind_recording(module);
  bind_simulator(module);
  bind_lidar(module);
  bind_opening(module);
  bind_doctor(module);
}
