/* SPDX-License-Identifier: MIT */
/* A consumer of g4lidar::c, with the simulated G4. Exit code 0 if it gives a whole scan. */
#include <g4lidar.h>

int main(void) {
  g4lidar_simulator* simulator;
  g4lidar_simulator_options options;
  g4lidar_lidar* lidar;
  const g4lidar_scan* scan;
  int code = 1;
  g4lidar_simulator_options_init(&options, sizeof options);
  options.virtual_time = true;
  if (g4lidar_version_number() !=
      10000 * G4LIDAR_VERSION_MAJOR + 100 * G4LIDAR_VERSION_MINOR + G4LIDAR_VERSION_PATCH) {
    return 1;
  }
  if (g4lidar_simulator_create(&options, &simulator, NULL)) return 1;
  if (g4lidar_open_simulated(simulator, NULL, &lidar, NULL) == G4LIDAR_OK) {
    if (g4lidar_start(lidar, NULL) == G4LIDAR_OK &&
        g4lidar_try_scan(lidar, 2000, &scan, NULL) == G4LIDAR_OK) {
      code = scan->is_whole ? 0 : 1;
    }
    g4lidar_free(lidar);
  }
  g4lidar_simulator_free(simulator);
  return code;
}
