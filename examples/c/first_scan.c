/* SPDX-License-Identifier: MIT */
/* Five revolutions of a G4, in C: the program in docs/install.md. */
#include <g4lidar.h>
#include <stdio.h>

static int report(const g4lidar_error* why) {
  fprintf(stderr, "%s %s\n", why->message, why->advice); /* what went wrong, and what to try */
  return 1;
}

int main(int count, char** words) {
  g4lidar_error why;
  g4lidar_lidar* lidar;
  const char* device = count > 1 ? words[1] : ""; /* "": the only lidar; "sim:": a simulated one */
  int scans_left = 5;
  int code = 0;
  if (g4lidar_open(device, &lidar, &why)) return report(&why);
  if (g4lidar_start(lidar, &why)) code = report(&why);
  while (code == 0 && scans_left > 0) {
    const g4lidar_scan* scan; /* valid until the next call */
    if (g4lidar_wait_scan(lidar, 2000, &scan, &why)) {
      code = report(&why);
    } else {
      printf("%zu points at %.2f Hz\n", scan->point_count, scan->frequency_hz);
      --scans_left;
    }
  }
  g4lidar_free(lidar); /* stops the motor */
  return code;
}
