// SPDX-License-Identifier: MIT
// As which model a source is read, from what that is known, and what contradicts it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/api.hpp"

namespace g4lidar {

/// From what the model of a source is known.
enum class known_by : std::uint8_t {
  nothing,  ///< It is not: the source is read as a G4, or as a model with the baud rate, until its packets show more.
  user,     ///< lidar_options::model, or the name of the source.
  recording,  ///< The recording states it, or the simulated lidar.
  number,  ///< The number that the device reports, with the baud rate where several models have it.
  samples,  ///< The size of its samples, and the rates: other models may send the same.
};

/// What is known about the model of a source. A view: its spans are valid as long as the lidar or the connector.
struct recognition {
  /// As which it is read. Valid forever; null: its port could not be opened yet.
  const g4lidar::model* model = nullptr;
  known_by by = known_by::nothing;
  /// All models between which the bytes do not decide, `model` first: an X2 and an X3 send the same.
  std::span<const g4lidar::model* const> candidates{};
  std::uint8_t number = 0;  ///< Of its model, as the device reports it; 0: it does not.
  std::uint32_t baud = 0;   ///< Of the line; 0: not known.
  /// Whether it should answer, and only sends: it is read as a lidar that answers nothing.
  bool is_silent = false;
  /// Whether it was scanning when it was opened, and has been stopped.
  bool was_stopped = false;
  /// Whether its network bridge negotiates as telnet does: it doubles each byte FF, which damages packets.
  bool speaks_telnet = false;
  /// Whether its packets have shown that samples have the size of the model, since the driver began to read them so.
  bool has_shown_samples = false;
};

/// The name of how a model is known, for programs: "number". Valid forever. *Pure.*
[[nodiscard]] G4LIDAR_API std::string_view name_of(known_by what) noexcept;

/// What contradicts `what`, in sentences for the user. The device reports another number, or one that no known model has.
/// Its model is not known to have this baud rate; where only the number names the model, this waits for its first packets
/// (has_shown_samples). It should answer, and does not. Its bridge changes bytes. Empty: nothing does. *Allocates.*
[[nodiscard]] G4LIDAR_API std::string contradictions_of(const recognition& what);

}  // namespace g4lidar
