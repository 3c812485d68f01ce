/* SPDX-License-Identifier: MIT */
/* A test of a program without a lidar: does it find a G4 again that was unplugged? In virtual time, so
 * that ten seconds take a few milliseconds. */
#include <g4lidar.h>
#include <stdio.h>

static int report(const g4lidar_error* why) {
  fprintf(stderr, "%s %s\n", why->message, why->advice);
  return 1;
}

/* The nearest obstacle of a scan in metres: filtered, and in a grid as for SLAM. No return is not free space: for an
   alarm see near_options of g4lidar_shaper_options. */
static float nearest_m(g4lidar_shaper* shaper, const g4lidar_scan* scan) {
  static float ranges_m[360];
  size_t count = 0;
  const g4lidar_point* kept;
  float nearest = 1e9F;
  size_t i;
  g4lidar_shaper_shape(shaper, scan->points, scan->point_count, scan->is_piece, NULL, 0);
  kept = g4lidar_shaper_for_grid(shaper, &count);
  g4lidar_fill_grid(kept, count, NULL, ranges_m, 360);
  for (i = 0; i < 360; ++i) {
    if (ranges_m[i] < nearest) nearest = ranges_m[i]; /* false for NaN */
  }
  return nearest;
}

int main(void) {
  g4lidar_error why;
  g4lidar_simulator* simulator;
  g4lidar_lidar* lidar = NULL;
  g4lidar_shaper* shaper;
  g4lidar_filter_options filter;
  g4lidar_shaper_options shape;
  g4lidar_simulator_options simulated;
  g4lidar_options options;
  g4lidar_event event;
  int whole = 0;
  int reconnects = 0;
  g4lidar_simulator_options_init(&simulated, sizeof simulated);
  simulated.setup = "sim:?seed=7&fault=unplug@5s%2B2s"; /* after 5 s, for 2 s */
  simulated.virtual_time = true;
  if (g4lidar_simulator_create(&simulated, &simulator, &why)) return report(&why);
  g4lidar_filter_options_init(&filter, sizeof filter);
  filter.least_range_mm = 150.0F;
  g4lidar_shaper_options_init(&shape, sizeof shape);
  shape.filter = &filter;
  if (g4lidar_shaper_create(&shape, &shaper, &why)) return report(&why);
  g4lidar_options_init(&options, sizeof options);
  options.reconnect = true;
  if (g4lidar_open_simulated(simulator, &options, &lidar, &why) || g4lidar_start(lidar, &why)) {
    g4lidar_free(lidar);
    g4lidar_shaper_free(shaper);
    g4lidar_simulator_free(simulator);
    return report(&why);
  }
  while (g4lidar_simulator_get_state(simulator)->time_ns < 10000000000LL) {
    const g4lidar_scan* scan;
    if (g4lidar_try_scan(lidar, 500, &scan, &why) == G4LIDAR_OK) {
      whole += scan->is_whole;
      if (whole == 1) printf("the nearest obstacle is %.2f m away\n", nearest_m(shaper, scan));
    } else if (why.is_fatal) {
      break;
    }
    while (g4lidar_next_event(lidar, &event) == G4LIDAR_OK) {
      printf("%s\n", g4lidar_event_name(event.kind));
      reconnects += event.kind == G4LIDAR_EVENT_RECONNECTED;
    }
  }
  printf("%d whole scans\n", whole);
  g4lidar_free(lidar);
  g4lidar_shaper_free(shaper);
  g4lidar_simulator_free(simulator);
  return whole > 40 && reconnects == 1 ? 0 : 1;
}
