// SPDX-License-Identifier: MIT
// The visible part of the robot's frame or of the map: x is up, y is left. Pixels are CSS pixels.

const least_scale = 4;
const largest_scale = 4000;
const farthest_m = 60; // from the robot
/** The robot may be so far from the middle, as a part of the picture. */
const follow_part = 0.3;

/** @typedef {{x: number, y: number}} Place In metres. */

export class View {
  constructor() {
    /** The place in the middle, in metres. */
    this.x = 0;
    this.y = 0;
    /** Where the robot is. @type {Place} */
    this.robot = { x: 0, y: 0 };
    /** Pixels per metre. */
    this.scale = 60;
    this.width = 1;
    this.height = 1;
    /** Counts changes. */
    this.version = 0;
    /** Whether the user has chosen the view. */
    this.is_chosen = false;
  }

  /** @param {number} y  The column of a place. */
  column(y) {
    return this.width / 2 - (y - this.y) * this.scale;
  }

  /** @param {number} x  The row of a place. */
  row(x) {
    return this.height / 2 - (x - this.x) * this.scale;
  }

  /** @param {number} column @param {number} row @returns {Place} */
  place(column, row) {
    return {
      x: this.x + (this.height / 2 - row) / this.scale,
      y: this.y + (this.width / 2 - column) / this.scale,
    };
  }

  /** @param {number} width @param {number} height */
  resize(width, height) {
    this.width = width;
    this.height = height;
    this.version++;
  }

  /** @param {number} columns @param {number} rows  The picture moves right and down. */
  pan(columns, rows) {
    this.#look_at(this.x + rows / this.scale, this.y + columns / this.scale);
    this.is_chosen = true;
  }

  /**
   * Zooms around a pixel, which keeps its place.
   * @param {number} factor @param {number} [column] @param {number} [row]
   */
  zoom(factor, column = this.width / 2, row = this.height / 2) {
    const kept = this.place(column, row);
    this.scale = Math.min(largest_scale, Math.max(least_scale, this.scale * factor));
    const moved = this.place(column, row);
    this.#look_at(this.x + kept.x - moved.x, this.y + kept.y - moved.y);
    this.is_chosen = true;
  }

  /** @param {number} range_m  Shows this range around the lidar, which is in the middle. */
  fit(range_m) {
    this.scale = Math.min(this.width, this.height) / 2 / range_m;
    this.#look_at(this.robot.x, this.robot.y);
  }

  /** @param {Place} robot  It has moved: the picture follows when it leaves the middle. */
  follow(robot) {
    if (robot.x === this.robot.x && robot.y === this.robot.y) return;
    this.robot = { x: robot.x, y: robot.y };
    const free = (follow_part * Math.min(this.width, this.height)) / this.scale;
    const away = Math.max(Math.abs(robot.x - this.x), Math.abs(robot.y - this.y));
    if (away > free && !this.is_chosen) this.#look_at(robot.x, robot.y);
    this.version++;
  }

  /** @param {Place} from @param {Place} to  The robot in the frame before, and in another one, which begins. */
  change_frame(from, to) {
    this.robot = { x: to.x, y: to.y };
    this.#look_at(this.x - from.x + to.x, this.y - from.y + to.y);
  }

  /** @param {number} x @param {number} y */
  #look_at(x, y) {
    const { robot } = this;
    this.x = robot.x + Math.min(farthest_m, Math.max(-farthest_m, x - robot.x));
    this.y = robot.y + Math.min(farthest_m, Math.max(-farthest_m, y - robot.y));
    this.version++;
  }
}
