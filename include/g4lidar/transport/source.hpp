// SPDX-License-Identifier: MIT
// What the name of a lidar means:
//
// | name | lidar |
// |---|---|
// | empty | the only lidar that is attached |
// | `/dev/ttyUSB0` | the one at this port |
// | `serial:2021101000070073` | the one with this serial number |
// | `usb:1-1.4` | the one at this USB port |
// | `tcp:HOST:PORT` | the one behind a raw network bridge |
// | `/dev/ttyUSB0?model=x4` | any of these, of this model; without it, the model is searched when it is opened |
// | `walk.mcap`, `file:PATH` | a recording, or the raw bytes of a port |
// | `file:PATH?model=x4` | raw bytes of this model; `?` is a part of PATH if there is such a file |
// | `-` | raw bytes from standard input |
// | `sim:`, `sim:?seed=7&fault=unplug@5s` | a simulated lidar in real time: docs/sim.md |
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

namespace sim {
struct simulated_source;
}

/// What is behind a name.
enum class source_kind : std::uint8_t {
  device,     ///< A port or a network bridge, with a lidar that answers.
  recording,  ///< A file with times.
  raw_bytes,  ///< Of a port, without times in a file; also of a pipe.
  simulated,  ///< `sim:`
};

/// By the form of the name, and by what is at a path now. A path where nothing is names a device, with
/// `file:` raw bytes.
[[nodiscard]] G4LIDAR_API source_kind kind_of_source(std::string_view name);
/// Whether it names a recording or raw bytes, which have no lidar that can be asked.
[[nodiscard]] inline bool names_file(std::string_view name) {
  const source_kind kind = kind_of_source(name);
  return kind == source_kind::recording || kind == source_kind::raw_bytes;
}
/// The path of a name that is a file, without `file:`, and without `?model=` unless there is a file with
/// it in its name. Of a device: its name without `?model=`.
[[nodiscard]] G4LIDAR_API std::string path_of_source(std::string_view name);
/// The model of `file:PATH?model=x4`, or of a device, `/dev/ttyUSB0?model=x4`; null if the name has none.
/// Fails with bad_option if there is no such model. Valid forever.
[[nodiscard]] G4LIDAR_API result<const model*> model_in_source(std::string_view name);

/// Whether opening this source reads the file at `path`, under any of its names: it is the source, or the world or the
/// path of `sim:`. Compared by device and inode. A program that writes files asks before it replaces one.
[[nodiscard]] G4LIDAR_API bool reads_file(std::string_view name, const std::string& path);

/// The connector for the source that `options.device` names, without options.wrap: for callers that
/// open it themselves. lidar::open(options) is open(connector_for(options), options), with wrap and
/// device_wait. Errors: bad_option, bad_file, system, cancelled.
[[nodiscard]] G4LIDAR_API result<std::unique_ptr<connector>> connector_for(
    const lidar_options& options);

/// Which of the options the source that `options.device` names cannot use, as an error; nothing if it can use all.
/// A file has no connection and no settings: `baud`, `reconnect`, the settings, and of the tuning all but `batch` and
/// `transport_delay` are for lidars, and `probe_all_ports` for ports. `playback` is for files,
/// `raw_sample_rate_hz` for raw bytes, and `counts_times` for those of a pipe or a file. lidar::open() and connector_for() fail with this error: bad_option, with the detail other_source.
[[nodiscard]] G4LIDAR_API std::optional<error> problem_with_source(const lidar_options& options);
/// The same options without these: for a program that opens whatever its user names.
[[nodiscard]] G4LIDAR_API lidar_options usable_options(lidar_options options);

/// The simulated lidar that a connector of connector_for() opens; null if it opens another one. Valid
/// as long as the connector, or the lidar that owns it.
[[nodiscard]] G4LIDAR_API const sim::simulated_source* simulation_of(
    const connector& from) noexcept;

/// Whether `name` is a simulated lidar on a robot that moves. What cannot be read is an error when it is opened; false
/// without the simulator.
[[nodiscard]] G4LIDAR_API bool has_simulated_robot(std::string_view name);
/// The robot of a simulated lidar: each call gives its next odometry, without errors, by the clock of the points. Empty
/// if it does not move. Independent of `of`.
[[nodiscard]] G4LIDAR_API std::function<stamped_odometry()> robot_of(
    const sim::simulated_source& of);
/// Where its robot has the lidar. Independent of `of`.
[[nodiscard]] G4LIDAR_API mounting mounting_on_robot(const sim::simulated_source& of);

/// As which model lidar::open() reads the source of these options, as far as it is known before that: what `sim:` states;
/// else the model that is named; else what a recording states, and model_of_bytes(); of a device null: it is searched. Of
/// the options it uses device, model, insist_on_model and is_cancelled. Fails like lidar::open() with bad_option or
/// other_device where the source cannot be read so, and like recording_reader::open(). Valid forever. *Allocates.*
[[nodiscard]] G4LIDAR_API result<const model*> model_of_source(const lidar_options& options);

}  // namespace g4lidar
