// SPDX-License-Identifier: MIT
// All headers of this directory except eigen, fmt and ostream, in one include.
#pragma once

#include "g4lidar/background_reader.hpp"
#include "g4lidar/bulk_decoder.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/device_information.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/error_code.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/owned_scan.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/settings.hpp"
#include "g4lidar/version.hpp"
#include "g4lidar/wall_clock.hpp"
