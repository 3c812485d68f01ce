// SPDX-License-Identifier: MIT
// Which models of the table fit what is known about a lidar.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/model_choice.hpp"

namespace g4lidar {

/// The rates of all models: that of a G4, then those with the most users.
inline constexpr std::array<std::uint32_t, 5> usual_rates{230'400, 115'200, 128'000, 512'000,
                                                          153'600};

/// What is known about a lidar at a port.
struct lidar_signs {
  std::uint32_t baud = 0;  ///< Of the port.
  bool is_baud_certain =
      true;  ///< False: that behind a network bridge, as far as the user knows it.
  std::size_t sample_bytes = 0;  ///< 0: no packets were received.
  std::uint8_t id = 0;           ///< As it reported by a reply or after power-on; 0: not.
  std::uint8_t ct_id_low_bits =
      0;  ///< As its CT bytes state, in a revolution whose CRC fits; 0: not.
  std::uint32_t sample_rate_hz = 0;  ///< As measured; 0: not.
  std::uint32_t frequency_chz =
      0;  ///< As zero packets report it, if the rate follows from it. See may_measure().
  presence answers = presence::unknown;  ///< Whether it answered a command.
};

/// The models that `seen` may come from, the usual one first: all that agree with the number, the size of
/// samples, the baud rate and the kind of connection. The baud rate is ignored where no model agrees with
/// it and the number, where no model has it, or where it is not certain and the sample rate is another one; then the CT bytes, which other devices use
/// otherwise. Models with the number as their usual one come before those that some devices report it of.
/// Empty if there is none. *Allocates.*
[[nodiscard]] std::vector<const model*> models_that_fit(const lidar_signs& seen);

/// As models_that_fit(), and without those that do not measure so often, if another one does. *Allocates.*
[[nodiscard]] std::vector<const model*> models_at_rate(const lidar_signs& seen);

/// The models with samples of this size, whatever their numbers and baud rates; those that answer so, and those that
/// measure so often, if there are any. Never empty for 0, 2, 3 and 4 bytes. *Allocates.*
[[nodiscard]] std::vector<const model*> models_of_size(const lidar_signs& seen);

/// The models of a device that has answered with its number. Samples that are certain are right where they contradict it; a
/// number that no model has decides nothing. Never empty. *Allocates.*
[[nodiscard]] std::vector<const model*> models_of_answer(lidar_signs seen,
                                                         bool are_samples_certain);

/// Whether a lidar of this model has such a baud rate, as far as bytes arrive. *Pure.*
[[nodiscard]] bool has_rate(const model& row, std::uint32_t baud) noexcept;
/// Its baud rates, the usual one first. *Pure.*
[[nodiscard]] inline std::span<const std::uint32_t> rates_of(const model& row) noexcept {
  return std::span(row.bauds).first(row.bauds[1] != 0 ? 2 : 1);
}

/// Whether a lidar that reports `number` is another one than `stated`, and nothing else than the number will show it. Of a
/// two-way one: a model with this number has samples of the same size, and this rate (0: not known). Of a one-way one: as
/// one_way_other_than(). *Pure.*
[[nodiscard]] bool is_surely_another(const model& stated, std::uint8_t number,
                                     std::uint32_t baud) noexcept;

/// Whether it has the sample rate that was seen. See may_measure(). *Pure.*
[[nodiscard]] inline bool may_measure(const model& row, const lidar_signs& seen) noexcept {
  return may_measure(row, seen.sample_rate_hz, seen.frequency_chz);
}

/// Whether a two-way model may send such packets: one fits, and with the sample rate, unless only one-way
/// models have that. *Allocates.*
[[nodiscard]] bool may_be_two_way(const lidar_signs& seen);

}  // namespace g4lidar
