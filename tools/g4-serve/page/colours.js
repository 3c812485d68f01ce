// SPDX-License-Identifier: MIT
// The colours of points: by range, by intensity, or by the lidar that has measured them.
import { element } from './input.js';
import { make, write } from './status.js';

/** @typedef {import('./message.js').Message} Message */
/** @typedef {'range' | 'intensity' | 'lidar'} Way */

export const colour_count = 256;
/** The range of the last colour in metres, until the model is known. */
const usual_range_m = 16;
const opaque = 255;

/** Anchors of the colours from small to large values: readable on a light and on a dark background. */
const on_light = [[130, 10, 20], [200, 35, 75], [160, 50, 180], [60, 90, 225], [10, 110, 130]];
const on_dark = [[255, 240, 150], [255, 175, 70], [245, 100, 120], [190, 110, 230], [105, 150, 255]];
/** Of lidars: they differ for colour-blind people, too (tests/browser/lidars_test.py). More lidars begin again. */
export const lidars_on_light = [[0, 94, 168], [213, 94, 0], [0, 0, 0], [0, 158, 115], [204, 121, 167]];
export const lidars_on_dark = [[86, 180, 233], [230, 140, 0], [255, 255, 255], [0, 158, 115], [204, 121, 167]];

/** @param {number[]} colour @returns {number} As in ImageData, without alpha. */
function pixel_of([red, green, blue]) {
  return red | (green << 8) | (blue << 16);
}

/** @param {number[][]} anchors @returns {Uint32Array} */
function colours_between(anchors) {
  const table = new Uint32Array(colour_count);
  for (let i = 0; i < colour_count; i++) {
    const at = (i / (colour_count - 1)) * (anchors.length - 1);
    const below = Math.min(Math.floor(at), anchors.length - 2);
    table[i] = pixel_of(anchors[below].map((from, c) =>
      Math.round(from + (anchors[below + 1][c] - from) * (at - below))));
  }
  return table;
}

/** @param {number[][]} colours @returns {Uint32Array} */
function repeated(colours) {
  return Uint32Array.from({ length: colour_count }, (_, i) => pixel_of(colours[i % colours.length]));
}

/** @param {number} metres */
function range_text(metres) {
  return String(Math.round(10 * metres) / 10);
}

export class Colours {
  constructor() {
    this.box = /** @type {HTMLSelectElement} */ (element('colour_by'));
    this.range_m = usual_range_m;
    /** The intensity of the last colour: that of the strongest returns. */
    this.intensity = 1;
    /** The names of several lidars. @type {string[]} */
    this.lidars = [];
    /** @type {Way} */
    this.way = 'range';
    /** @type {Way[]} */
    this.ways = ['range'];
    /** Counts changes. */
    this.version = 0;
    this.scale = colours_between(on_light);
    this.of_lidars = lidars_on_light;
    this.box.addEventListener('change', () => this.#choose(/** @type {Way} */ (this.box.value)));
    this.use_theme();
  }

  use_theme() {
    const is_dark = matchMedia('(prefers-color-scheme: dark)').matches;
    this.scale = colours_between(is_dark ? on_dark : on_light);
    this.of_lidars = is_dark ? lidars_on_dark : lidars_on_light;
    this.#show();
  }

  /** @param {{name: string, device?: any}[]} lidars  Of a hello. */
  use(lidars) {
    const ranges = lidars.map((each) => each.device?.range_m).filter((range) => range > 0);
    this.range_m = ranges.length ? Math.max(...ranges) : usual_range_m;
    this.lidars = lidars.length > 1 ? lidars.map((each) => each.name) : [];
    /** @type {Way[]} */
    const ways = ['range'];
    if (lidars.some((each) => each.device?.has_intensity)) ways.push('intensity');
    if (this.lidars.length) ways.unshift('lidar');
    if (ways.join() !== this.ways.join()) this.#offer(ways);
    this.#show();
  }

  /** The next way, if there are several. */
  next() {
    this.#choose(this.ways[(this.ways.indexOf(this.way) + 1) % this.ways.length]);
  }

  /** The colours of the values of of(). */
  get table() {
    return this.way === 'lidar' ? repeated(this.of_lidars) : this.scale;
  }

  /** @param {Message} scan @returns {Record<Way, Uint8Array>} For each point the number of its colour. */
  of(scan) {
    const range = new Uint8Array(scan.count);
    for (let i = 0; i < scan.count; i++) {
      // By the square root of the range, for more colours near the lidar.
      const part = Math.sqrt(Math.hypot(scan.xy[2 * i], scan.xy[2 * i + 1]) / this.range_m);
      range[i] = Math.min(colour_count - 1, part * colour_count);
    }
    return { range, intensity: this.#of_intensities(scan), lidar: scan.lidars ?? new Uint8Array(scan.count) };
  }

  /** @param {Message} scan */
  #of_intensities(scan) {
    const made = new Uint8Array(scan.count);
    if (!scan.intensities) return made;
    const strongest = scan.intensities.reduce((most, each) => Math.max(most, each), 1);
    const before = this.intensity;
    // It follows slowly to smaller values, for colours that stay.
    this.intensity = Math.max(strongest, 0.99 * this.intensity);
    for (let i = 0; i < scan.count; i++) made[i] = ((colour_count - 1) * scan.intensities[i]) / this.intensity;
    if (this.way === 'intensity' && Math.round(before) !== Math.round(this.intensity)) this.#show_scale();
    return made;
  }

  /** @param {Way[]} ways */
  #offer(ways) {
    this.ways = ways;
    this.box.replaceChildren(...ways.map((way) => new Option(way, way)));
    element('colour_label').hidden = ways.length < 2;
    this.#choose(ways[0]);
  }

  /** @param {Way} way */
  #choose(way) {
    this.way = way;
    this.box.value = way;
    this.#show();
  }

  #show() {
    this.version++;
    element('scale').hidden = this.way === 'lidar';
    element('lidars').hidden = this.way !== 'lidar';
    if (this.way === 'lidar') this.#show_lidars();
    else this.#show_scale();
  }

  #show_lidars() {
    element('lidars').replaceChildren(...this.lidars.map((name, i) => {
      const square = make('span');
      square.className = 'square';
      square.style.background = `rgb(${this.of_lidars[i % this.of_lidars.length].join()})`;
      return make('li', '', square, document.createTextNode(name));
    }));
  }

  #show_scale() {
    const canvas = /** @type {HTMLCanvasElement} */ (element('colours'));
    const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
    const strip = context.createImageData(colour_count, 1);
    const pixels = new Uint32Array(strip.data.buffer);
    for (let i = 0; i < colour_count; i++) pixels[i] = this.scale[i] | (opaque << 24);
    context.putImageData(strip, 0, 0);
    const is_range = this.way === 'range';
    write(element('colour_text'), is_range ? 'Colour: range, finer near the lidar' : 'Colour: intensity');
    const parts = [0, 0.25, 0.5, 0.75, 1];
    const texts = is_range ? parts.map((part) => range_text(part * part * this.range_m)) :
      parts.map((part) => String(Math.round(part * this.intensity)));
    if (is_range) texts[4] += ' m';
    const labels = [...element('colour_labels').children];
    labels.forEach((label, i) => write(label, texts[i]));
    element('colour_labels').setAttribute('aria-label', `Colours by ${this.way}, 0 to ${texts[4]}`);
  }
}
