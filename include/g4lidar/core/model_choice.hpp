// SPDX-License-Identifier: MIT
// Which models may send the bytes that were received, and which of them is taken where the bytes do not decide.
#pragma once

#include <cstddef>
#include <cstdint>

#include "g4lidar/core/model.hpp"

namespace g4lidar {

/// Whether a device of the model `row` may send samples of this size, 0: not known. `has_flags`: samples that
/// consist of flags alone were seen. *Pure.*
[[nodiscard]] constexpr bool may_send(const model& row, std::size_t sample_bytes,
                                      bool has_flags) noexcept {
  const sample_layout layout = row.samples.layout;
  return (sample_bytes == 0 || sample_size(layout) == sample_bytes) &&
         (!has_flags || has_sample_flags(layout));
}

/// Whether a lidar of this model may have the sample rate `hz`: at most a tenth from one of its own. 0: not known, and true.
/// `reported_chz`: the frequency in the zero packets, in 0.01 Hz, if `hz` was computed from it: some models report it
/// too low, and then `hz` is too low in the same ratio. 0: `hz` was measured otherwise. *Pure.*
[[nodiscard]] constexpr bool may_measure(const model& row, std::uint32_t hz,
                                         std::uint32_t reported_chz = 0) noexcept {
  const double is_times = reported_chz == 0 ? 1.0
                                            : true_frequency_chz(row, double{1} * reported_chz) /
                                                  (double{1} * reported_chz);
  const double true_hz = is_times * hz;
  if (hz == 0 || is_seen_rate(row, true_hz)) return true;
  for (const sample_rate_entry& own : row.rates.entries) {
    const double off = own.hz > true_hz ? own.hz - true_hz : true_hz - own.hz;
    if (own.hz != 0 && 100.0 * off < 11.0 * own.hz) return true;
  }
  return false;
}

/// The model that is taken where the bytes are those of several: the usual one of those for which `fits` is
/// true, else the first of them; null if there is none. `least`: of_its_layout where their baud rate is not
/// known. Valid forever. *Pure.*
template <class Fits>
[[nodiscard]] constexpr const model* usual_model(Fits fits, usual_kind least) noexcept {
  const model* first = nullptr;
  for (const model& row : models) {
    if (!fits(row)) continue;
    if (row.usual >= least) return &row;
    if (first == nullptr) first = &row;
  }
  return first;
}

}  // namespace g4lidar
