// SPDX-License-Identifier: MIT
// A revolution as the server sends it. docs/serve.md describes the bytes.

const header_bytes = 16;
const scan_message = 0x10;
const is_whole = 1;
const has_place = 2;
const has_lidars = 4;
const has_intensities = 8;
const place_bytes = 28;

/** @typedef {import('./frames.js').Pose} Pose */

/**
 * Coordinates in metres, in the robot's frame: x, y, x, y, ... `pose` is that of this frame in the map with the number
 * `map`, if it is known. `lidars` has the number of the lidar of each point, if there are several; `intensities` those
 * of models that measure them.
 * @typedef {{revolution: number, stamp: number, whole: boolean, count: number, xy: Float32Array, pose: Pose | null,
 *   map: number, lidars: Uint8Array | null, intensities: Uint16Array | null}} Message
 */

/** @param {DataView} head @param {number} at @returns {{pose: Pose, map: number}} */
function place_at(head, at) {
  const [x, y, yaw] = [4, 12, 20].map((offset) => head.getFloat64(at + offset, true));
  return { pose: { x, y, yaw }, map: head.getUint32(at, true) };
}

/**
 * The number of the lidar of each point, from the numbers of points of each lidar.
 * @param {DataView} head @param {number} at @param {number} lidars @param {number} count
 * @returns {Uint8Array | null} Null if they are not those of so many points.
 */
function lidars_at(head, at, lidars, count) {
  const made = new Uint8Array(count);
  let next = 0;
  for (let i = 0; i < lidars; i++) {
    const points = head.getUint16(at + 2 * i, true);
    if (next + points > count) return null;
    made.fill(i, next, next + points);
    next += points;
  }
  return next === count ? made : null;
}

/** @param {ArrayBuffer} data @returns {Message | null} Null if it is not a revolution. */
export function message_of(data) {
  if (data.byteLength < header_bytes) return null;
  const head = new DataView(data);
  const count = head.getUint16(2, true);
  const flags = head.getUint8(1);
  if (head.getUint8(0) !== scan_message) return null;
  const place = header_bytes + 8 * count;
  const numbers = place + (flags & has_place ? place_bytes : 0);
  const several = Boolean(flags & has_lidars);
  if (data.byteLength < numbers + (several ? 2 : 0)) return null;
  const lidar_count = several ? head.getUint16(numbers, true) : 0;
  const strengths = numbers + (several ? 2 + 2 * lidar_count : 0);
  if (data.byteLength !== strengths + (flags & has_intensities ? 2 * count : 0)) return null;
  const lidars = several ? lidars_at(head, numbers + 2, lidar_count, count) : null;
  if (several && !lidars) return null;
  return {
    revolution: head.getUint32(4, true),
    stamp: head.getFloat64(8, true),
    whole: (flags & is_whole) !== 0,
    count,
    xy: new Float32Array(data, header_bytes, 2 * count), // every browser is little-endian
    ...(flags & has_place ? place_at(head, place) : { pose: null, map: 0 }),
    lidars,
    intensities: flags & has_intensities ? new Uint16Array(data, strengths, count) : null,
  };
}
