// SPDX-License-Identifier: MIT
// open(), and what is connected.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <variant>

#include "abandonable.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/options/option_table.hpp"
#include "g4lidar/transport/serial_port.hpp"
#include "g4lidar/transport/source.hpp"
#include "g4lidar/transport/transport.hpp"
#include "interruption.hpp"
#include "live_lidar.hpp"
#include "setting_keywords.hpp"
#include "simulator.hpp"

namespace g4lidar::python {
namespace {

using namespace nb::literals;
using device_name = std::variant<path_text, simulator*>;

/// The connector for a file, without waiting. Signals end the opening; later they wake the lidar, which
/// reads without the GIL.
std::unique_ptr<connector> open_file(lidar_options options) {
  const auto is_opening = std::make_shared<bool>(true);
  options.is_cancelled = [is_opening] { return *is_opening && handler_raises(); };
  auto made = value_of(connector_for(options));
  *is_opening = false;
  if (PyErr_Occurred() != nullptr) throw nb::python_error();
  return made;
}

/// What needs no time to open: a file, or a simulation in virtual time. Null for all else, which
/// `options.device` names then.
std::unique_ptr<connector> connect(const device_name& device, lidar_options& options,
                                   foundation& base) {
  if (const auto* given = std::get_if<simulator*>(&device)) {
    simulator& simulated = **given;
    if (options.model == nullptr) options.model = simulated.simulated();
    if (simulated.is_virtual()) {
      const auto& alive = simulated.in_virtual_time();
      base.simulation = alive;
      base.mutex = simulated.mutex();
      base.is_virtual = true;
      return std::make_unique<sim::virtual_connector>(alive->device, alive->clock);
    }
    options.device = simulated.path();
    base.simulation = simulated.in_real_time();
    return nullptr;
  }
  options.device = std::get<path_text>(device).text;
  const source_kind kind = kind_of_source(options.device);
  if (kind == source_kind::recording || kind == source_kind::raw_bytes) return open_file(options);
  return nullptr;
}

live_lidar* open_lidar(const device_name& device, lidar_options options,
                       const std::optional<path_text>& record, bool overwrite) {
  foundation on;
  auto from = connect(device, options, on);
  if (const auto wrong = problem_with_source(options)) raise(*wrong);  // before a file is made
  if (record) {
    if (reads_file(options.device, record->text))
      raise_bad_option("record: this is the file of the source");
    recording_options as;
    as.overwrite = overwrite;
    on.recording =
        std::make_shared<recording_writer>(value_of(recording_writer::create(record->text, as)));
    if (on.is_virtual) {  // virtual time goes on from now
      const auto now = std::chrono::system_clock::now().time_since_epoch();
      on.recording->set_wall_clock(std::chrono::nanoseconds(now).count() - from->now_ns());
    }
  }
  const auto opening = std::make_shared<std::atomic<progress>>(progress::running);
  options.wrap = [opening, recorder = on.recording](std::unique_ptr<connector> inner) {
    inner = std::make_unique<abandonable_connector>(std::move(inner), opening);
    using wrapped = result<std::unique_ptr<connector>>;
    return recorder ? recorded(std::move(inner), *recorder) : wrapped(std::move(inner));
  };
  auto opened = [&] {
    if (from) {
      // Of a simulation in virtual time, which other lidars may use.
      auto lock = on.mutex ? lock_of(*on.mutex) : std::unique_lock<std::timed_mutex>();
      if (on.recording) from = value_of(recorded(std::move(from), *on.recording));
      const without_gil free;
      auto made = lidar::open(std::move(from), options);
      if (lock) lock.unlock();  // nobody waits for the GIL with the mutex
      return made;
    }
    options.is_cancelled = [opening] { return *opening == progress::abandoned; };
    return in_background([options] { return lidar::open(options); }, opening);
  }();
  if (!opened) raise(opened.error());
  if (on.recording) {
    recorded_device known;
    known.information = opened->information();
    on.recording->device(known);
  }
  return new live_lidar(*std::move(opened), std::move(on));
}

/// An option by its name. Raises BadOption.
void take(lidar_options& into, const char* name, const parameter_value& value) {
  const std::string wrong = set_option(into, *find_parameter(name), value);
  if (!wrong.empty()) raise_bad_option(std::string(name) + ": " + wrong);
}

template <class... Wanted>
live_lidar* open_by_keywords(
    const device_name& device, std::uint32_t baud, const Wanted&... wanted, bool reconnect,
    bool partial_scans, double answer_time, double stall_time, double longest_backoff, double batch,
    double transport_delay, double speed, bool loop, double begin, std::optional<double> end,
    std::optional<std::uint32_t> raw_sample_rate_hz, const std::optional<std::string>& model,
    std::optional<double> zero_angle, const std::optional<path_text>& record, bool overwrite,
    double device_wait, bool listen_only, bool insist_on_model, bool leave_dtr) {
  lidar_options options;
  if (model) take(options, "model", *model);
  options.baud = baud;
  for (const answer& value : values_of(wanted...)) set_option(options, value);
  options.reconnect = reconnect;
  options.listen_only = listen_only;
  options.insist_on_model |= insist_on_model;
  options.leave_dtr = leave_dtr;
  options.partial_scans = partial_scans;
  options.tuning.answer_time = in_milliseconds(answer_time);
  options.tuning.stall_time = in_milliseconds(stall_time);
  options.tuning.longest_backoff = in_milliseconds(longest_backoff);
  options.tuning.batch = in_milliseconds(batch);
  options.tuning.transport_delay = std::chrono::nanoseconds(in_ns(transport_delay));
  options.device_wait = device_wait == std::numeric_limits<double>::infinity()
                            ? std::chrono::milliseconds::max()
                            : in_milliseconds(device_wait);
  options.playback.speed = speed;
  options.playback.loop = loop;
  options.playback.from_ns = in_ns(begin);
  if (end) options.playback.to_ns = in_ns(*end);
  if (raw_sample_rate_hz.value_or(0) != 0) options.raw_sample_rate_hz = raw_sample_rate_hz;
  if (zero_angle) take(options, "zero_angle", *zero_angle);
  return open_lidar(device, options, record, overwrite);
}

using found_ports = std::vector<std::tuple<port_info, recognised_lidar>>;

/// The lidar at each port, as far as there are any.
found_ports ask(std::vector<port_info> ports) {
  const auto asking = std::make_shared<std::atomic<progress>>(progress::running);
  const auto work = [ports = std::move(ports), asking] {
    found_ports found;
    for (const port_info& port : ports) {
      if (*asking == progress::abandoned) break;
      auto opened = serial_port::open(port.path, {});
      if (!opened) continue;
      abandonable_transport to(std::move(*opened), asking);
      const auto longest = std::chrono::nanoseconds(find_options().probe_timeout);
      if (auto lidar = search(to, to.now_ns() + longest.count())) {
        found.emplace_back(port, *std::move(lidar));
      }
    }
    return found;
  };
  return in_background(work, asking);
}

std::vector<port_info> ports_now() {
  auto found = [] {
    const without_gil free;
    return list_ports();
  }();
  return value_of(std::move(found));
}

void bind_discovery(nb::module_& module) {
  nb::class_<port_info>(module, "Port",
                        "A serial port, as the system knows it. Texts are empty where not known.")
      .def_ro("path", &port_info::path, "'/dev/ttyUSB0'.")
      .def_ro("by_id", &port_info::by_id, "'/dev/serial/by-id/...'.")
      .def_ro("bus_path", &port_info::bus_path, "The USB port, '1-1.4': open('usb:1-1.4').")
      .def_ro("usb_serial", &port_info::usb_serial, "Of the USB bridge, not of the lidar.")
      .def_ro("manufacturer", &port_info::manufacturer, "As the USB bridge reports it.")
      .def_ro("product", &port_info::product, "As the USB bridge reports it.")
      .def_ro("driver", &port_info::driver, "The kernel driver, 'cp210x'.")
      .def_ro("vendor_id", &port_info::vendor_id, "USB, 0x10c4 for Silicon Labs.")
      .def_ro("product_id", &port_info::product_id, "USB.")
      .def_ro("may_open", &port_info::may_open, "Whether this user may read and write it.")
      .def("__repr__", [](const port_info& p) { return "<g4lidar.Port " + p.path + ">"; });
  nb::class_<recognised_lidar>(module, "FoundLidar", "A lidar, as far as its bytes name it.")
      .def_prop_ro(
          "model", [](const recognised_lidar& of) { return of.model->word; },
          "The name of its model, 'x2': the most usual of `candidates`.")
      .def_prop_ro(
          "candidates", [](const recognised_lidar& of) { return words_of(of.candidates); },
          "All models that send such bytes, `model` first.")
      .def_ro("baud", &recognised_lidar::baud, "Bits per second.")
      .def_prop_ro(
          "information",
          [](const recognised_lidar& of) {
            return of.device.model != 0 ? std::optional(of.device) : std::nullopt;
          },
          "What it reports about itself; None if it reports nothing.")
      .def("__repr__", [](const recognised_lidar& of) {
        return "<g4lidar.FoundLidar " + std::string(of.model->word) + ">";
      });
  module.def("list_ports", &ports_now, "Every serial port, ordered by path. Opens none.");
  module.def(
      "find_lidars",
      [](bool probe_all_ports) {
        auto ports = ports_now();
        std::erase_if(ports, [&](const port_info& port) {
          return is_reserved(port) || (!probe_all_ports && !is_g4_bridge(port));
        });
        return ask(std::move(ports));
      },
      nb::kw_only(), "probe_all_ports"_a = false,
      "Every lidar that answers or sends, with its port, ordered by path. Takes at most 4 s a "
      "port. Writes "
      "only to ports with the "
      "USB bridge of a G4, unless `probe_all_ports` is set.");
}

/// What open() does, with its options as the table of the library describes them.
std::string text_of_open() {
  std::string made =
      "Opens a lidar and queries its identity; a device that is scanning is stopped first. "
      "`device`: '' for the only lidar; a path; 'serial:2021101000070073' (the number of the "
      "lidar); 'usb:1-1.4'; 'tcp:host:port'; a recording; 'file:PATH' (a recording, or raw bytes "
      "of a port); 'sim:?seed=7' (a simulated lidar in real time); a Simulator.\n\n"
      "Settings that are given are set at each start; None leaves them as the device has them: see "
      "Lidar.set(). All times are in seconds. One that the source cannot use is refused:\n\n";
  for (const parameter& each : all_parameters()) {
    if (!each.is_of(option_door::python)) continue;
    const double unit = each.unit == "ms" ? 1e-3 : each.unit == "ns" ? 1e-9 : 1.0;
    parameter shown = each;
    if (unit != 1.0) shown.unit = "seconds";
    const std::string name =
        each.setting != nullptr ? keyword_of(*each.setting) : std::string(each.name);
    made.append("- `").append(name).append("`: ").append(description_of(shown));
    const auto shown_limit = [&](double limit) {
      const bool is_whole = unit == 1.0 && limit == std::trunc(limit);
      return std::string(is_whole ? nb::str(nb::int_(static_cast<std::int64_t>(limit))).c_str()
                                  : nb::str(nb::float_(limit * unit)).c_str());
    };
    if (const auto [least, most, step] = each.range; least < most)
      made.append(" (" + shown_limit(least) + " to " + shown_limit(most) + ")");
    made += ".\n";
  }
  return made +
         "\n`speed` 0 plays a file as fast as it is read. `device_wait`: how long to wait for a "
         "device that is not there yet (float('inf'): without limit). `record`: the MCAP file to "
         "which the lidar is recorded; an existing file only with `overwrite`, and never the file "
         "that is read.\n\n"
         "Takes about 0.06 s with a healthy device, at most 15 s. Raises an Error.";
}

template <class... Wanted, std::size_t... Index>
void bind_open(nb::module_& module, keyword_types<Wanted...>, std::index_sequence<Index...>) {
  static const std::string text = text_of_open();
  const lidar_options usual;
  const auto seconds = [](auto time) { return std::chrono::duration<double>(time).count(); };
  module.def(
      "open", &open_by_keywords<Wanted...>, "device"_a = path_text{}, nb::kw_only(),
      "baud"_a = usual.baud, keyword(Index)..., "reconnect"_a = usual.reconnect,
      "partial_scans"_a = usual.partial_scans, "answer_time"_a = seconds(usual.tuning.answer_time),
      "stall_time"_a = seconds(usual.tuning.stall_time),
      "longest_backoff"_a = seconds(usual.tuning.longest_backoff),
      "batch"_a = seconds(usual.tuning.batch),
      "transport_delay"_a = seconds(usual.tuning.transport_delay), "speed"_a = 0.0,
      "loop"_a = false, "begin"_a = 0.0, "end"_a = nb::none(), "raw_sample_rate_hz"_a = nb::none(),
      "model"_a = nb::none(), "zero_angle"_a = nb::none(), "record"_a = nb::none(),
      "overwrite"_a = false, "device_wait"_a = 0.0, "listen_only"_a = false,
      "insist_on_model"_a = false, "leave_dtr"_a = false, text.c_str());
}

}  // namespace

void bind_opening(nb::module_& module) {
  bind_discovery(module);
  bind_open(module, setting_types(), setting_types::indices());
}

}  // namespace g4lidar::python
