// SPDX-License-Identifier: MIT
// The visible scans: the newest, and older ones as trails.

const header_bytes = 16;
const scan_message = 0x10;
const most_scans = 512;
export const colour_count = 256;
/** The range of the last colour, in metres. */
export const colour_range_m = 16;

/**
 * A scan as it was received. Coordinates in metres, in the robot's frame: x, y, x, y, ...
 * @typedef {{revolution: number, stamp: number, whole: boolean, xy: Float32Array,
 *   colours: Uint8Array, born: number}} Scan
 */

/**
 * @param {ArrayBuffer} message @param {number} born  The time of the picture, in seconds.
 * @returns {Scan | null} Null if it is not a scan.
 */
export function scan_of(message, born) {
  if (message.byteLength < header_bytes) return null;
  const head = new DataView(message);
  const count = head.getUint16(2, true);
  if (head.getUint8(0) !== scan_message) return null;
  if (message.byteLength !== header_bytes + 8 * count) return null;
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
    whole: (head.getUint8(1) & 1) !== 0,
    xy,
    colours,
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
    if (this.newest && scan.stamp < this.newest.stamp) this.shown.length = 0; // seek to an earlier position
    this.shown.push(scan);
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

  /**
   * The point of the newest scan that is nearest to a place.
   * @param {{x: number, y: number}} place @param {number} within_m
   * @returns {{x: number, y: number} | null}
   */
  nearest(place, within_m) {
    const xy = this.newest?.xy ?? new Float32Array(0);
    let found = null;
    let least = within_m;
    for (let i = 0; i < xy.length; i += 2) {
      const distance = Math.hypot(xy[i] - place.x, xy[i + 1] - place.y);
      if (distance > least) continue;
      least = distance;
      found = { x: xy[i], y: xy[i + 1] };
    }
    return found;
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
