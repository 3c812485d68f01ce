// SPDX-License-Identifier: MIT
// Draws the radar: rings, robot and ruler on one canvas, and above it the points as pixels.
import { placed } from './frames.js';

/** @typedef {import('./colours.js').Colours} Colours */
/** @typedef {import('./view.js').View} View */
/** @typedef {import('./scans.js').Scan} Scan */
/** @typedef {import('./scans.js').Scans} Scans */
/** @typedef {import('./ruler.js').Ruler} Ruler */
/** @typedef {import('./frames.js').Pose} Pose */

const most_pixels_per_point = 2; // more pixels per CSS pixel are not visible
const ring_pixels = 70;
/** The heights of the texts above and below the labels of the rings. */
const top_pixels = 36;
const bottom_pixels = 76;
/** Half the height of a label. */
const label_pixels = 8;
const newest_alpha = 255;
const trail_alpha = 150;

/** The colours of the style sheet. */
function theme_now() {
  const style = getComputedStyle(document.documentElement);
  /** @param {string} name */
  const colour = (name) => style.getPropertyValue(name).trim();
  return {
    background: colour('--background'),
    ring: colour('--ring'),
    text: colour('--ring_text'),
    axis_x: colour('--axis_x'),
    axis_y: colour('--axis_y'),
    ruler: colour('--ruler'),
    way: colour('--way'),
    nearest: colour('--nearest'),
  };
}

/** @param {number} scale @returns {number} The distance between two rings, in metres. */
export function ring_distance(scale) {
  const wanted = ring_pixels / scale;
  const tens = 10 ** Math.floor(Math.log10(wanted));
  return [1, 2, 5, 10].map((n) => n * tens).find((m) => m >= wanted * 0.999) ?? wanted;
}

export class Radar {
  /** @param {HTMLCanvasElement} grid @param {HTMLCanvasElement} points @param {View} view @param {Colours} colours */
  constructor(grid, points, view, colours) {
    this.grid = grid;
    this.points = points;
    this.view = view;
    this.paper = /** @type {CanvasRenderingContext2D} */ (grid.getContext('2d'));
    this.screen = /** @type {CanvasRenderingContext2D} */ (points.getContext('2d'));
    this.picture = this.screen.createImageData(1, 1);
    this.pixels = new Uint32Array(1);
    this.ratio = 1;
    /**
     * Where the labels of the rings are, in CSS pixels.
     * @type {{text: string, left: number, top: number, width: number, height: number}[]}
     */
    this.labels = [];
    this.theme = theme_now();
    this.colours = colours;
    this.table = colours.table;
  }

  use_theme() {
    this.theme = theme_now();
    this.view.version++;
  }

  /** Follows the size of the window. @param {number} width @param {number} height */
  resize(width, height) {
    this.ratio = Math.min(window.devicePixelRatio || 1, most_pixels_per_point);
    for (const canvas of [this.grid, this.points]) {
      canvas.width = Math.max(1, Math.round(width * this.ratio));
      canvas.height = Math.max(1, Math.round(height * this.ratio));
    }
    this.picture = this.screen.createImageData(this.points.width, this.points.height);
    this.pixels = new Uint32Array(this.picture.data.buffer);
    this.view.resize(width, height);
  }

  /** @param {Scans} scans  The trails, the oldest first, and the newest scan above them. */
  draw_points(scans) {
    this.pixels.fill(0);
    this.table = this.colours.table;
    const last = scans.shown.length - 1;
    for (let i = 0; i < last; i++) {
      const age = (scans.now - scans.shown[i].born) / Math.max(scans.trail_s, 0.001);
      const alpha = trail_alpha * (1 - age);
      if (alpha < 1) continue;
      this.#draw_scan(scans.shown[i], scans.frame_of(scans.shown[i]), alpha, Math.round(2 * this.ratio));
    }
    if (last >= 0) this.#draw_scan(scans.shown[last], scans.robot, newest_alpha, Math.round(3 * this.ratio));
    this.screen.putImageData(this.picture, 0, 0);
  }

  /**
   * @param {Scan} scan @param {Pose} frame  Where its frame is in the picture.
   * @param {number} alpha @param {number} size  Of a point, in pixels.
   */
  #draw_scan(scan, frame, alpha, size) {
    const { view, ratio, pixels, table } = this;
    const colours = scan.colours[this.colours.way];
    const cosine = Math.cos(frame.yaw);
    const sine = Math.sin(frame.yaw);
    const width = this.points.width;
    const scale = view.scale * ratio;
    const half = (size - 1) / 2;
    const left = view.column(frame.y) * ratio - half;
    const top = view.row(frame.x) * ratio - half;
    const last_column = width - size;
    const last_row = this.points.height - size;
    const opaque = Math.round(alpha) << 24;
    const { xy } = scan;
    for (let i = 0, k = 0; k < xy.length; i++, k += 2) {
      const column = Math.round(left - (sine * xy[k] + cosine * xy[k + 1]) * scale);
      const row = Math.round(top - (cosine * xy[k] - sine * xy[k + 1]) * scale);
      if (column < 0 || row < 0 || column > last_column || row > last_row) continue;
      const pixel = table[colours[i]] | opaque;
      let at = row * width + column;
      for (let line = 0; line < size; line++, at += width) {
        for (let n = 0; n < size; n++) pixels[at + n] = pixel;
      }
    }
  }

  /** @param {Ruler} ruler @param {Scans} scans  Rings, way, robot, nearest return and ruler. */
  draw_grid(ruler, scans) {
    const { paper, theme, view } = this;
    paper.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    paper.fillStyle = theme.background;
    paper.fillRect(0, 0, view.width, view.height);
    this.labels = [];
    const { robot } = scans;
    this.#draw_rings(view.column(robot.y), view.row(robot.x));
    this.#draw_way(scans);
    this.#draw_nearest(scans);
    this.#draw_robot(robot);
    this.#draw_ruler(ruler);
  }

  /** @param {Scans} scans */
  #draw_way(scans) {
    if (!scans.newest?.pose) return;
    const { paper, view } = this;
    const poses = [...scans.way.poses, scans.newest.pose].map((pose) => placed(scans.map, pose));
    paper.lineWidth = 2;
    paper.strokeStyle = this.theme.way;
    paper.beginPath();
    for (const at of poses) paper.lineTo(view.column(at.y), view.row(at.x));
    paper.stroke();
  }

  /** @param {Scans} scans */
  #draw_nearest(scans) {
    const found = scans.nearest_return();
    if (!found) return;
    const { paper, view } = this;
    const at = placed(scans.robot, found);
    const [column, row] = [view.column(at.y), view.row(at.x)];
    paper.lineWidth = 1.5;
    this.#lines(this.theme.nearest, [[view.column(scans.robot.y), view.row(scans.robot.x), column, row]]);
    paper.beginPath();
    paper.arc(column, row, 7, 0, 2 * Math.PI);
    paper.stroke();
  }

  /** @param {number} column @param {number} row  Of the lidar. */
  #draw_rings(column, row) {
    const { paper, theme, view } = this;
    const step = ring_distance(view.scale);
    const dx = Math.max(-column, column - view.width, 0);
    const dy = Math.max(-row, row - view.height, 0);
    const farthest = Math.hypot(Math.max(column, view.width - column),
      Math.max(row, view.height - row));
    // The labels are on the line from the lidar to the end of the farther side, or to the middle of the picture.
    const is_inside = dx === 0 && dy === 0;
    const end_column = is_inside ? (column <= view.width / 2 ? view.width : 0) : view.width / 2;
    const first_row = top_pixels + label_pixels;
    const last_row = view.height - bottom_pixels - label_pixels;
    const end_row = is_inside ? (row >= view.height / 3 ? first_row : last_row) : view.height / 2;
    const away = Math.hypot(end_column - column, end_row - row);
    const right = (end_column - column) / away;
    const down = (end_row - row) / away;
    paper.lineWidth = 1;
    this.#lines(theme.ring, [[column, 0, column, view.height], [0, row, view.width, row]]);
    paper.font = '12px system-ui, "DejaVu Sans", sans-serif';
    paper.textAlign = 'center';
    paper.textBaseline = 'middle';
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    for (let n = Math.max(1, Math.floor(Math.hypot(dx, dy) / view.scale / step));
      n * step * view.scale <= farthest; n++) {
      const radius = n * step * view.scale;
      paper.beginPath();
      paper.arc(column, row, radius, 0, 2 * Math.PI);
      paper.stroke();
      const label_row = row + down * radius;
      if (label_row < first_row || label_row > last_row) continue;
      this.#label(`${(n * step).toFixed(digits)} m`, column + right * radius, label_row);
    }
  }

  /** @param {string} style @param {number[][]} lines  Columns and rows of both ends. */
  #lines(style, lines) {
    this.paper.strokeStyle = style;
    this.paper.beginPath();
    for (const [from_column, from_row, to_column, to_row] of lines) {
      this.paper.moveTo(from_column, from_row);
      this.paper.lineTo(to_column, to_row);
    }
    this.paper.stroke();
  }

  /** @param {string} text @param {number} column @param {number} row */
  #label(text, column, row) {
    const width = this.paper.measureText(text).width + 6;
    this.paper.fillStyle = this.theme.background;
    this.paper.fillRect(column - width / 2, row - label_pixels, width, 2 * label_pixels);
    this.paper.fillStyle = this.theme.text;
    this.paper.fillText(text, column, row);
    this.labels.push({ text, left: column - width / 2, top: row - label_pixels, width, height: 2 * label_pixels });
  }

  /** @param {Pose} robot  A triangle that points ahead, and the axes. */
  #draw_robot(robot) {
    const { paper, theme, view } = this;
    paper.save();
    paper.translate(view.column(robot.y), view.row(robot.x));
    paper.rotate(-robot.yaw);
    paper.lineWidth = 2;
    this.#lines(theme.axis_x, [[0, 0, 0, -26]]);
    this.#lines(theme.axis_y, [[0, 0, -26, 0]]);
    paper.fillStyle = theme.text;
    paper.beginPath();
    paper.moveTo(0, -10);
    paper.lineTo(7, 7);
    paper.lineTo(-7, 7);
    paper.fill();
    paper.restore();
  }

  /** @param {Ruler} ruler */
  #draw_ruler(ruler) {
    const { paper, theme, view } = this;
    const ends = [ruler.from, ruler.to].filter((end) => end !== null)
      .map((end) => [view.column(end.y), view.row(end.x)]);
    const lines = ends.length === 2 ? [ends.flat()] : [];
    const [column, row] = [view.width / 2, view.height / 2];
    if (ruler.shows_middle) {
      lines.push([column - 12, row, column + 12, row], [column, row - 12, column, row + 12]);
    }
    paper.lineWidth = 2;
    this.#lines(theme.ruler, lines);
    for (const [end_column, end_row] of ends) {
      paper.beginPath();
      paper.arc(end_column, end_row, 6, 0, 2 * Math.PI);
      paper.stroke();
    }
  }
}
