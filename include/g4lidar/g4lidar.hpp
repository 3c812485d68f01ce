// SPDX-License-Identifier: MIT
// What most programs need, in one include: all headers of this directory except eigen, lidar_service and ostream, and
// bulk_decoder, deskew, outliers, plausibility, source, too_near, twist_estimator and wall_clock.
#pragma once

#include "g4lidar/background_reader.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/wall_clock.hpp"
#include "g4lidar/discovery.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/filter.hpp"
#include "g4lidar/filter/outliers.hpp"
#include "g4lidar/filter/plausibility.hpp"
#include "g4lidar/filter/too_near.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/lidar_event.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/merge.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/motion/deskew.hpp"
#include "g4lidar/motion/twist_estimator.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/recording/bulk_decoder.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "g4lidar/settings.hpp"
#include "g4lidar/transport/source.hpp"
#include "g4lidar/version.hpp"
