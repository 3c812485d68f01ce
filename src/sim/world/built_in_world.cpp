// SPDX-License-Identifier: MIT
// The flat that the simulated lidar uses as default world.
#include <array>

#include "sim/exact.hpp"

#include "g4lidar/sim/world.hpp"

namespace g4lidar::sim {

namespace {

constexpr std::array walls = std::to_array<wall>({
    // Living room: west, the oblique corner, south, east with the doorway to the hall,
    // north with the door to the kitchen.
    {-2.8, 2.4, -2.8, -1.2},
    {-2.8, -1.2, -1.9, -2.3},
    {-1.9, -2.3, 3.2, -2.3},
    {3.2, -2.3, 3.2, -0.35},
    {3.2, 0.55, 3.2, 2.4},
    {3.2, 2.4, -0.7, 2.4},
    {-1.6, 2.4, -2.8, 2.4},

    // Kitchen: the open door, west, north, east, a refrigerator.
    {-1.6, 2.4, -1.95, 3.22},
    {-2.8, 2.4, -2.8, 5.3},
    {-2.8, 5.3, 0.9, 5.3},
    {0.9, 5.3, 0.9, 2.4},
    {-0.9, 5.3, -0.9, 4.65},
    {-0.9, 4.65, -0.25, 4.65},
    {-0.25, 4.65, -0.25, 5.3},

    // Hall: its far end is 21 m away; a column in the middle.
    {3.2, 1.9, 21.0, 1.9},
    {21.0, 1.9, 21.0, -1.6},
    {21.0, -1.6, 3.2, -1.6},
    {8.0, 0.2, 8.3, 0.2},
    {8.3, 0.2, 8.3, 0.5},
    {8.3, 0.5, 8.0, 0.5},
    {8.0, 0.5, 8.0, 0.2},

    // A sofa at an angle; a cupboard at the north wall.
    {0.6, -1.9, 2.3, -1.5},
    {2.3, -1.5, 2.14, -0.82},
    {2.14, -0.82, 0.44, -1.22},
    {0.44, -1.22, 0.6, -1.9},
    {1.7, 2.4, 1.7, 1.95},
    {1.7, 1.95, 2.9, 1.95},
    {2.9, 1.95, 2.9, 2.4},

    // A pillar, 40 cm thick.
    {-1.2, 0.9, -1.2586, 1.0414},
    {-1.2586, 1.0414, -1.4, 1.1},
    {-1.4, 1.1, -1.5414, 1.0414},
    {-1.5414, 1.0414, -1.6, 0.9},
    {-1.6, 0.9, -1.5414, 0.7586},
    {-1.5414, 0.7586, -1.4, 0.7},
    {-1.4, 0.7, -1.2586, 0.7586},
    {-1.2586, 0.7586, -1.2, 0.9},

    // Two legs of a table, 6 cm thick.
    {-1.23, -0.83, -1.17, -0.83},
    {-1.17, -0.83, -1.17, -0.77},
    {-1.17, -0.77, -1.23, -0.77},
    {-1.23, -0.77, -1.23, -0.83},
    {-0.33, -0.98, -0.27, -0.98},
    {-0.27, -0.98, -0.27, -0.92},
    {-0.27, -0.92, -0.33, -0.92},
    {-0.33, -0.92, -0.33, -0.98},

    // A box at just above the minimum range.
    {0.1, 0.33, 0.3, 0.33},
    {0.3, 0.33, 0.3, 0.43},
    {0.3, 0.43, 0.1, 0.43},
    {0.1, 0.43, 0.1, 0.33},

    // A post of the robot that carries the lidar: too near to be measured.
    {-0.16, -0.08, -0.12, -0.08},
    {-0.12, -0.08, -0.12, -0.04},
    {-0.12, -0.04, -0.16, -0.04},
    {-0.16, -0.04, -0.16, -0.08},
});

}  // namespace

world built_in_world() { return {{walls.begin(), walls.end()}, {0.0, 0.0, 90.0}}; }

}  // namespace g4lidar::sim
