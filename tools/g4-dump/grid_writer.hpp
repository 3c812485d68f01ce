// SPDX-License-Identifier: MIT
// Revolutions as ranges at so many directions, the same number for each: --grid.
#pragma once

#include <cstddef>
#include <memory>

#include "point_writer.hpp"

namespace g4_dump {

/// A record for each revolution, with `bins` ranges. Takes points that were shaped for a grid.
[[nodiscard]] std::unique_ptr<point_writer> make_grid_writer(const point_style& style,
                                                             std::size_t bins);

}  // namespace g4_dump
