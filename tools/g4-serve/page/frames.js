// SPDX-License-Identifier: MIT
// Poses in the plane: where a frame is in another one. x and y in metres, yaw counter-clockwise in radians.

/** @typedef {{x: number, y: number, yaw: number}} Pose */
/** @typedef {import('./view.js').Place} Place */

/** @type {Pose} */
export const origin = { x: 0, y: 0, yaw: 0 };

/** @param {Pose} pose @param {Place} at  In the frame of `pose`. @returns {Place} In the frame around it. */
export function placed(pose, at) {
  const cosine = Math.cos(pose.yaw);
  const sine = Math.sin(pose.yaw);
  return { x: pose.x + cosine * at.x - sine * at.y, y: pose.y + sine * at.x + cosine * at.y };
}

/** @param {Pose} pose @returns {Pose} Where the frame around it is, seen from it. */
export function inverse(pose) {
  const at = placed({ x: 0, y: 0, yaw: -pose.yaw }, pose);
  return { x: -at.x, y: -at.y, yaw: -pose.yaw };
}

/** @param {Pose} a @param {Pose} b  In the frame of `a`. @returns {Pose} */
export function composed(a, b) {
  return { ...placed(a, b), yaw: a.yaw + b.yaw };
}

/** @param {Place} at @returns {number} Degrees: 0 is ahead, positive to the left. */
export function bearing_deg(at) {
  return (Math.atan2(at.y, at.x) * 180) / Math.PI;
}

const way_step_m = 0.05;
const most_of_way = 4096;

/** The way driven in one map, without the newest pose. */
export class Way {
  constructor() {
    /** @type {Pose[]} */
    this.poses = [];
    this.map = 0;
  }

  clear() {
    this.poses.length = 0;
  }

  /** @param {Pose} pose @param {number} map */
  add(pose, map) {
    if (map !== this.map) this.clear();
    this.map = map;
    const last = this.poses[this.poses.length - 1];
    if (last && Math.hypot(pose.x - last.x, pose.y - last.y) < way_step_m) return;
    this.poses.push(pose);
    if (this.poses.length <= most_of_way) return;
    // The older half keeps every second pose.
    this.poses = this.poses.filter((_, i) => i > most_of_way / 2 || i % 2 === 0);
  }
}
