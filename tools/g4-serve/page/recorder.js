// SPDX-License-Identifier: MIT
// Recording by the server, if it allows that.
import { element } from './input.js';
import { write } from './status.js';

/** @param {any} recording  Of a status. @returns {string} */
function text_of(recording) {
  const size = `${(recording.bytes / 1e6).toFixed(1)} MB`;
  if (recording.file) return `Recording ${recording.file}: ${recording.seconds.toFixed(0)} s, ${size}`;
  if (!recording.last) return 'Not recording';
  return `Recorded ${recording.last}: ${size}${recording.why ? `; ${recording.why}` : ''}`;
}

export class Recorder {
  /** @param {{send: (message: object) => void}} connection */
  constructor(connection) {
    this.connection = connection;
    this.button = /** @type {HTMLButtonElement} */ (element('record'));
    this.text = element('record_text');
    this.is_on = false;
    /** Why a request was refused; shown until the state changes. */
    this.refusal = '';
    this.button.addEventListener('click', () => {
      this.connection.send({ op: 'record', on: !this.is_on });
    });
  }

  /** @param {boolean} allowed */
  allow(allowed) {
    element('recorder').hidden = !allowed;
  }

  /** @param {any} status  A status message; another page may have begun it. */
  show(status) {
    if (!status.recording) return;
    const is_on = Boolean(status.recording.file);
    if (is_on !== this.is_on) this.refusal = '';
    this.is_on = is_on;
    this.button.setAttribute('aria-pressed', String(is_on));
    write(this.text, this.refusal || text_of(status.recording));
  }

  /** @param {string} message */
  fail(message) {
    this.refusal = `${this.is_on ? 'Still' : 'Not'} recording: ${message}`;
    write(this.text, this.refusal);
  }
}
