/* SPDX-License-Identifier: MIT */
/* Records ten revolutions of a G4, then plays the recording and continues it at its middle.
 *   c_record [DEVICE [FILE]] */
#include <g4lidar.h>
#include <stdio.h>

static int report(const g4lidar_error* why) {
  fprintf(stderr, "%s %s\n", why->message, why->advice);
  return 1;
}

static int record(const char* device, g4lidar_recorder* recorder) {
  g4lidar_error why;
  g4lidar_lidar* lidar;
  g4lidar_options options;
  int scans = 0;
  g4lidar_options_init(&options, sizeof options);
  options.device = device;
  options.recorder = recorder;
  if (g4lidar_open_with(&options, &lidar, &why)) return report(&why);
  if (g4lidar_start(lidar, &why) == G4LIDAR_OK) {
    const g4lidar_scan* scan;
    while (scans < 10 && g4lidar_wait_scan(lidar, 5000, &scan, &why) == G4LIDAR_OK) ++scans;
  }
  g4lidar_free(lidar);
  if (why.code != G4LIDAR_OK) return report(&why);
  if (g4lidar_recorder_take_error(recorder, &why) != G4LIDAR_NOTHING) return report(&why);
  if (g4lidar_recorder_close(recorder, &why)) return report(&why);
  printf("%llu bytes recorded\n",
         (unsigned long long)g4lidar_recorder_get_counts(recorder)->bytes_from_device);
  return 0;
}

/* Counts the scans from here to the end. */
static int count_scans(g4lidar_lidar* lidar, int* count) {
  g4lidar_error why;
  const g4lidar_scan* scan;
  *count = 0;
  while (g4lidar_wait_scan(lidar, 5000, &scan, &why) == G4LIDAR_OK) ++*count;
  return why.code == G4LIDAR_END_OF_INPUT ? 0 : report(&why);
}

static int play(const char* file) {
  g4lidar_error why;
  g4lidar_lidar* lidar;
  int all = 0;
  int rest = 0;
  int code = 0;
  if (g4lidar_open_recording(file, NULL, NULL, &lidar, &why)) return report(&why);
  if (g4lidar_start(lidar, &why)) {
    code = report(&why);
  } else {
    const g4lidar_recording_info* info = g4lidar_playback_info(lidar);
    const int64_t middle_ns = (info->last_ns - info->first_ns) / 2;
    code = count_scans(lidar, &all);
    if (code == 0 && g4lidar_seek(lidar, middle_ns, &why)) code = report(&why);
    if (code == 0) code = count_scans(lidar, &rest);
  }
  g4lidar_free(lidar);
  printf("%d scans, %d of them in the second half\n", all, rest);
  return code;
}

int main(int count, char** words) {
  g4lidar_error why;
  g4lidar_recorder* recorder;
  g4lidar_recorder_options options;
  const char* file = count > 2 ? words[2] : "c_record.mcap";
  int code;
  g4lidar_recorder_options_init(&options, sizeof options);
  options.overwrite = true;
  if (g4lidar_recorder_create(file, &options, &recorder, &why)) return report(&why);
  code = record(count > 1 ? words[1] : "", recorder);
  g4lidar_recorder_free(recorder);
  return code != 0 ? code : play(file);
}
