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

/** @param {string} lidar @param {string} name  Of a setting. @returns {string} The name of its field. */
function field_name(lidar, name) {
  return lidar ? `${lidar}.${name}` : name;
}

/** The settings of the only lidar, or of each of several ones. */
export class Settings {
  /** @param {Sender} connection */
  constructor(connection) {
    this.connection = connection;
    this.form = element('settings');
    this.error = element('settings_error');
    /** By the names of lidars. @type {Record<string, Record<string, unknown>>} */
    this.values = {};
    /** By their names. @type {Map<string, HTMLSelectElement | HTMLInputElement>} */
    this.fields = new Map();
    this.shown = '';
    this.form.addEventListener('submit', (event) => event.preventDefault());
  }

  /**
   * @param {{name: string, setting_rows?: Row[], settings?: any, device?: any}[]} lidars  Of a hello.
   * @param {boolean} allowed
   */
  use(lidars, allowed) {
    const key = JSON.stringify(lidars.map((each) => [each.name, each.setting_rows, each.device?.speed_by]));
    if (key !== this.shown) {
      this.shown = key;
      this.fields.clear();
      this.form.replaceChildren(...lidars.map((each) => this.#group(each)));
    }
    for (const field of this.fields.values()) field.disabled = !allowed;
    const note = allowed ? '' : 'Read-only: the server was started without --allow-set.';
    write(element('settings_note'), this.fields.size > 0 ? note : 'None.');
    this.show(Object.fromEntries(lidars.map((each) => [each.name, each.settings ?? {}])));
  }

  /** @param {Record<string, Record<string, unknown>>} values  By the names of lidars. */
  show(values) {
    this.values = values;
    for (const [lidar, known] of Object.entries(values)) {
      for (const [name, value] of Object.entries(known ?? {})) {
        const field = this.fields.get(field_name(lidar, name));
        if (!field || (field === document.activeElement && !(field instanceof HTMLSelectElement))) continue;
        field.value = text_of(value);
      }
    }
    write(this.error, '');
  }

  /** @param {string} message  A change failed: the form shows the last known values again. */
  fail(message) {
    this.show(this.values);
    write(this.error, message);
  }

  /** @param {{name: string, setting_rows?: Row[], device?: any}} of @returns {HTMLElement} */
  #group({ name: lidar, setting_rows: rows = [], device }) {
    const group = make(lidar ? 'fieldset' : 'div');
    if (lidar) group.append(make('legend', lidar));
    for (const row of rows) {
      const field = field_of(row);
      field.name = field_name(lidar, row.name);
      field.addEventListener('change', () => this.#change(field, lidar, row.name));
      this.fields.set(field.name, field);
      const label = make('label', row.unit ? `${row.name} (${row.unit}) ` : `${row.name} `);
      label.title = row.text;
      label.append(field);
      group.append(label);
    }
    if (device?.speed_by) group.append(make('p', `Its speed: ${device.speed_by}.`));
    return group;
  }

  /** @param {HTMLSelectElement | HTMLInputElement} field @param {string} lidar @param {string} name */
  #change(field, lidar, name) {
    write(this.error, '');
    if (!field.value || !field.checkValidity()) return field.reportValidity();
    this.connection.send({ op: 'set', ...(lidar && { lidar }), name, value: field.value });
  }
}
