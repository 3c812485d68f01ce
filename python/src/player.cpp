// SPDX-License-Identifier: MIT
// Lidar.player: how a recording, or raw bytes in a file, are played.
#include <nanobind/stl/optional.h>

#include <cstdint>
#include <optional>

#include "live_lidar.hpp"

namespace g4lidar::python {
namespace {

using namespace nb::literals;

constexpr double ns_per_s = 1e9;

/// The class Player: it keeps its lidar.
struct lidar_player {
  nb::object lidar;

  /// See live_lidar::with_player().
  template <class Call>
  auto call(const Call& what) const {
    return nb::cast<live_lidar&>(lidar).with_player(what);
  }
};

void pause(const lidar_player& played, bool pauses) {
  played.call([pauses](player& of) -> result<void> {
    of.pause(pauses);
    return {};
  });
}

void seek(const lidar_player& played, double seconds) {
  const std::int64_t position_ns = in_ns(seconds);
  played.call([position_ns](player& of) { return of.seek(position_ns); });
}

bool is_paused(const lidar_player& on) {
  return on.call([](player& of) { return result<bool>(of.is_paused()); });
}

}  // namespace

void bind_player(nb::module_& module, nb::class_<live_lidar>& bound) {
  nb::class_<lidar_player>(
      module, "Player",
      "Plays the file of a lidar: Lidar.player. Any thread. After Lidar.close() everything raises "
      "Gone.")
      .def("pause", &pause, "pauses"_a = true,
           "While it is paused nothing is read: try_scan() waits until its timeout, a loop without "
           "limit.")
      .def_prop_ro("is_paused", &is_paused)
      .def_prop_rw(
          "speed",
          [](const lidar_player& on) {
            return on.call([](player& bound) { return result<double>(bound.speed()); });
          },
          [](const lidar_player& played, double speed) {
            played.call([speed](player& bound) { return bound.set_speed(speed); });
          },
          "1: as fast as it was recorded; 0: as fast as it is read; at most 1000. Raises "
          "BadOption.")
      .def(
          "set_loop",
          [](const lidar_player& played, bool loops) {
            played.call([loops](player& bound) -> result<void> {
              bound.set_loop(loops);
              return {};
            });
          },
          "loops"_a, "Whether it begins again at its end; the times continue.")
      .def("seek", &seek, "seconds"_a,
           "Continues at this time since the beginning of the file, also after its end; a time "
           "after "
           "the end is the end. The unfinished revolution is dropped; a started scan goes on. "
           "Raises BadOption if the lidar is recorded.")
      .def_prop_ro(
          "position",
          [](const lidar_player& on) {
            return on.call([](player& bound) {
              return result<double>(static_cast<double>(bound.position_ns()) / ns_per_s);
            });
          },
          "Seconds since the beginning of the file.")
      .def_prop_ro(
          "length",
          [](const lidar_player& on) {
            return on.call([](player& bound) {
              return result<double>(static_cast<double>(bound.length_ns()) / ns_per_s);
            });
          },
          "From the first to the last byte, in seconds.");
  bound.def_prop_ro(
      "player",
      [](nb::object self) -> std::optional<lidar_player> {
        if (!nb::cast<live_lidar&>(self).has_player()) return std::nullopt;
        return lidar_player{std::move(self)};
      },
      "Plays a recording, or raw bytes in a file; None for every other lidar, and after close().");
}

}  // namespace g4lidar::python
