// SPDX-License-Identifier: MIT
// The panels: diagnoses of the doctor, measurements, counters, events.
import { element } from './input.js';

/**
 * @typedef {{name: string, cause: string, advice: string}} Diagnosis
 * @typedef {{name: string, value: number | string, unit?: string}} Evidence
 * @typedef {{stage: string, lidar?: string, verdict: string, diagnoses: Diagnosis[], evidence: Evidence[],
 *   remark?: string}} Stage
 * @typedef {{name?: string, recognition: Record<string, string> | null}} Recognised  A lidar in a status.
 */

const verdicts = ['skipped', 'ok', 'warn', 'fail'];
const marks = /** @type {Record<string, string>} */ ({
  ok: '\u2713', skipped: '\u2013', warn: '!', fail: '\u2717',
});
const most_events = 50;

/** @param {Element} where @param {string} text  Not written again if it is unchanged. */
export function write(where, text) {
  if (where.textContent !== text) where.textContent = text;
}

/**
 * @param {string} tag @param {string} [text] @param {...Node} children
 * @returns {HTMLElement}
 */
export function make(tag, text = '', ...children) {
  const made = document.createElement(tag);
  made.textContent = text;
  made.append(...children);
  return made;
}

/** @param {string} name  An identifier as words. */
export function words_of(name) {
  const words = name.replaceAll('_', ' ').replace(/\b(usb|crc)\b/, (short) => short.toUpperCase());
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** @param {unknown} value @param {number} [digits] @param {string} [unit] */
export function number_text(value, digits = 0, unit = '') {
  if (typeof value !== 'number') return value === null || value === undefined ? '-' : String(value);
  return unit ? `${value.toFixed(digits)} ${unit}` : value.toFixed(digits);
}

/** @param {Evidence} fact  Its name without the unit at the end. */
function evidence_name(fact) {
  const end = `_${(fact.unit ?? '').toLowerCase()}`;
  return words_of(fact.name.endsWith(end) ? fact.name.slice(0, -end.length) : fact.name);
}

/** @param {Evidence} fact */
function evidence_text(fact) {
  const unit = fact.unit ?? '';
  const is_whole = typeof fact.value !== 'number' || Number.isInteger(fact.value);
  return number_text(fact.value, is_whole ? 0 : 2, unit);
}

/** A list of names and changing values. */
class Table {
  /** @param {HTMLElement} list */
  constructor(list) {
    this.list = list;
    /** @type {Map<string, HTMLElement>} */
    this.values = new Map();
  }

  /** @param {string} name @param {string} text */
  set(name, text) {
    let value = this.values.get(name);
    if (!value) {
      value = make('dd');
      this.values.set(name, value);
      this.list.append(make('dt', name), value);
    }
    write(value, text);
  }

  /** @param {string} name @param {string} verdict */
  colour(name, verdict) {
    this.values.get(name)?.setAttribute('data-verdict', verdict);
  }
}

/** @param {{stage: string, lidar?: string}} stage @returns {string} Its name, after that of the lidar if there are several. */
function head_of({ stage, lidar }) {
  return lidar ? `${lidar}: ${words_of(stage)}` : words_of(stage);
}

/** A stage of the doctor: a line, with its evidence folded below. */
class StageRow {
  constructor() {
    this.summary = make('summary');
    this.remark = make('p');
    this.evidence = make('dl');
    this.table = new Table(this.evidence);
    this.row = make('details', '', this.summary, this.remark, this.evidence);
  }

  /** @param {Stage} stage */
  show(stage) {
    const names = stage.diagnoses.map((each) => words_of(each.name)).join(', ');
    write(this.summary, `${marks[stage.verdict] ?? ''} ${head_of(stage)}: ${names || stage.verdict}`);
    this.summary.dataset.verdict = stage.verdict;
    write(this.remark, stage.remark ?? '');
    const known = new Set(stage.evidence.map(evidence_name));
    for (const fact of stage.evidence) this.table.set(evidence_name(fact), evidence_text(fact));
    for (const [name, value] of this.table.values) if (!known.has(name)) write(value, '-');
  }
}

export class Panels {
  constructor() {
    this.verdict = element('verdict');
    this.advice = element('advice');
    this.advice_shown = '';
    this.stages = element('stages');
    /** @type {Map<string, StageRow>} */
    this.rows = new Map();
    this.numbers = new Table(element('numbers'));
    this.counts = new Table(element('counts'));
    this.events = element('events');
  }

  /** @param {any} status  A status message. */
  show(status) {
    const { numbers } = this;
    numbers.set('Scan frequency', number_text(status.frequency_hz, 2, 'Hz'));
    numbers.set('Scans per second', number_text(status.scan_rate_hz, 1));
    numbers.set('Samples per second', number_text(status.sample_rate_hz, 0));
    numbers.set('Loss', typeof status.loss === 'number' ? `${(100 * status.loss).toFixed(2)} %` : '-');
    numbers.set('Checksum errors', number_text(status.checksum_errors, 0, 'bytes'));
    numbers.set('USB latency', number_text(status.usb_latency_ms, 1, 'ms'));
    numbers.set('Health', number_text(status.health));
    numbers.colour('Health', status.health ?? 'skipped');
    for (const [name, value] of Object.entries(status.counts ?? {})) {
      this.counts.set(words_of(name), number_text(value));
    }
    const stages = status.stages ?? [];
    this.#show_stages([...this.#contradictions(status.lidars ?? [status]), ...stages]);
  }

  /** Shows as which models the lidars are read. @param {Recognised[]} lidars @returns {Stage[]} What contradicts. */
  #contradictions(lidars) {
    return lidars.flatMap(({ name: lidar, recognition }) => {
      const { contradictions = '', ...facts } = recognition ?? {};
      for (const [name, text] of Object.entries(facts)) {
        this.numbers.set(head_of({ stage: name, lidar }), text);
      }
      const stage = { stage: 'model', lidar, verdict: 'ok', diagnoses: [], evidence: [] };
      const found = [{ name: 'contradictions', cause: contradictions, advice: '' }];
      if (contradictions) return [{ ...stage, verdict: 'warn', diagnoses: found }];
      return this.rows.has(head_of(stage)) ? [stage] : [];
    });
  }

  /** @param {number} points  Of the scan that is shown. */
  show_points(points) {
    this.numbers.set('Points of the scan', number_text(points));
  }

  /** @param {Stage[]} stages */
  #show_stages(stages) {
    const worst = stages.reduce((most, stage) => Math.max(most, verdicts.indexOf(stage.verdict)), -1);
    write(this.verdict, worst < 0 ? '-' : verdicts[worst]);
    this.verdict.dataset.verdict = verdicts[worst] ?? 'skipped';
    for (const stage of stages) {
      const name = head_of(stage);
      let row = this.rows.get(name);
      if (!row) {
        row = new StageRow();
        this.rows.set(name, row);
        this.stages.append(row.row);
      }
      row.show(stage);
    }
    this.#show_advice(stages);
  }

  /** @param {Stage[]} stages */
  #show_advice(stages) {
    const found = stages.flatMap((stage) =>
      stage.diagnoses.map((each) => ({ ...each, verdict: stage.verdict, lidar: stage.lidar })));
    const key = JSON.stringify(found);
    if (key === this.advice_shown) return;
    this.advice_shown = key;
    this.advice.replaceChildren(...found.map((each) => {
      const head = make('p');
      const name = each.lidar ? `${each.lidar}: ${words_of(each.name)}` : words_of(each.name);
      head.append(make('strong', name), `: ${each.cause}`);
      const advice = make('p', each.advice);
      advice.className = 'advice';
      const box = make('div', '', head, advice);
      box.dataset.verdict = each.verdict;
      box.dataset.diagnosis = each.name;
      return box;
    }));
  }

  /** @param {{what: string, time?: number | string, lidar?: string}} event */
  add_event(event) {
    let time = event.time ?? '';
    // Seconds since 1970, or since the beginning of a recording.
    if (typeof time === 'number') {
      time = time > 1e9 ? new Date(1000 * time).toLocaleTimeString() : `${time.toFixed(1)} s`;
    }
    const lidar = event.lidar ? `${event.lidar}: ` : '';
    this.events.prepend(make('li', `${time} ${lidar}${event.what}`));
    while (this.events.childElementCount > most_events) this.events.lastElementChild?.remove();
  }
}
