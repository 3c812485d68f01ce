// SPDX-License-Identifier: MIT
#include "reading_thread.hpp"
#include "context.hpp"

#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "g4lidar/core/wall_clock.hpp"

namespace g4lidar::python {
namespace {

using namespace nb::literals;

/// After which the handlers of signals are called.
constexpr live_lidar::milliseconds slice{50};

/// All that exist. Guarded by the GIL. Never destroyed: a reader may be, after everything else.
std::vector<reading_thread*>& all_threads() {
  static auto* const all = new std::vector<reading_thread*>;
  return *all;
}

}  // namespace

reading_thread::reading_thread(background_reader&& started, foundation base,
                               std::optional<std::int64_t> wall_ahead_ns)
    : on_(std::move(base)),
      reader_(std::make_unique<background_reader>(std::move(started))),
      wall_ahead_ns_(wall_ahead_ns) {
  all_threads().push_back(this);
}

reading_thread::~reading_thread() {
  std::erase(all_threads(), this);
  if (process_.is_this_one()) {
    const without_gil free;
    reader_.reset();
    return;
  }
  static_cast<void>(reader_.release());  // its thread is not in this process
  new foundation(std::move(on_));
}

result<copied_scan> reading_thread::wait(live_lidar::milliseconds timeout) {
  const auto until = std::chrono::steady_clock::now() + timeout;
  while (true) {
    process_.check("this reader");
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    auto held = lock_of(mutex_);
    const without_gil free;
    const auto until_here = std::move(held);  // nobody waits for the GIL with the mutex
    const auto left =
        std::chrono::ceil<live_lidar::milliseconds>(until - std::chrono::steady_clock::now());
    const auto found = reader_->next_scan(std::clamp(left, live_lidar::milliseconds(0), slice));
    if (found) return copied_scan(*found, wall_ahead_ns_.value_or(wall_clock().ahead().count()));
    if (found.error() != problem::timeout || left <= slice) return tl::unexpected(found.error());
  }
}

nb::object reading_thread::next_scan(live_lidar::milliseconds timeout) {
  auto found = wait(timeout);
  if (!found) raise(found.error());
  return found->kept();
}

nb::object reading_thread::next_in_loop() {
  while (true) {
    auto found = wait(std::chrono::hours(1));
    if (found) return found->kept();
    const error& why = found.error();
    if (why == problem::end_of_input || why == problem::not_scanning) throw nb::stop_iteration();
    if (why != problem::timeout) raise(why);
  }
}

void reading_thread::stop() {
  background_reader& stopped = reader();
  const without_gil free;
  stopped.stop();
}

/// The references keep the readers, although other code runs at the same time.
void reading_thread::stop_all() {
  std::vector<nb::object> all;
  for (reading_thread* const each : all_threads()) {
    if (nb::object found = nb::find(each); found.is_valid()) all.push_back(std::move(found));
  }
  for (const nb::object& each : all) {
    auto& stopped = nb::cast<reading_thread&>(each);
    if (stopped.process_.is_this_one()) stopped.stop();
  }
}

void bind_background(nb::module_& module, nb::class_<live_lidar>& bound) {
  nb::class_<reading_thread> made(
      module, "BackgroundReader",
      "A lidar that a thread of the library reads: made by "
      "Lidar.background(). Any thread may use it. A loop over it "
      "waits without limit, and ends at the end of a file and after stop().");
  made.def(
          "next_scan",
          [](reading_thread& t, double timeout) { return t.next_scan(in_milliseconds(timeout)); },
          "timeout"_a = 2.0, nb::sig("def next_scan(self, timeout: float = 2.0) -> Scan"),
          "The oldest scan that was not taken yet; the last four are kept, older ones are counted "
          "in "
          "counts()['scans_missed']. Raises Timeout, and when the thread has ended, the reason.")
      .def(
          "__iter__", [](nb::handle self) { return nb::borrow(self); },
          nb::sig("def __iter__(self) -> BackgroundReader"))
      .def("__next__", &reading_thread::next_in_loop, nb::sig("def __next__(self) -> Scan"))
      .def_prop_ro(
          "state", [](reading_thread& on) { return name_of(on.reader().status().state); },
          "'running', 'resting', 'lost' or 'ended'.")
      .def(
          "counts", [](reading_thread& on) { return dict_of(on.reader().counts()); },
          nb::sig("def counts(self) -> dict[str, int]"), "As Lidar.counts(), at most 0.1 s old.")
      .def(
          "events",
          [](reading_thread& on) {
            std::vector<lidar_event> all;
            while (const auto event = on.reader().next_event()) all.push_back(*event);
            return all;
          },
          "As Lidar.events().")
      .def(
          "rest", [](reading_thread& thread, bool rests) { thread.reader().rest(rests); },
          "rests"_a = true,
          "Whether the motor is to stand. A file, too, is not read while it rests.")
      .def(
          "pause", [](reading_thread& thread, bool pauses) { thread.reader().pause(pauses); },
          "pauses"_a = true, "Pauses the player of a file; a seek then gives one scan.")
      .def(
          "set_speed",
          [](reading_thread& thread, double speed) { check(thread.reader().set_speed(speed)); },
          "speed"_a, "As Player.speed. Raises BadOption.")
      .def(
          "seek",
          [](reading_thread& thread, double seconds) { thread.reader().seek(in_ns(seconds)); },
          "seconds"_a, "Continues a file there, at most at one second before the end.")
      .def("stop", &reading_thread::stop,
           "Ends the thread and stops the motor. A second call does nothing.");
  bind_context(made, "def __enter__(self) -> BackgroundReader", &reading_thread::stop);
  bound.def(
      "background", [](live_lidar& lidar, bool newest) { return lidar.hand_over(newest); },
      nb::kw_only(), "newest"_a = false,
      nb::sig("def background(self, *, newest: bool = False) -> BackgroundReader"),
      "Starts the scan, if it was not started, and a thread of the library that reads it. The "
      "reader takes the lidar "
      "over: this object is closed then. With `newest` only the newest scan is kept. Raises "
      "BadOption for a Simulator "
      "in virtual time, and for a lidar that is recorded; else as start().");
}

}  // namespace g4lidar::python
