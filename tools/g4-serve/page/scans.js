// SPDX-License-Identifier: MIT
// The visible scans: the newest, and older ones as trails.
import { Way, composed, inverse, origin, placed } from './frames.js';

const header_bytes = 16;
const scan_message = 0x10;
const is_whole = 1;
const has_place = 2;
const place_bytes = 28;
const most_scans = 512;
export const colour_count = 256;
/** The range of the last colour, in metres. */
export const colour_range_m = 16;

/** @typedef {import('./frames.js').Pose} Pose */

/**
 * A scan as it was received. Coordinates in metres, in the robot's frame: x, y, x, y, ... `pose` is that of this frame
 * in the map with the number `map`, if it is known.
 * @typedef {{revolution: number, stamp: number, whole: boolean, xy: Float32Array,
 *   colours: Uint8Array, pose: Pose | null, map: number, born: number}} Scan
 */

/** @param {DataView} head @param {number} at @returns {{pose: Pose, map: number}} */
function place_at(head, at) {
  const [x, y, yaw] = [4, 12, 20].map((offset) => head.getFloat64(at + offset, true));
  return { pose: { x, y, yaw }, map: head.getUint32(at, true) };
}

/**
 * @param {ArrayBuffer} message @param {number} born  The time of the picture, in seconds.
 * @returns {Scan | null} Null if it is not a scan.
 */
export function scan_of(message, born) {
  if (message.byteLength < header_bytes) return null;
  const head = new DataView(message);
  const count = head.getUint16(2, true);
  if (head.getUint8(0) !== scan_message) return null;
  const flags = head.getUint8(1);
  const end = header_bytes + 8 * count;
  if (message.byteLength !== end + (flags & has_place ? place_bytes : 0)) return null;
  const xy = new Float32Array(message, header_bytes, 2 * count); // every browser is little-endian
  const colours = new Uint8Array(count);
  for (let i = 0; i < count; i++) {
    // By the square root of the range, for more colours near the lidar.
    const part = Math.sqrt(Math.hypot(xy[2 * i], xy[2 * i + 1]) / colour_range_m);
    colours[i] = Math.min(colour_count - 1, part * colour_count);
  }
  return {
    revolution: head.getUint32(4, true),
    stamp: head.getFloat64(8, true),
    whole: (flags & is_whole) !== 0,
    xy,
    colours,
    ...(flags & has_place ? place_at(head, end) : { pose: null, map: 0 }),
    born,
  };
}

export class Scans {
  constructor() {
    /** @type {Scan[]} The newest is the last. */
    this.shown = [];
    /** The duration of a trail, in seconds. */
    this.trail_s = 0;
    /** The time of the picture, in seconds; it stops while the picture is frozen. */
    this.now = 0;
    this.is_frozen = false;
    /** Whether the picture is in the map: it stays where the walls are, and the robot moves. */
    this.wants_map = false;
    this.way = new Way();
    this.received = 0;
    this.points_received = 0;
    /** Counts changes. */
    this.version = 0;
  }

  /** @returns {Scan | undefined} */
  get newest() {
    return this.shown[this.shown.length - 1];
  }

  /** @param {ArrayBuffer} message @returns {boolean} Whether it was a scan. */
  take(message) {
    const scan = scan_of(message, this.now);
    if (!scan) return false;
    this.received++;
    this.points_received += scan.colours.length;
    if (this.is_frozen) return true;
    if (this.newest && scan.stamp < this.newest.stamp) { // seek to an earlier position
      this.shown.length = 0;
      this.way.clear();
    }
    // What was measured in another map cannot be placed.
    if (this.newest && this.newest.map !== scan.map) this.shown.length = 0;
    this.shown.push(scan);
    if (scan.pose) this.way.add(scan.pose, scan.map);
    if (this.shown.length > most_scans) this.shown.shift(); // the page is hidden
    this.version++;
    return true;
  }

  /** @param {number} seconds  Since the last call. Removes old trails. */
  advance(seconds) {
    if (this.is_frozen) return;
    this.now += seconds;
    let old = 0;
    while (old < this.shown.length - 1 && this.now - this.shown[old].born > this.trail_s) old++;
    if (old > 0) this.shown.splice(0, old);
    // Trails fade with time, and removed ones must disappear.
    if (old > 0 || this.shown.length > 1) this.version++;
  }

  /** Whether the picture is in the map. */
  get is_map() {
    return this.wants_map && Boolean(this.newest?.pose);
  }

  /** The robot of the newest scan, in the frame of the picture. */
  get robot() {
    return (this.is_map && this.newest?.pose) || origin;
  }

  /** @returns {Pose} The map, in the frame of the picture. */
  get map() {
    return this.is_map || !this.newest?.pose ? origin : inverse(this.newest.pose);
  }

  /**
   * The frame of a scan, in the frame of the picture. Without a known motion it is as if the robot had not moved.
   * @param {Scan} scan @returns {Pose}
   */
  frame_of(scan) {
    if (scan === this.newest) return this.robot;
    return scan.pose ? composed(this.map, scan.pose) : origin;
  }

  /** @returns {{x: number, y: number, index: number} | null} The nearest return, in the robot's frame. */
  nearest_return() {
    const xy = this.newest?.xy ?? [];
    let found = null;
    let least = Infinity;
    for (let i = 0; i < xy.length; i += 2) {
      const square = xy[i] * xy[i] + xy[i + 1] * xy[i + 1];
      if (square >= least) continue;
      least = square;
      found = { x: xy[i], y: xy[i + 1], index: i / 2 };
    }
    return found;
  }

  /**
   * The point of the newest scan that is nearest to a place of the picture.
   * @param {{x: number, y: number}} place @param {number} within_m
   * @returns {{x: number, y: number} | null}
   */
  nearest(place, within_m) {
    const xy = this.newest?.xy ?? new Float32Array(0);
    const at = placed(inverse(this.robot), place);
    let found = null;
    let least = within_m;
    for (let i = 0; i < xy.length; i += 2) {
      const distance = Math.hypot(xy[i] - at.x, xy[i + 1] - at.y);
      if (distance > least) continue;
      least = distance;
      found = { x: xy[i], y: xy[i + 1] };
    }
    return found && placed(this.robot, found);
  }

  /**
   * The range of the nearest part of the points of the newest scan, in metres; 0 without points.
   * @param {number} part  1: all.
   */
  range_of(part) {
    const { xy, colours } = this.newest ?? { xy: [], colours: [] };
    const ranges = new Float32Array(colours.length);
    for (let i = 0; i < ranges.length; i++) ranges[i] = Math.hypot(xy[2 * i], xy[2 * i + 1]);
    return ranges.sort()[Math.ceil(part * ranges.length) - 1] ?? 0;
  }
}
