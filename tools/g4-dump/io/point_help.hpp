// SPDX-License-Identifier: MIT
// Parts of the help that several verbs for points share.
#pragma once

namespace g4_tool {

inline constexpr const char* shape_text =
    R"(  --range FROM:TO  A point without a return has the range 0: it is left out unless FROM is 0.
  --fov, --ignore  Directions in the frame of the output, both ends included: 350:10 is 20 degrees
                   around 0; in the robot frame -90:90 is the half in front.
  --mask FILE      Lines "polygon x1 y1 x2 y2 x3 y3 ...": corners in meters, x ahead, y to the left,
                   whatever --frame is; # begins a comment.
  --speckle[=LIMITS]  A return is left out if fewer than count of the samples up to window before
                   and after it are returns near it: within near meters, or within ratio times its
                   range. The default is window=2,count=1,near=0.05,ratio=0.05.
  --edges[=LIMITS]  A return is left out if, up to window samples away, a nearer one is on one side
                   and a farther one on the other, and the lines to both make an angle below angle
                   degrees with the beam. The default is window=1,angle=5.
  --near[=LIMITS]  A direction without return is flagged may_be_too_near if in the last revolutions
                   a return came from there from less than twice the shortest range of the lidar,
                   and none that is farther since. The default is shortest=0.28,revolutions=3;
                   revolutions=0: until a return comes from there.
  --frame vendor   Angles grow clockwise seen from above, 0 at the cable, in [0, 360).
  --frame robot    Angles grow counter-clockwise, 0 ahead (opposite the cable), in [-180, 180).
  --time abs       Since 1970, by the clock of the computer (default).
  --time mono      Time of the monotonic clock.
  --time zero      Since the first record.
  --time delta     Since the previous record that was written.

Raw bytes have no times: times are counted from the first sample with --sample-rate; abs and
mono are refused.)";

inline constexpr const char* ending_text =
    R"(From a lidar or a pipe, OUT is created (or replaced) with the first record and grows. From a
file, OUT appears when everything is written. ^C stops the lidar; the records so far are
written. With --on-loss reconnect or wait the command waits for a lost lidar, until --idle ends
it; with wait also for one that is not connected yet. For files, -d counts the times of the
points.)";

inline constexpr const char* point_columns =
    R"(Columns of csv:
  scan       number of the revolution
  angle_deg  direction of the point
  range_mm   distance (range_m with --unit m); 0: no return, which is not free space
  time_ns    time of the point

More columns may follow in later versions. jsonl has the same names, and no_return and too_near
(below 100 mm: not reliable); not_deskewed, unlikely, isolated, veiling and may_be_too_near only if
they are true. text is for people.)";

inline constexpr const char* scan_columns =
    R"(A record is a revolution, with flags if data is missing; with --partial also a piece of one.

Columns of csv:
  scan         number of the revolution
  time_ns      time of its first point
  points       number of points
  returns      number of points with a return
  partial      true or false
  why          why it is partial, joined by +: start_missing, end_missing, data_lost, turn_short,
               crc_mismatch, and where a zero packet was lost start_by_angle, end_by_angle
  turned_deg   angle between the first and the last point, about 360
  reported_hz  scan frequency as the lidar reports it; empty if unknown
  measured_hz  scan frequency as measured; empty if unknown

More columns may follow in later versions. jsonl: an object with the same names, and all points
in arrays: angle_deg, range_mm or range_m, time_ns.)";

}  // namespace g4_tool
