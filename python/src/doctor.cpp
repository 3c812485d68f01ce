// SPDX-License-Identifier: MIT
// The diagnostic run as data.
#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <variant>
#include <vector>

#include "enumeration_words.hpp"
#include "errors.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "gil.hpp"
#include "simulator.hpp"

namespace g4lidar::python {

void bind_doctor(nb::module_& module);

namespace {

using namespace nb::literals;
using report_function = std::function<void(const stage_report&)>;

/// A diagnosis with its description.
struct explained {
  diagnosis_info info;
};

/// What a run calls in Python. An exception of a signal handler or of on_stage ends the run.
struct calls_into_python {
  std::optional<nb::python_error> raised{};
  /// Held during the run in virtual time, but not by code in Python, which may use the Simulator.
  std::unique_lock<std::timed_mutex> lock{};

  /// Nothing after an exception.
  void call(const auto& function) {
    if (raised) return;
    const bool is_held = lock.owns_lock();
    if (is_held) lock.unlock();
    {
      const with_gil held;
      try {
        function();
      } catch (nb::python_error& error) {
        raised.emplace(std::move(error));
      }
    }
    if (is_held) lock.lock();
  }
};

std::vector<stage_report> examine(const std::variant<path_text, simulator*>& device,
                                  double measuring_time, std::uint32_t baud,
                                  const std::optional<std::string>& model, bool listen_only,
                                  const std::optional<report_function>& on_stage) {
  if (!(measuring_time >= 0.0 && measuring_time <= 3600.0))
    raise_impossible("measuring_time: 0 to 3600 s", measuring_time);
  diagnostic_options how;
  how.baud = baud;
  how.model = model_of(model);
  how.listen_only = listen_only;
  how.directions.in = frame::robot;  // as in filters
  how.measuring_time = std::chrono::nanoseconds(static_cast<std::int64_t>(measuring_time * 1e9));
  calls_into_python calls;
  how.is_cancelled = [&] {
    calls.call([] {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
    });
    return calls.raised.has_value();
  };
  if (on_stage)
    how.on_stage = [&](const stage_report& report) {
      calls.call([&] { in_python([&] { (*on_stage)(report); }); });
    };
  std::vector<stage_report> found;
  const auto* given = std::get_if<simulator*>(&device);
  if (given != nullptr && (*given)->is_virtual()) {
    const auto alive = (*given)->in_virtual_time();
    const auto mutex = (*given)->mutex();
    calls.lock = lock_of(*mutex);
    const without_gil free;
    sim::virtual_connector from(alive->device, alive->clock);
    found = diagnose(from, how);
    calls.lock.unlock();
  } else {
    const std::string name = given != nullptr ? (*given)->path() : std::get<path_text>(device).text;
    const without_gil free;
    found = diagnose(name, how);
  }
  if (calls.raised) throw std::move(*calls.raised);
  return found;
}

nb::dict evidence_of(const stage_report& report) {
  nb::dict all;
  for (const evidence& each : report.measurements) {
    all[nb::str(each.name.c_str())] =
        std::visit([](const auto& value) { return nb::cast(value); }, each.value);
  }
  return all;
}

}  // namespace

void bind_doctor(nb::module_& module) {
  nb::class_<explained>(module, "Diagnosis", "What may be wrong, and what to try.")
      .def_prop_ro(
          "name", [](const explained& d) { return d.info.name; },
          "'brown_out', ...; does not change.")
      .def_prop_ro(
          "severity", [](const explained& d) { return name_of(d.info.severity); },
          "'warn' or 'fail'.")
      .def_prop_ro(
          "cause", [](const explained& d) { return d.info.cause; },
          "The most likely cause: sentences.")
      .def_prop_ro(
          "advice", [](const explained& d) { return d.info.advice; }, "What to try: sentences.")
      .def_prop_ro(
          "alternatives",
          [](const explained& d) {
            std::vector<std::string_view> names;
            for (const diagnosis each : d.info.alternatives) names.push_back(describe(each).name);
            return names;
          },
          "Names of diagnoses that look the same to a host, the most likely first.")
      .def("__repr__", [](const explained& d) {
        return "<g4lidar.Diagnosis " + std::string(d.info.name) + ">";
      });
  nb::class_<stage_report>(module, "StageReport", "How one stage of doctor() ended.")
      .def_prop_ro(
          "stage", [](const stage_report& r) { return name_of(r.stage); },
          "'port', 'answers', 'motor', ...")
      .def_prop_ro(
          "verdict", [](const stage_report& r) { return name_of(r.outcome); },
          "'ok', 'skipped', 'warn' or 'fail'.")
      .def_prop_ro(
          "diagnoses",
          [](const stage_report& r) {
            std::vector<explained> all;
            for (const diagnosis each : r.diagnoses) all.push_back({r.explain(each)});
            return all;
          },
          "What may be wrong, the most likely first.")
      .def_prop_ro("evidence", &evidence_of,
                   nb::sig("def evidence(self) -> dict[str, int | float | str]"),
                   "Measurements by their name, which ends in the unit: 'slowest_ms'.")
      .def_ro("remark", &stage_report::remark, "One more sentence, or an empty text.")
      .def("__repr__", [](const stage_report& r) {
        return "<g4lidar.StageReport " + std::string(name_of(r.stage)) + ": " +
               std::string(name_of(r.outcome)) + ">";
      });
  module.def(
      "doctor", &examine, "device"_a = path_text{}, nb::kw_only(), "measuring_time"_a = 5.0,
      "baud"_a = 0, "model"_a = nb::none(), "listen_only"_a = false, "on_stage"_a = nb::none(),
      "Examines a lidar, its connection and its port; or a file. `device` as in open(). "
      "Measures the running scan for "
      "`measuring_time` seconds; takes about 3 s more with a healthy lidar, 8 s if it has to be "
      "searched. Sends queries, starts and stops; changes no setting. `baud`: bits per "
      "second (0: as found). `model`: the one that is expected, 'x4'; None: the one that the "
      "device or the file shows. `listen_only`: not a byte is sent; what needs answers is skipped. "
      "Sectors without a return are given in the frame 'robot'. `on_stage` is called with each "
      "stage when it ends.");
}

}  // namespace g4lidar::python
