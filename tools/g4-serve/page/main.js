// SPDX-License-Identifier: MIT
// The page: connects its parts, and draws one picture per frame.
import { Colours } from './colours.js';
import { Connection } from './connection.js';
import { bearing_deg, composed, origin, placed } from './frames.js';
import { Controls, element } from './input.js';
import { save_picture } from './picture.js';
import { Playback } from './playback.js';
import { Radar } from './radar.js';
import { Recorder } from './recorder.js';
import { Ruler, measure, measure_text } from './ruler.js';
import { Scans } from './scans.js';
import { Settings } from './settings.js';
import { Panels, write } from './status.js';
import { View } from './view.js';

const frames_kept = 1024;
/** The part of the points that is visible at first; a few may be far away, through a door. */
const first_part = 0.95;

const surface = /** @type {HTMLCanvasElement} */ (element('points'));
const grid = /** @type {HTMLCanvasElement} */ (element('grid'));
const view = new View();
const ruler = new Ruler();
const colours = new Colours();
const scans = new Scans(colours);
const radar = new Radar(grid, surface, view, colours);
const panels = new Panels();
/** @type {any} */
let hello = null;
/** @type {any} */
let status = null;

const connection = new Connection({ on_message: take_message, on_data: take_data, on_change: show_state });
const settings = new Settings(connection);
const playback = new Playback(connection, () => show_state());
const recorder = new Recorder(connection);
const controls = new Controls(surface, view, ruler, scans, {
  pause: () => playback.pause(), save, colour: () => colours.next(),
});

/** @param {any} message */
function take_message(message) {
  if (message.op === 'hello') show_hello(message);
  if (message.op === 'settings') settings.show(message.lidars ?? { '': message.settings });
  if (message.op === 'error') fail(message);
  if (message.op === 'event') panels.add_event(message);
  if (message.op !== 'status') return;
  status = message;
  panels.show(status);
  playback.show(status);
  recorder.show(status);
  show_state();
}

/** @param {any} message  A hello. @returns {any[]} The only lidar, or those of merged scans. */
function lidars_of(message) {
  return message.lidars ?? [{ ...message, name: '' }];
}

/** @param {any} lidar @returns {string} */
function device_text({ name, device }) {
  const who = device ?? {};
  const parts = [who.name ?? (who.model && `model ${who.model}`), who.firmware && `firmware ${who.firmware}`,
    who.serial && `serial number ${who.serial}`];
  const text = parts.filter(Boolean).join(', ');
  return name && text ? `${name}: ${text}` : text;
}

/** @param {any} message */
function show_hello(message) {
  hello = message;
  document.title = `g4lidar: ${hello.source ?? ''}`;
  const lidars = lidars_of(hello);
  write(element('source'), hello.source ?? '');
  write(element('device'), lidars.map(device_text).filter(Boolean).join('; '));
  recorder.allow(hello.allow_record === true);
  settings.use(lidars, hello.allow_set === true);
  colours.use(lidars);
  playback.use(hello.recording ?? null);
}

/** @param {any} message */
function fail(message) {
  if (message.of === 'set') settings.fail(message.message);
  else if (message.of === 'record') recorder.fail(message.message);
  else panels.add_event({ what: `${message.of}: ${message.message}` });
}

/** @param {ArrayBuffer} data */
function take_data(data) {
  if (!scans.take(data)) return;
  const scan = scans.newest;
  if (!scan) return;
  panels.show_points(scan.count);
  controls.allow_map(scan.pose !== null);
  show_nearest();
  if (!view.is_chosen && (scan.whole || scans.received === 1)) follow();
}

/** The nearest return, in the robot's frame. */
function show_nearest() {
  const found = scans.nearest_return();
  const text = found ? measure_text(origin, found) : '-';
  panels.numbers.set('Nearest obstacle', text);
  write(element('nearest'), found ? `Nearest: ${text}` : '');
}

/** What the picture shows: the map with a number, or the robot's frame. */
const shown = { map: 0, robot: origin };

function follow_frame() {
  const { robot } = scans;
  const map = scans.is_map ? (scans.newest?.map ?? 0) : 0;
  if (map === shown.map) {
    view.follow(robot);
  } else {
    view.change_frame(shown.robot, robot);
    ruler.clear();
    write(element('frame'), map ? 'map' : 'robot');
    element('axes').innerText = map ? 'up: x\nleft: y' : 'up: x, ahead\nleft: y';
  }
  shown.map = map;
  shown.robot = robot;
}

function save() {
  const now = new Date(1000 * (scans.newest?.stamp ?? Date.now() / 1000));
  const caption = `${hello?.source ?? ''}  ${now.toLocaleString()}  ${element('nearest').textContent}`;
  const name = `g4-${now.toISOString().replace(/[-:]|\.\d+/g, '')}.png`;
  save_picture([grid, surface], caption, radar.theme.text, radar.ratio, name);
}

/** Until the user zooms, nearly all points stay visible: the view zooms out, but not in. */
function follow() {
  const shown_m = Math.min(view.width, view.height) / 2 / view.scale;
  if (scans.range_of(first_part) > shown_m || scans.received === 1) controls.fit(first_part);
}

/** @param {{name: string, state: string}[]} lidars @returns {string} Those that give no scans. */
function without(lidars) {
  const names = lidars.filter((each) => each.state !== 'running').map((each) => each.name);
  return names.length ? ` without ${names.join(', ')}` : '';
}

/** @returns {{state: string, text: string}} What is connected, and why it is not. */
function state_now() {
  if (connection.state === 'waiting') {
    const seconds = Math.ceil(connection.wait_s);
    return { state: 'waiting', text: `No connection: ${connection.why}. Next attempt in ${seconds} s` };
  }
  if (connection.state === 'connecting' || !status) {
    return { state: 'waiting', text: 'Connecting to the server' };
  }
  if (status.state === 'running' && playback.paused) return { state: 'paused', text: 'Paused' };
  const why = status.why ? `: ${status.why}` : '';
  const texts = /** @type {Record<string, string>} */ ({
    running: `Running${without(status.lidars ?? [])}`,
    opening: `Opening the lidar${why}`,
    resting: `The motor rests${why}`,
    lost: `The lidar is lost${why}`,
    ended: hello?.recording ? 'The recording has ended' : `Ended${why}`,
  });
  return { state: status.state, text: texts[status.state] ?? String(status.state) };
}

function show_state() {
  if (connection.state !== 'open') status = null;
  const { state, text } = state_now();
  const shown = element('state');
  // Only the banner shows the countdown, which would interrupt a screen reader here.
  write(shown, state === 'waiting' ? 'No connection' : text);
  shown.dataset.state = state;
  const is_good = state === 'running' || state === 'paused';
  const is_frozen = is_good && scans.is_frozen;
  write(element('banner'), is_frozen ? 'Frozen' : text);
  element('banner').hidden = is_good && !is_frozen;
  surface.classList.toggle('stale', !is_good && state !== 'ended');
}

/** Times in milliseconds: between frames, and for drawing. */
const frames = {
  count: 0,
  drawn: 0,
  intervals: new Float32Array(frames_kept),
  draws: new Float32Array(frames_kept),
  last_ms: 0,
};
const drawn = { view: -1, ruler: -1, scans: -1, colours: -1, newest: /** @type {object | undefined} */ (undefined) };

/** @param {number} now_ms */
function frame(now_ms) {
  const interval_ms = frames.last_ms ? now_ms - frames.last_ms : 0;
  frames.last_ms = now_ms;
  scans.advance(interval_ms / 1000);
  const begin_ms = performance.now();
  follow_frame();
  const view_changed = drawn.view !== view.version;
  if (view_changed || drawn.ruler !== ruler.version || drawn.newest !== scans.newest) {
    radar.draw_grid(ruler, scans);
    write(element('measured'), ruler.text());
    element('measured').hidden = !ruler.is_on;
    element('nearest').hidden = ruler.is_on;
  }
  if (view_changed || drawn.scans !== scans.version || drawn.colours !== colours.version) {
    radar.draw_points(scans);
    frames.drawn++;
  }
  drawn.view = view.version;
  drawn.ruler = ruler.version;
  drawn.scans = scans.version;
  drawn.colours = colours.version;
  drawn.newest = scans.newest;
  frames.intervals[frames.count % frames_kept] = interval_ms;
  frames.draws[frames.count % frames_kept] = performance.now() - begin_ms;
  frames.count++;
  requestAnimationFrame(frame);
}

new ResizeObserver(() => {
  const box = surface.getBoundingClientRect();
  radar.resize(box.width, box.height);
  if (!view.is_chosen) controls.fit(first_part);
}).observe(surface);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
  radar.use_theme();
  colours.use_theme();
});
connection.start();
requestAnimationFrame(frame);

/** The state of the page for tests and scripts; copies, in metres, seconds and CSS pixels. */
Object.defineProperty(window, 'g4lidar', {
  value: Object.freeze({
    get connection() {
      return { state: connection.state, why: connection.why, opened: connection.opened };
    },
    get hello() {
      return hello;
    },
    get status() {
      return status;
    },
    /** The newest scan that is shown, and the number of those below it. */
    get scan() {
      const scan = scans.newest;
      if (!scan) return null;
      const { revolution, stamp, whole, pose, map } = scan;
      return {
        revolution, stamp, whole, pose, map, points: Array.from(scan.xy), trails: scans.shown.length - 1,
        lidars: scan.lidars && Array.from(scan.lidars),
        intensities: scan.intensities && Array.from(scan.intensities),
      };
    },
    /** All scans that are shown, the oldest first, with points in the frame of the picture. */
    get shown() {
      return scans.shown.map((scan) => {
        const frame = scans.frame_of(scan);
        const places = Array.from({ length: scan.count }, (_, i) => placed(frame, { x: scan.xy[2 * i], y: scan.xy[2 * i + 1] }));
        return { revolution: scan.revolution, points: places.flatMap(({ x, y }) => [x, y]) };
      });
    },
    /** Where the robot, and the way that it has driven, are in the picture. */
    get robot() {
      return { ...scans.robot };
    },
    get way() {
      return scans.way.poses.map((pose) => composed(scans.map, pose));
    },
    /** By what the points are coloured, and by what they can be. */
    get colour() {
      const { way, ways, range_m, intensity } = colours;
      return { way, ways: [...ways], range_m, intensity };
    },
    get is_map() {
      return scans.is_map;
    },
    get nearest() {
      const found = scans.nearest_return();
      return found && { distance_m: Math.hypot(found.x, found.y), bearing_deg: bearing_deg(found) };
    },
    get received() {
      return { scans: scans.received, points: scans.points_received };
    },
    get view() {
      const { x, y, scale, width, height } = view;
      return { x, y, scale, width, height };
    },
    /** Of the rings. */
    get labels() {
      return radar.labels.map((each) => ({ ...each }));
    },
    /** @param {number} x @param {number} y @returns {number[]} Column and row. */
    pixel(x, y) {
      return [view.column(y), view.row(x)];
    },
    get ruler() {
      const { from, to, is_on } = ruler;
      return { is_on, from, to, ...(from && to ? measure(from, to) : {}) };
    },
    get frozen() {
      return scans.is_frozen;
    },
    get trail_s() {
      return scans.trail_s;
    },
    /** Of the last frames, the oldest first. */
    get frames() {
      const first = Math.max(0, frames.count - frames_kept);
      const at = Array.from({ length: frames.count - first }, (_, i) => (first + i) % frames_kept);
      return {
        count: frames.count,
        drawn: frames.drawn,
        intervals_ms: at.map((i) => frames.intervals[i]),
        draws_ms: at.map((i) => frames.draws[i]),
      };
    },
  }),
});
