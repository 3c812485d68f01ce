// SPDX-License-Identifier: MIT
// A ruler between two places of the picture.
import { bearing_deg } from './frames.js';

/** @typedef {import('./view.js').Place} Place */

/** @param {Place} from @param {Place} to @returns {{distance_m: number, bearing_deg: number}} */
export function measure(from, to) {
  const way = { x: to.x - from.x, y: to.y - from.y };
  return { distance_m: Math.hypot(way.x, way.y), bearing_deg: bearing_deg(way) };
}

/** @param {Place} from @param {Place} to @returns {string} Such as "1.234 m, bearing +5.0°". */
export function measure_text(from, to) {
  const { distance_m, bearing_deg } = measure(from, to);
  const sign = bearing_deg >= 0.05 ? '+' : '';
  const tenths = (Math.round(bearing_deg * 10) / 10 || 0).toFixed(1).replace('-', '\u2212');
  return `${distance_m.toFixed(3)} m, bearing ${sign}${tenths}\u00b0`;
}

export class Ruler {
  constructor() {
    this.is_on = false;
    /** @type {Place | null} */
    this.from = null;
    /** @type {Place | null} */
    this.to = null;
    /** Whether a cross marks the middle of the picture, for the keyboard. */
    this.shows_middle = false;
    /** Counts changes. */
    this.version = 0;
  }

  /** @param {boolean} on */
  turn(on) {
    this.is_on = on;
    if (!on) this.from = this.to = null;
    this.shows_middle = false;
    this.version++;
  }

  /** Its places are those of another frame. */
  clear() {
    this.from = this.to = null;
    this.version++;
  }

  /** @param {Place} at  The first, the second, and again the first place. */
  put(at) {
    if (this.from && !this.to) {
      this.to = at;
    } else {
      this.from = at;
      this.to = null;
    }
    this.version++;
  }

  /** What it shows, or what to do. */
  text() {
    if (!this.is_on) return '';
    if (!this.from) return 'Ruler: choose the first place';
    if (!this.to) return 'Ruler: choose the second place';
    return measure_text(this.from, this.to);
  }
}
