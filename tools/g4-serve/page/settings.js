// SPDX-License-Identifier: MIT
// Shows the settings of the lidar, and changes them if the server allows it.
import { element } from './input.js';
import { make, write } from './status.js';

/** @typedef {{send: (message: object) => void}} Sender */

/** Names and values are those of g4-dump set. */
const rows = [
  { name: 'sample_rate', label: 'Sample rate', values: [['4000', '4 kHz'], ['8000', '8 kHz'], ['9000', '9 kHz']] },
  { name: 'frequency', label: 'Scan frequency', values: null },
  { name: 'direction', label: 'Direction', values: [['cw', 'clockwise'], ['ccw', 'counter-clockwise']] },
  { name: 'constant', label: 'Constant frequency', values: [['on', 'on'], ['off', 'off']] },
  { name: 'idle', label: 'Motor off when idle', values: [['on', 'on'], ['off', 'off']] },
  { name: 'protection', label: 'Power-down protection', values: [['on', 'on'], ['off', 'off']] },
];

/** @param {unknown} value @returns {string} A value of the form; empty if unknown. */
function text_of(value) {
  if (value === null || value === undefined) return '';
  if (typeof value === 'boolean') return value ? 'on' : 'off';
  return String(value);
}

/** @param {(typeof rows)[0]} row @returns {HTMLSelectElement | HTMLInputElement} */
function field_of(row) {
  if (row.values) {
    const select = document.createElement('select');
    for (const [value, label] of [['', 'unknown'], ...row.values]) select.add(new Option(label, value));
    select.options[0].disabled = true;
    return select;
  }
  const input = document.createElement('input');
  Object.assign(input, { type: 'number', min: '5', max: '12', step: '0.1', placeholder: 'unknown' });
  return input;
}

export class Settings {
  /** @param {Sender} connection */
  constructor(connection) {
    this.connection = connection;
    this.error = element('settings_error');
    /** @type {Record<string, unknown>} */
    this.values = {};
    /** @type {Map<string, HTMLSelectElement | HTMLInputElement>} */
    this.fields = new Map();
    const form = element('settings');
    form.addEventListener('submit', (event) => event.preventDefault());
    for (const row of rows) {
      const field = field_of(row);
      field.name = row.name;
      field.disabled = true;
      field.addEventListener('change', () => this.#change(field));
      this.fields.set(row.name, field);
      const label = make('label', row.name === 'frequency' ? `${row.label} (Hz) ` : `${row.label} `);
      label.append(field);
      form.append(label);
    }
  }

  /** @param {boolean} allowed */
  allow(allowed) {
    for (const field of this.fields.values()) field.disabled = !allowed;
    write(element('settings_note'),
      allowed ? '' : 'Read-only: the server was started without --allow-set.');
  }

  /** @param {Record<string, unknown>} values */
  show(values) {
    this.values = values;
    for (const [name, field] of this.fields) {
      if (field !== document.activeElement || field instanceof HTMLSelectElement) {
        field.value = text_of(values[name]);
      }
    }
    write(this.error, '');
  }

  /** @param {string} message  A change failed: the form shows the last known values again. */
  fail(message) {
    this.show(this.values);
    write(this.error, message);
  }

  /** @param {HTMLSelectElement | HTMLInputElement} field */
  #change(field) {
    write(this.error, '');
    if (!field.value || !field.checkValidity()) return field.reportValidity();
    this.connection.send({ op: 'set', name: field.name, value: field.value });
  }
}
