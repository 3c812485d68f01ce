// SPDX-License-Identifier: MIT
// The visible scans: the newest, and older ones as trails.
import { Way, composed, inverse, origin, placed } from './frames.js';
import { message_of } from './message.js';

const most_scans = 512;

/** @typedef {import('./frames.js').Pose} Pose */
/** @typedef {import('./message.js').Message} Message */
/** @typedef {import('./colours.js').Colours} Colours */

/**
 * A scan as it was received, the colours of its points, and the time of the picture then, in seconds.
 * @typedef {Message & {colours: ReturnType<Colours['of']>, born: number}} Scan
 */

export class Scans {
  /** @param {Colours} colours */
  constructor(colours) {
    this.colours = colours;
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

  /** @param {ArrayBuffer} data @returns {boolean} Whether it was a scan. */
  take(data) {
    const message = message_of(data);
    if (!message) return false;
    this.received++;
    this.points_received += message.count;
    if (this.is_frozen) return true;
    const scan = { ...message, colours: this.colours.of(message), born: this.now };
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

  /** @param {number} seconds  Since the last call. Removes old trails; of a frozen picture those that are switched off. */
  advance(seconds) {
    if (!this.is_frozen) this.now += seconds;
    let old = 0;
    while (old < this.shown.length - 1 && this.now - this.shown[old].born >= this.trail_s) old++;
    if (old > 0) this.shown.splice(0, old);
    // Trails fade with time, and removed ones must disappear.
    if (old > 0 || (this.shown.length > 1 && !this.is_frozen)) this.version++;
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
    const { xy, count } = this.newest ?? { xy: [], count: 0 };
    const ranges = new Float32Array(count);
    for (let i = 0; i < ranges.length; i++) ranges[i] = Math.hypot(xy[2 * i], xy[2 * i + 1]);
    return ranges.sort()[Math.ceil(part * ranges.length) - 1] ?? 0;
  }
}
