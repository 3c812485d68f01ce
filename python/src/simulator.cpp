// SPDX-License-Identifier: MIT
#include "simulator.hpp"
#include "context.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>

#include "errors.hpp"
#include "gil.hpp"

namespace g4lidar::python {
namespace {

using namespace nb::literals;

sim::world load_scene(const sim::setup& setup) {
  auto read = sim::load_world(setup.world_file);
  const auto refuse = [](const std::string& file, const sim::world_error& why) {
    raise_bad_option(file + ", line " + std::to_string(why.line) + ": " + why.message);
  };
  if (const auto* why = std::get_if<sim::world_error>(&read)) refuse(setup.world_file, *why);
  auto scene = std::get<sim::world>(std::move(read));
  if (setup.path_file.empty()) return scene;
  if (const auto why = sim::load_path(scene, setup.path_file)) refuse(setup.path_file, *why);
  return scene;
}

/// The options of the measurement, which a text does not contain.
constexpr std::array<std::pair<std::string_view, double sim::scanner_options::*>, 8> measurement{
    {{"noise_mm", &sim::scanner_options::noise_mm},
     {"noise_ratio", &sim::scanner_options::noise_ratio},
     {"dropout_ratio", &sim::scanner_options::dropout_ratio},
     {"min_range_mm", &sim::scanner_options::min_range_mm},
     {"max_range_mm", &sim::scanner_options::max_range_mm},
     {"index_deg", &sim::scanner_options::index_deg},
     {"sample_rate_ratio", &sim::scanner_options::sample_rate_ratio},
     {"sample_rate_drift_ppm", &sim::scanner_options::sample_rate_drift_ppm}}};

void add(sim::setup& setup, const std::string& name, nb::handle value) {
  for (const auto& [known, member] : measurement) {
    if (name != known) continue;
    setup.device.scanner.*member = nb::cast<double>(value);
    return;
  }
  const bool is_bool = PyBool_Check(value.ptr()) != 0;
  const std::string text =
      is_bool ? (nb::cast<bool>(value) ? "true" : "false") : nb::str(value).c_str();
  const std::string wrong = sim::set(setup, name + "=" + text);
  if (!wrong.empty()) raise_bad_option(name + ": " + wrong);
}

void make_simulator(simulator* made, const std::vector<std::string>& faults, bool virtual_time,
                    const nb::kwargs& options) {
  sim::setup setup;
  in_python([&] {  // values may be objects with functions in Python
    for (const std::string& each : faults) add(setup, "fault", nb::str(each.c_str()));
    for (const auto& [name, value] : options) add(setup, nb::cast<std::string>(name), value);
  });
  if (const auto wrong = sim::problem_with(setup.device); !wrong.empty())
    raise_bad_option(std::string(wrong));
  new (made) simulator(setup, virtual_time);
}

std::vector<std::tuple<std::int64_t, int, bool>> commands(simulator& of) {
  return of.with([](sim::device& device, std::int64_t) {
    std::vector<std::tuple<std::int64_t, int, bool>> all;
    for (const sim::asked& each : device.log())
      all.emplace_back(each.time_ns, each.code, each.obeyed);
    return all;
  });
}

array<true_sample> take_truth(simulator& of) {
  const auto all = of.with([](sim::device& device, std::int64_t) {
    std::vector<true_sample> taken;
    std::vector<sim::sent_sample> some(1024);
    while (const std::size_t count = device.take_truth(some)) {
      for (std::size_t i = 0; i < count; ++i) {
        taken.push_back({some[i].truth.time_ns, some[i].truth.bearing_deg, some[i].truth.range_mm});
      }
    }
    return taken;
  });
  return array_of(std::span<const true_sample>(all));
}

}  // namespace

sim::device make_device(const sim::setup& setup) {
  return sim::device(load_scene(setup), setup.device, setup.faults);
}

sim::setup read_setup(std::string_view source) {
  auto read = sim::parse_setup(source);
  if (const auto* why = std::get_if<sim::setup_error>(&read)) raise_bad_option(why->message);
  return std::get<sim::setup>(std::move(read));
}

simulator::simulator(const sim::setup& setup, bool virtual_time)
    : model_(model_named(setup.device.model)) {
  if (virtual_time) {
    virtual_ = std::make_shared<virtual_simulation>(make_device(setup));
  } else {
    real_->port = value_of(sim::serve_alone(make_device(setup)));
  }
}

simulator::~simulator() {
  if (process_.is_this_one()) return;
  new std::shared_ptr(std::move(real_));  // its thread is not in this process
}

std::string simulator::path() const {
  process_.check("this simulated lidar");
  if (real_->port) return real_->port->path();
  PyErr_SetString(PyExc_RuntimeError,
                  virtual_ ? "a lidar in virtual time has no path: give the Simulator to open()"
                           : "this simulated lidar is closed");
  throw nb::python_error();
}

void simulator::close() {
  process_.check("this simulated lidar");
  auto closed = std::move(real_->port);
  const without_gil free;
  closed.reset();
}

void bind_simulator(nb::module_& module) {
  const auto is = [](auto ask) {
    return [ask](simulator& of) {
      return of.with([&](sim::device& device, std::int64_t) { return (device.*ask)(); });
    };
  };
  const auto at_now = [](auto act) {
    return [act](simulator& of) {
      of.with(
          [&](sim::device& device, std::int64_t now_ns) { return (device.*act)(now_ns), true; });
    };
  };
  nb::class_<simulator> made(
      module, "Simulator",
      "A simulated lidar, for tests: open() takes it. In virtual time waiting takes "
      "no real time, and the same seed gives "
      "the same points. In real time it has a thread and a pseudo-terminal, so "
      "any program can open its `path`.");
  made.def("__init__", &make_simulator, nb::kw_only(), "faults"_a = std::vector<std::string>{},
           "virtual_time"_a = true, "options"_a,
           nb::sig("def __init__(self, *, faults: collections.abc.Sequence[str] = [], "
                   "virtual_time: bool = True, "
                   "**options: str | float) -> None"),
           "`faults`: 'unplug@5s+2s', 'flip*0.001', ...; `options`: world='room.txt', "
           "path='way.txt', seed=7, "
           "serial='2021101000070073', noise_mm=5, header_ns='2s', ...: docs/sim_device.md has "
           "all of them.")
      .def_prop_ro("path", &simulator::path,
                   "The name of its port; stays valid whatever faults there are. Real time only.")
      .def_prop_ro("is_virtual", &simulator::is_virtual, "Whether it is in virtual time.")
      .def_prop_ro(
          "now_ns",
          [](simulator& of) {
            return of.with([](sim::device&, std::int64_t now_ns) { return now_ns; });
          },
          "Its time in nanoseconds since its start; in virtual time the clock of the points, too.")
      .def_prop_ro("is_scanning", is(&sim::device::is_scanning),
                   "Whether it was started and not stopped.")
      .def_prop_ro("motor_turns", is(&sim::device::motor_turns), "Whether the motor is powered.")
      .def("unplug", at_now(&sim::device::unplug), "Unplugs it.")
      .def("replug", at_now(&sim::device::replug), "Plugs it in again.")
      .def("commands", &commands,
           "The commands that reached it: (time in ns, code, whether it was obeyed), the oldest "
           "first.")
      .def("truth", &take_truth,
           "The true values of the samples that were sent since the last call, at most the last "
           "16384: a structured array "
           "with `time_ns`, `bearing_deg` (clockwise degrees), `range_mm` (without noise; 0 for no "
           "target).")
      .def("close", &simulator::close,
           "Removes its port, like an unplug. In virtual time it does nothing. A port that is not "
           "closed "
           "exists as long as the Simulator or a lidar that open() made of it.");
  bind_context(made, "def __enter__(self) -> Simulator", &simulator::close);
}

}  // namespace g4lidar::python
