// SPDX-License-Identifier: MIT
// An ignored result of flush() and close() hides that a recording is incomplete.
// expect: ignoring return value.*flush
// expect: ignoring return value.*close
#include "g4lidar/recording/writer.hpp"

bool misuse(g4lidar::recording_writer& writer) {
#ifdef MISUSE
  writer.flush();
  writer.close();
  return true;
#else
  return writer.flush().has_value() && writer.close().has_value();
#endif
}
