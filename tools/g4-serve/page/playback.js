// SPDX-License-Identifier: MIT
// The time line of a recording.
import { element } from './input.js';
import { write } from './status.js';

const speeds = [0.25, 0.5, 1, 2, 4, 8];
const seek_interval_ms = 200;

/** @param {number} seconds @returns {string} Such as 1:02.5. */
export function time_text(seconds) {
  const tenths = Math.round(10 * seconds);
  const minutes = Math.floor(tenths / 600);
  return `${minutes}:${((tenths - 600 * minutes) / 10).toFixed(1).padStart(4, '0')}`;
}

export class Playback {
  /** @param {{send: (message: object) => void}} connection @param {() => void} on_pause */
  constructor(connection, on_pause) {
    this.connection = connection;
    this.on_pause = on_pause;
    this.form = element('playback');
    this.form.addEventListener('submit', (event) => event.preventDefault());
    this.pause_button = element('pause');
    this.position = /** @type {HTMLInputElement} */ (element('position'));
    this.speed = /** @type {HTMLSelectElement} */ (element('speed'));
    for (const speed of speeds) this.speed.add(new Option(`${speed}\u00d7`, String(speed)));
    this.speed.value = '1';
    this.length_s = 0;
    this.paused = false;
    this.is_dragged = false;
    this.seek_timer = 0;
    this.pause_button.addEventListener('click', () => this.pause());
    this.speed.addEventListener('change', () => this.#send({ speed: Number(this.speed.value) }));
    this.position.addEventListener('input', () => this.#seek());
    this.position.addEventListener('change', () => {
      this.is_dragged = false;
    });
  }

  /** @param {{length_s: number} | null} recording */
  use(recording) {
    this.form.hidden = !recording;
    this.length_s = recording?.length_s ?? 0;
    this.position.max = String(this.length_s);
  }

  /** @param {any} status  A status message; another page may have paused it. */
  show(status) {
    if (this.form.hidden) return;
    if (typeof status.paused === 'boolean') this.#show_pause(status.paused);
    if (typeof status.speed === 'number' && this.speed !== document.activeElement) {
      this.speed.value = String(status.speed);
    }
    if (this.is_dragged || this.seek_timer || typeof status.position_s !== 'number') return;
    this.position.value = String(status.position_s);
    this.#show_position();
  }

  pause() {
    if (this.form.hidden) return;
    this.#show_pause(!this.paused);
    this.#send({ paused: this.paused });
    this.on_pause();
  }

  /** @param {boolean} paused */
  #show_pause(paused) {
    this.paused = paused;
    write(this.pause_button, paused ? 'Continue' : 'Pause');
  }

  #show_position() {
    const text = `${time_text(Number(this.position.value))} / ${time_text(this.length_s)}`;
    write(element('position_text'), text);
    this.position.setAttribute('aria-valuetext', text);
  }

  /** Limits the rate of seeks while the slider is dragged. */
  #seek() {
    this.is_dragged = true;
    this.#show_position();
    if (this.seek_timer) return;
    this.seek_timer = setTimeout(() => {
      this.seek_timer = 0;
      this.#send({ seek_s: Number(this.position.value) });
    }, seek_interval_ms);
  }

  /** @param {object} change */
  #send(change) {
    this.connection.send({ op: 'play', ...change });
  }
}
