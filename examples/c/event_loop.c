/* SPDX-License-Identifier: MIT */
/* A G4 in an event loop together with other events, here standard input, with reconnecting and without
 * a thread. Ends at a line on standard input, or at its end.
 *   c_event_loop [DEVICE] */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <g4lidar.h>
#include <poll.h>
#include <stdio.h>
#include <unistd.h>

static int report(const g4lidar_error* why) {
  fprintf(stderr, "%s %s\n", why->message, why->advice);
  return 1;
}

/* Takes every scan and event that has arrived. 0, or 1 at the end. */
static int take_scans(g4lidar_lidar* lidar) {
  g4lidar_error why;
  g4lidar_event event;
  const g4lidar_scan* scan;
  while (g4lidar_try_scan(lidar, 0, &scan, &why) == G4LIDAR_OK) {
    printf("scan %u: %zu points\n", (unsigned)scan->revolution, scan->point_count);
  }
  while (g4lidar_next_event(lidar, &event) == G4LIDAR_OK) {
    printf("%s\n", g4lidar_event_name(event.kind));
  }
  fflush(stdout);
  return why.is_fatal ? report(&why) : 0;
}

static int run(g4lidar_lidar* lidar) {
  g4lidar_error why;
  if (g4lidar_start(lidar, &why)) return report(&why);
  while (1) {
    struct pollfd waiting[2] = {{STDIN_FILENO, POLLIN, 0}, {-1, POLLIN, 0}};
    waiting[1].fd = g4lidar_descriptor(lidar);
    if (poll(waiting, 2, g4lidar_poll_timeout_ms(lidar)) < 0 && errno != EINTR) {
      perror("poll");
      return 1;
    }
    if (waiting[0].revents != 0) return 0;
    if (take_scans(lidar) != 0) return 1;
  }
}

int main(int count, char** words) {
  g4lidar_error why;
  g4lidar_lidar* lidar;
  g4lidar_options options;
  int code;
  g4lidar_options_init(&options, sizeof options);
  options.device = count > 1 ? words[1] : "";
  options.reconnect = true;
  if (g4lidar_open_with(&options, &lidar, &why)) return report(&why);
  code = run(lidar);
  g4lidar_free(lidar); /* stops the motor */
  return code;
}
