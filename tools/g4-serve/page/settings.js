// SPDX-License-Identifier: MIT
// Shows the settings of the lidar, and changes them if the server allows it.
import { element } from './input.js';
import { make, write } from './status.js';

/** @typedef {{send: (message: object) => void}} Sender */

/**
 * A row of the table of settings, from the server: a few values, or limits.
 * @typedef {{name: string, text: string, unit: string, values?: string[], least?: number, most?: number,
 *   step?: number}} Row
 */

/** @param {unknown} value @returns {string} A value of the form; empty if unknown. */
function text_of(value) {
  if (value === null || value === undefined) return '';
  if (typeof value === 'boolean') return value ? 'on' : 'off';
  return String(value);
}

/** @param {Row} row @returns {HTMLSelectElement | HTMLInputElement} */
function field_of(row) {
  if (row.values) {
    const select = document.createElement('select');
    select.add(new Option('unknown', ''));
    for (const value of row.values) select.add(new Option(value, value));
    select.options[0].disabled = true;
    return select;
  }
  const input = document.createElement('input');
  const { least, most, step } = row;
  Object.assign(input, { type: 'number', min: least, max: most, step, placeholder: 'unknown' });
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
    element('settings').addEventListener('submit', (event) => event.preventDefault());
  }

  /** @param {Row[]} rows  The same ones each time. */
  use(rows) {
    if (this.fields.size > 0) return;
    for (const row of rows) {
      const field = field_of(row);
      field.name = row.name;
      field.disabled = true;
      field.addEventListener('change', () => this.#change(field));
      this.fields.set(row.name, field);
      const label = make('label', row.unit ? `${row.name} (${row.unit}) ` : `${row.name} `);
      label.title = row.text;
      label.append(field);
      element('settings').append(label);
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
