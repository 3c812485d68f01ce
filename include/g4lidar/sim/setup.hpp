// SPDX-License-Identifier: MIT
// Simulated lidars that a text describes, sim:?world=room.txt&seed=7&fault=unplug@5s, and the
// places where programs find them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/odometry.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::sim {

/// All that a text contains about a device.
struct setup {
  std::string world_file;  ///< For load_world().
  std::string path_file;   ///< For load_path(); empty: the path of the world.
  device_options device;
  std::vector<fault> faults;
  std::string model;          ///< The word of `model`; empty: a G4.
  bool other_layout = false;  ///< For use_model(), of a `model` that follows.
};

/// Why a text is not a setup: a sentence without a full stop, for people.
struct setup_error {
  std::string message;
};

/// Sets what "NAME=VALUE" names: `world`, `path`, `seed`, `serial`, `model`, `model_id`, `firmware`, `other_layout`, a
/// further `fault`, or the member of device_options of that name (docs/sim_device.md lists them). `model` is a word
/// for use_model(): what selects it comes before it, and what changes it behind it. Returns what is wrong, a
/// sentence without a full stop; empty if nothing is. Does not check the values against each other: see
/// problem_with(). Throws only std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::string set(setup& into, std::string_view word);

/// Whether the name of a source is that of a simulated lidar: "sim:...". *Pure.*
[[nodiscard]] G4LIDAR_API bool is_simulated(std::string_view source) noexcept;

/// The setup of "sim:?NAME=VALUE&NAME=VALUE" in any order, with %41 read as A; "sim:" is a healthy device in the
/// built-in world. Throws only std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::variant<setup, setup_error> parse_setup(std::string_view source);

/// The world in a file of at most 16 MB; built_in_world() for an empty name. A file that cannot be
/// read is an error of line 0. Throws only std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::variant<world, world_error> load_world(const std::string& file);

/// Replaces the path of a world by that in a file of at most 16 MB (parse_path()). Returns the error,
/// if any; a file that cannot be read is one of line 0. Throws only std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::optional<world_error> load_path(world& into,
                                                               const std::string& file);

/// The options of `count` devices that are served together. The seed is one higher for each. The
/// first have `serials`, of 16 digits each; the others count up from the serial number of `each`,
/// and leave out those. Throws only std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::vector<device_options> several(const device_options& each,
                                                              std::size_t count,
                                                              std::vector<std::string> serials);

/// The link for pty_port::open() at which discovery finds a device, in the directory that the
/// environment variable G4LIDAR_SIM_DIR names, which is created. Empty without the variable.
[[nodiscard]] G4LIDAR_API std::string registered_link(std::string_view serial);

/// A device with a thread of its own, at a link in a new directory (in TMPDIR, or /tmp): its path()
/// stays valid whatever faults there are. Destroying it removes both. Fails with system.
[[nodiscard]] G4LIDAR_API result<std::shared_ptr<background_pty>> serve_alone(device simulated);

/// A simulated lidar in real time, and the robot that carries it.
struct simulated_source {
  std::shared_ptr<background_pty> port;
  std::optional<odometry> robot;  ///< Without errors; nothing without a path.
  std::int64_t begin_ns;          ///< The time 0 of both, by std::chrono::steady_clock.
  std::string model;              ///< Its word; empty: a G4.
  pose mounted_at{};              ///< As in world.
};

/// The lidar that "sim:?NAME=VALUE&..." describes, at a port as that of
/// serve_alone(). Fails with bad_option if this is no
/// setup, with bad_file if the world or the path is none, or with system; the subject has the reason.
[[nodiscard]] G4LIDAR_API result<simulated_source> open_simulated(std::string_view source);

}  // namespace g4lidar::sim
