// SPDX-License-Identifier: MIT
// The model of a driver's options is a row of the table, not a word: a word may be none of a model.
// expect: (cannot convert|incompatible type|no viable overloaded)
#include "g4lidar/lidar_options.hpp"

g4lidar::lidar_options misuse() {
  g4lidar::lidar_options options;
#ifdef MISUSE
  options.model = "x4";
#else
  options.model = g4lidar::model_named("x4");
#endif
  return options;
}
