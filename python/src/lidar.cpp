// SPDX-License-Identifier: MIT
// The classes Lidar, Scans and Event.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <chrono>
#include <limits>
#include <string>
#include <tuple>

#include "context.hpp"
#include "gil.hpp"
#include "reading_thread.hpp"
#include "setting_keywords.hpp"

namespace g4lidar::python {
namespace {

using namespace nb::literals;

/// The iterator of Lidar.scans().
struct scans {
  nb::object of;
  scan_loop loop;
  bool newest;

  [[nodiscard]] live_lidar& lidar() const { return nb::cast<live_lidar&>(of); }
};

/// In seconds.
double seconds_of(live_lidar::milliseconds time) {
  return time == live_lidar::milliseconds::max() ? std::numeric_limits<double>::infinity()
                                                 : std::chrono::duration<double>(time).count();
}

nb::dict counts(live_lidar& on) {
  nb::dict all = dict_of(on.look([](lidar& device) { return device.counts(); }));
  all["scans_dropped"] = on.dropped();
  return all;
}

array<point> next_points(live_lidar& live, double timeout) {
  const auto wait = in_milliseconds(timeout);
  const auto copy = [&](lidar& device) -> result<std::vector<point>> {
    const auto found = device.next_points(wait);
    if (!found) return tl::unexpected(found.error());
    return std::vector(found->begin(), found->end());
  };
  return live.run(copy, [](const std::vector<point>& found) {
    return array_of(std::span<const point>(found));
  });
}

std::vector<lidar_event> events(live_lidar& on) {
  return on.look([](lidar& device) {
    std::vector<lidar_event> all;
    while (const auto event = device.next_event()) all.push_back(*event);
    return all;
  });
}

void bind_parts(nb::module_& module) {
  nb::class_<lidar_event>(module, "Event", "Something that happened without a request.")
      .def_prop_ro(
          "kind", [](const lidar_event& e) { return name_of(e.what); },
          "'lost', 'reconnected', 'spinning_up', 'restarted', ...: docs/symptoms.md describes "
          "each.")
      .def_prop_ro(
          "reason", [](const lidar_event& e) { return name_of(e.reason); },
          "Of 'lost': the problem.")
      .def_ro("time_ns", &lidar_event::time_ns, "When, in nanoseconds of the monotonic clock.")
      .def("__repr__", [](const lidar_event& e) {
        return "<g4lidar.Event " + std::string(name_of(e.what)) + ">";
      });
  nb::class_<device_information>(module, "DeviceInformation", "What a lidar reports about itself.")
      .def_ro("model", &device_information::model, "5 is a G4.")
      .def_prop_ro(
          "firmware",
          [](const device_information& i) {
            return std::to_string(i.firmware_major) + "." + std::to_string(i.firmware_minor);
          },
          "The version of its firmware, 'MAJOR.MINOR'.")
      .def_ro("hardware", &device_information::hardware, "The version of its hardware.")
      .def_prop_ro(
          "serial_number",
          [](const device_information& i) { return std::string(i.serial_number()); }, "16 digits.");
  nb::class_<scans>(module, "Scans",
                    "The scans of a lidar, one after the other: see Lidar.scans().")
      .def(
          "__iter__", [](nb::handle self) { return nb::borrow(self); },
          nb::sig("def __iter__(self) -> Scans"))
      .def(
          "__next__", [](scans& self) { return self.lidar().next_in_loop(self.loop, self.newest); },
          nb::sig("def __next__(self) -> Scan"),
          "The next scan. Raises Timeout, and the errors of Lidar.try_scan().")
      .def(
          "_advance",
          [](scans& self, double slice) {
            return self.lidar().advance(self.loop, in_milliseconds(slice), self.newest);
          },
          nb::arg(), nb::sig("def _advance(self, slice: float, /) -> Scan | None"))
      .def("_left", [](scans& self) {
        return seconds_of(self.lidar().look([&](lidar& on) { return self.loop.left(on); }));
      });
}

template <class Class, class... Wanted, std::size_t... Index>
void bind_control(Class& made, keyword_types<Wanted...>, std::index_sequence<Index...>) {
  made.def(
          "start",
          [](live_lidar& lidar, const Wanted&... wanted) {
            set(lidar, values_of(wanted...), true);
            lidar.start();
          },
          nb::kw_only(), keyword(Index)...,
          "Sets what is given, as set() does, and starts the scan. Returns when the device has "
          "confirmed. Blocks at most "
          "10 s with one fault of the device, 15 s for each request if many bytes are damaged.")
      .def(
          "set",
          [](live_lidar& lidar, const Wanted&... wanted, bool interrupt) {
            set(lidar, values_of(wanted...), interrupt);
          },
          nb::kw_only(), keyword(Index)..., "interrupt"_a = false,
          "Sets the scan frequency (of a G4 5 to 12 Hz), the measurements per second (of a G4 "
          "4000, 8000 or 9000), the direction of the head, whether the lidar regulates its "
          "frequency, whether the motor stops when idle, whether the lidar stops when the host "
          "sends nothing for 3 s. They are set again at each start and after a reconnect. During a "
          "scan Scanning is raised, unless `interrupt` allows to stop and start again. Raises "
          "BadSetting for a value, and NotSupported for a setting, that the model does not have: "
          "then nothing is set.")
      .def(
          "settings", &settings, nb::kw_only(), "interrupt"_a = false,
          nb::sig("def settings(self, *, interrupt: bool = False) -> dict[str, float | bool | str "
                  "| None]"),
          "The settings that can be queried: 'sample_rate_hz', 'frequency_hz', 'direction', "
          "'idle'. None: the model does not have this setting, or is a TG that does not answer for "
          "its sample rate.")
      .def(
          "health",
          [](live_lidar& live, bool interrupt) {
            const auto how = interrupt ? while_scanning::stop_and_resume : while_scanning::refuse;
            const health found =
                live.run([&](lidar& device) { return device.ask(requests::health(), how); });
            return std::tuple(name_of(found.status), found.error_code);
          },
          nb::kw_only(), "interrupt"_a = false,
          "The health that it reports: 'ok', 'warning' or 'error', and a code.")
      .def("stop", &live_lidar::stop,
           "Stops the scan and the motor. Blocks at most 1.5 s if the device does not react.")
      .def("close", &live_lidar::close,
           "Stops the scan and closes the connection, and the recording. Any thread: a waiting "
           "call of another thread "
           "ends. A second call does nothing. If the handler of a signal raises, the lidar stays "
           "open.")
      .def("release", &live_lidar::release,
           "Closes the connection, and leaves the device as it is. Never waits.")
      .def("wake", &live_lidar::wake,
           "Makes a waiting call of another thread, or the next call, raise Cancelled, once. Any "
           "thread.");
  bind_context(made, "def __enter__(self) -> Lidar", &live_lidar::close);
}

template <class Class>
void bind_reading(Class& made) {
  made.def(
          "try_scan",
          [](live_lidar& lidar, double timeout) {
            return lidar.try_scan(in_milliseconds(timeout));
          },
          "timeout"_a = 2.0, nb::sig("def try_scan(self, timeout: float = 2.0) -> Scan"),
          "The next revolution, if it is complete within `timeout` seconds; waits without the GIL. "
          "Raises Timeout "
          "(try again), NotScanning, "
          "Reconnecting, EndOfInput at the end of a recording, and the fatal errors of "
          "docs/errors.md.")
      .def(
          "scans",
          [](nb::object self, std::optional<double> timeout, bool newest) {
            const double longest = timeout.value_or(std::numeric_limits<double>::infinity());
            return scans{std::move(self), scan_loop(in_milliseconds(longest)), newest};
          },
          "timeout"_a = 2.0, nb::kw_only(), "newest"_a = false,
          "The scans, for a loop. It ends at the end of a recording, and when the lidar is closed. "
          "It raises Timeout if a scan that is due does not come within `timeout` seconds (None: "
          "never). While the motor spins up after a start, a restart or a reconnect, it waits "
          "until "
          "the first scan, at most 10 s, or `timeout` if that is longer. A lidar that is lost, and "
          "was opened with `reconnect`, is waited for without limit. Fatal errors are raised; "
          "after "
          "wake(), Cancelled. With `newest` only the newest "
          "complete scan is "
          "returned; older ones are "
          "dropped and counted in counts()['scans_dropped'].")
      .def(
          "scans_async",
          [](nb::handle self, std::optional<double> timeout, bool newest) {
            return in_python([&]() -> nb::object {
              return nb::module_::import_("g4lidar._asyncio").attr("scans")(self, timeout, newest);
            });
          },
          "timeout"_a = 2.0, nb::kw_only(), "newest"_a = false,
          nb::sig("def scans_async(self, timeout: float | None = 2.0, *, newest: bool = False) -> "
                  "collections.abc.AsyncIterator[Scan]"),
          "The same for `async for`: it waits in the running loop of asyncio on the descriptor and "
          "the deadline of the "
          "lidar, without a thread. start() and close() block.")
      .def("next_points", &next_points, "timeout"_a = 2.0,
           "All points since the last call, at least one, as Scan.points. Waits and raises like "
           "try_scan().");
}

template <class Class>
void bind_event_loop(Class& made) {
  made.def("_notice", &live_lidar::notice_fileno)
      .def("poll_scan", &live_lidar::poll_scan, nb::kw_only(), "newest"_a = false,
           nb::sig("def poll_scan(self, *, newest: bool = False) -> Scan | None"),
           "For an event loop: processes what has arrived. Never waits; None if no scan is "
           "complete.")
      .def(
          "fileno",
          [](live_lidar& on) {
            return on.look([](lidar& device) { return device.event_loop().native_handle(); });
          },
          "For an event loop: readable when poll_scan() has something to do; -1 if there is no "
          "descriptor.")
      .def("next_deadline", &live_lidar::next_deadline,
           nb::sig("def next_deadline(self) -> float | None"),
           "For an event loop: the latest time for the next poll_scan(), in seconds of "
           "time.monotonic(). Ask it before "
           "each wait. None: only the descriptor.");
}

nb::dict in_words(const recognition& from) {
  nb::dict all;
  all["model"] = std::string(from.model->word);
  all["candidates"] = words_of(from.candidates);
  all["known_by"] = std::string(name_of(from.by));
  all["number"] = int{from.number};
  all["baud"] = from.baud;
  all["is_silent"] = from.is_silent;
  all["was_stopped"] = from.was_stopped;
  all["contradictions"] = contradictions_of(from);
  return all;
}

template <class Class>
void bind_state(Class& made) {
  made.def("events", &events, "What happened since the last call without a request.")
      .def("counts", &counts, nb::sig("def counts(self) -> dict[str, int]"),
           "All counts since open(): 'bytes', 'points', 'scans', 'samples_lost', ... Docs: "
           "lidar_counts of the library.")
      .def_prop_ro(
          "information",
          [](live_lidar& on) {
            return on.look([](lidar& device) { return device.information(); });
          },
          "What the device reported about itself when it was opened.")
      .def_prop_ro(
          "candidates",
          [](live_lidar& on) {
            return on.look([](lidar& device) { return words_of(device.recognition().candidates); });
          },
          nb::sig("def candidates(self) -> list[str]"),
          "All models that send such bytes; it is read as the first. One alone if it was named, or "
          "if the device answers. If the first is not yours, name yours: open(model='x3').")
      .def_prop_ro(
          "recognition",
          [](live_lidar& on) {
            return on.look([](lidar& device) { return in_words(device.recognition()); });
          },
          nb::sig("def recognition(self) -> dict[str, object]"),
          "As which model it is read, from what that is known ('known_by': 'user', 'number', "
          "'samples', ...), and what contradicts it, in sentences.")
      .def_prop_ro(
          "name",
          [](live_lidar& on) {
            return on.look([](lidar& device) { return std::string(device.name()); });
          },
          "The name of the connection: a path, 'tcp:host:port'.")
      .def_prop_ro(
          "is_scanning",
          [](live_lidar& on) {
            return on.look([](lidar& device) { return device.is_scanning(); });
          },
          "Whether a scan was started and not stopped.")
      .def_prop_ro(
          "is_spinning_up",
          [](live_lidar& on) {
            const auto due = on.look([](lidar& of) { return of.event_loop().scan_due_in(); });
            return due.count() > 0 && due != live_lidar::milliseconds::max();
          },
          "Whether it was started, and no scan has come yet: the motor may be spinning up.");
}

}  // namespace

nb::dict dict_of(const lidar_counts& from) {
  nb::dict all;
  all["bytes"] = from.bytes;
  all["held"] = from.held;
  all["parsed_bytes"] = from.stream.parsed_bytes;
  all["packets"] = from.stream.packets;
  all["responses"] = from.stream.responses;
  all["points"] = from.stream.points;
  all["suspect_packets"] = from.stream.suspect;
  all["time_packets"] = from.stream.time_packets;
  all["empty_packets"] = from.stream.empty_packets;
  all["crc_matches"] = from.stream.crc_matches;
  all["crc_mismatches"] = from.stream.crc_mismatches;
  for (std::size_t i = 0; i < skip_reasons; ++i) {
    const std::string name = std::string("skipped_") + name_of(static_cast<skip_reason>(i));
    all[nb::str(name.c_str())] = from.stream.skipped_by_reason[i];
  }
  all["samples_lost"] = from.samples_lost;
  all["scans"] = from.scans;
  all["partial_scans"] = from.partial_scans;
  all["scans_missed"] = from.scans_missed;
  all["points_missed"] = from.points_missed;
  all["command_retries"] = from.command_retries;
  all["reconnects"] = from.reconnects;
  all["largest_gap_ns"] = from.largest_gap_ns;
  return all;
}

void bind_lidar(nb::module_& module) {
  bind_parts(module);
  nb::class_<live_lidar> made(
      module, "Lidar",
      "A lidar, a recording, or a simulated lidar: made by open(). Use it in a `with` statement, "
      "whose end stops the "
      "motor; at the end of the program it is stopped, too. Threads may use different lidars; "
      "calls of several threads "
      "for one lidar wait for each other. After os.fork() the child cannot use it.");
  bind_control(made, setting_types(), setting_types::indices());
  bind_reading(made);
  bind_event_loop(made);
  bind_state(made);
  bind_player(module, made);
  bind_background(module, made);
  module.def("_close_all", [] {
    reading_thread::stop_all();
    live_lidar::close_all();
  });
}

}  // namespace g4lidar::python
