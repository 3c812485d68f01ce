// SPDX-License-Identifier: MIT
// Input by mouse, touch and keys on the radar.
import { bearing_deg, inverse, placed } from './frames.js';

/** @typedef {import('./view.js').View} View */
/** @typedef {import('./ruler.js').Ruler} Ruler */
/** @typedef {import('./scans.js').Scans} Scans */

const zoom_step = 1.25;
const pan_pixels = 60;
const click_pixels = 5;
const snap_pixels = 10;

/** @param {string} id */
export function element(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no ${id}`);
  return found;
}

/**
 * @param {string} id @param {() => void} action
 * @returns {HTMLElement} The button.
 */
function button(id, action) {
  const made = element(id);
  made.addEventListener('click', action);
  return made;
}

/** Pan with one pointer, zoom with two; a click sets an end of the ruler. */
export class Pointers {
  /**
   * @param {HTMLElement} surface @param {View} view
   * @param {(column: number, row: number, exactly: boolean) => void} on_click
   * @param {(column: number, row: number) => void} on_hover
   */
  constructor(surface, view, on_click, on_hover) {
    this.surface = surface;
    this.view = view;
    this.on_click = on_click;
    this.on_hover = on_hover;
    /** @type {Map<number, {column: number, row: number}>} */
    this.down = new Map();
    this.moved = 0;
    this.may_click = false;
    surface.addEventListener('pointerdown', (event) => this.#press(event));
    surface.addEventListener('pointermove', (event) => this.#move(event));
    surface.addEventListener('pointerup', (event) => this.#release(event, true));
    surface.addEventListener('pointercancel', (event) => this.#release(event, false));
    surface.addEventListener('wheel', (event) => this.#turn(event), { passive: false });
  }

  /** @param {MouseEvent} event */
  #at(event) {
    const box = this.surface.getBoundingClientRect();
    return { column: event.clientX - box.left, row: event.clientY - box.top };
  }

  /** @param {PointerEvent} event */
  #press(event) {
    if (event.button !== 0) return;
    this.surface.setPointerCapture(event.pointerId);
    this.down.set(event.pointerId, this.#at(event));
    this.may_click = this.down.size === 1;
    this.moved = 0;
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const now = this.#at(event);
    this.on_hover(now.column, now.row);
    const before = this.down.get(event.pointerId);
    if (!before) return;
    this.moved += Math.hypot(now.column - before.column, now.row - before.row);
    const is_click = this.may_click && this.moved <= click_pixels;
    if (is_click) return;
    this.surface.classList.add('pans');
    const other = [...this.down].find(([id]) => id !== event.pointerId)?.[1];
    this.down.set(event.pointerId, now);
    if (!other) {
      this.view.pan(now.column - before.column, now.row - before.row);
      return;
    }
    const apart = Math.hypot(now.column - other.column, now.row - other.row);
    const were = Math.hypot(before.column - other.column, before.row - other.row);
    this.view.pan((now.column - before.column) / 2, (now.row - before.row) / 2);
    this.view.zoom(Math.max(apart, 1) / Math.max(were, 1), (now.column + other.column) / 2,
      (now.row + other.row) / 2);
  }

  /** @param {PointerEvent} event @param {boolean} is_up */
  #release(event, is_up) {
    const began = this.down.get(event.pointerId);
    this.down.delete(event.pointerId);
    if (this.down.size === 0) this.surface.classList.remove('pans');
    if (!began || !is_up || !this.may_click || this.moved > click_pixels) return;
    this.on_click(began.column, began.row, event.shiftKey);
  }

  /** @param {WheelEvent} event */
  #turn(event) {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? event.deltaY / 100 : event.deltaY / 3;
    const { column, row } = this.#at(event);
    this.view.zoom(zoom_step ** -Math.max(-3, Math.min(3, lines)), column, row);
  }
}

/** Buttons and keys of the radar. */
export class Controls {
  /**
   * @param {HTMLElement} surface @param {View} view @param {Ruler} ruler @param {Scans} scans
   * @param {{pause: () => void, save: () => void, colour: () => void}} actions  Pause or continue a recording; save the
   *   picture; change the meaning of colours.
   */
  constructor(surface, view, ruler, scans, actions) {
    this.surface = surface;
    this.view = view;
    this.ruler = ruler;
    this.scans = scans;
    this.trails = /** @type {HTMLInputElement} */ (element('trails'));
    this.freeze_button = button('freeze', () => this.freeze());
    this.ruler_button = button('ruler', () => this.turn_ruler());
    this.map_button = /** @type {HTMLButtonElement} */ (button('map', () => this.turn_map()));
    button('save', actions.save);
    const keys = /** @type {HTMLDialogElement} */ (element('keys'));
    button('zoom_in', () => view.zoom(zoom_step));
    button('zoom_out', () => view.zoom(1 / zoom_step));
    button('fit', () => this.fit_all());
    button('help', () => keys.showModal());
    this.trails.addEventListener('input', () => this.use_trails());
    this.pointer_text = element('pointer');
    new Pointers(surface, view, (column, row, exactly) => this.#click(column, row, exactly),
      (column, row) => this.#hover(column, row));
    /** @type {Record<string, () => void>} */
    this.keys = {
      '+': () => view.zoom(zoom_step),
      '=': () => view.zoom(zoom_step),
      '-': () => view.zoom(1 / zoom_step),
      0: () => this.fit_all(),
      f: () => this.freeze(),
      r: () => this.turn_ruler(),
      t: () => this.next_trails(),
      m: () => this.turn_map(),
      s: actions.save,
      c: actions.colour,
      p: actions.pause,
      Escape: () => this.ruler.is_on && this.turn_ruler(),
      '?': () => keys.showModal(),
    };
    /** @type {Record<string, () => void>} Only while the radar has the focus. */
    this.focus_keys = {
      ArrowLeft: () => view.pan(pan_pixels, 0),
      ArrowRight: () => view.pan(-pan_pixels, 0),
      ArrowUp: () => view.pan(0, pan_pixels),
      ArrowDown: () => view.pan(0, -pan_pixels),
      ' ': () => this.freeze(),
      Enter: () => this.#put_middle(),
    };
    addEventListener('keydown', (event) => this.#press(event));
    const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.trails.value = calm ? '0' : '0.5';
    this.use_trails();
  }

  /** @param {KeyboardEvent} event */
  #press(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const at = /** @type {HTMLElement} */ (event.target);
    if (at.closest('dialog, input:not([type="range"]), select')) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const action = this.keys[key] ?? (at === this.surface ? this.focus_keys[key] : undefined);
    if (!action) return;
    event.preventDefault();
    action();
  }

  /** @param {number} [part]  The part of the points that must be visible. */
  fit(part = 1) {
    const range_m = this.scans.range_of(part);
    if (range_m > 0) this.view.fit(range_m * 1.08);
  }

  fit_all() {
    this.fit();
    this.view.is_chosen = true;
  }

  freeze() {
    this.scans.is_frozen = !this.scans.is_frozen;
    this.scans.version++;
    this.freeze_button.setAttribute('aria-pressed', String(this.scans.is_frozen));
  }

  turn_ruler() {
    this.ruler.turn(!this.ruler.is_on);
    this.ruler_button.setAttribute('aria-pressed', String(this.ruler.is_on));
    this.surface.classList.toggle('measures', this.ruler.is_on);
  }

  /** Between the robot's frame and the map, where the motion is known. */
  turn_map() {
    if (this.map_button.disabled) return;
    this.scans.wants_map = !this.scans.wants_map;
    this.scans.version++;
    this.map_button.setAttribute('aria-pressed', String(this.scans.wants_map));
  }

  /** @param {boolean} is_known  Whether the motion is known. */
  allow_map(is_known) {
    this.map_button.disabled = !is_known && !this.scans.wants_map;
  }

  use_trails() {
    this.scans.trail_s = Number(this.trails.value);
    const text = this.scans.trail_s > 0 ? `${this.scans.trail_s} s` : 'off';
    element('trails_text').textContent = text;
    this.trails.setAttribute('aria-valuetext', text);
    this.scans.version++;
  }

  next_trails() {
    const next = [0.5, 2, 10].find((length) => length > this.scans.trail_s) ?? 0;
    this.trails.value = String(next);
    this.use_trails();
  }

  /** @param {number} column @param {number} row @param {boolean} exactly  Do not take a near point instead. */
  #click(column, row, exactly) {
    if (!this.ruler.is_on) return;
    const place = this.view.place(column, row);
    const near = exactly ? null : this.scans.nearest(place, snap_pixels / this.view.scale);
    this.ruler.put(near ?? place);
  }

  #put_middle() {
    if (!this.ruler.is_on) return;
    if (this.ruler.shows_middle) this.#click(this.view.width / 2, this.view.height / 2, true);
    this.ruler.shows_middle = true;
    this.ruler.version++;
  }

  /** @param {number} column @param {number} row */
  #hover(column, row) {
    const at = placed(inverse(this.scans.robot), this.view.place(column, row));
    const bearing = Math.round(bearing_deg(at));
    this.pointer_text.textContent = `${Math.hypot(at.x, at.y).toFixed(2)} m, ${bearing}\u00b0`;
  }
}
