// The binary frames of the protocol, see hthor/live/wire.py.

export const VERSION = "hthor.live.2";
const STEER = 1;
const FRAME = 2;
const PICTURE = 3;
const HEAD_BYTES = 30;
const ROW_BYTES = 16;

/**
 * @typedef {{forward: number, left: number, yaw: number, pitch: number}} Drive velocity [m/s] in the frame of the head's
 *   heading [rad], and how far it looks up [rad]
 * @typedef {{place: number[], direction: number[]}} Hand where a hand is [m], and the unit vector that it points along
 * @typedef {{tick: number, step: number, steering: number, x: number, y: number, yaw: number, gaze: number,
 *   pitch: number}} FrameHead
 * @typedef {{number: number, position: number[], turn: number[]}} Moved position [m] and quaternion (x, y, z, w)
 */

/** @param {number} number @param {Drive} drive @param {Hand | null} hand the one that acts; null at a desk */
export function encodeSteering(number, drive, hand) {
  const values = [drive.forward, drive.left, drive.yaw, drive.pitch];
  if (hand) values.push(...hand.place, ...hand.direction);
  const data = new DataView(new ArrayBuffer(5 + 4 * values.length));
  data.setUint8(0, STEER);
  data.setUint32(1, number, true);
  values.forEach((value, k) => data.setFloat32(5 + 4 * k, value, true));
  return data.buffer;
}

/**
 * What a binary message of the server is.
 * @param {ArrayBuffer} buffer
 * @returns {{head: FrameHead, moved: Moved[]} | {message: number, jpeg: Blob} | null}
 */
export function decode(buffer) {
  const data = new DataView(buffer);
  if (data.getUint8(0) === PICTURE) {
    return { message: data.getUint32(1, true), jpeg: new Blob([buffer.slice(5)], { type: "image/jpeg" }) };
  }
  if (data.getUint8(0) !== FRAME) return null;
  const at = (/** @type {number} */ k) => data.getFloat32(10 + 4 * k, true);
  const head = {
    tick: data.getUint32(1, true),
    step: data.getUint8(5),
    steering: data.getUint32(6, true),
    ...{ x: at(0), y: at(1), yaw: at(2), gaze: at(3), pitch: at(4) },
  };
  const moved = [];
  for (let row = HEAD_BYTES; row < buffer.byteLength; row += ROW_BYTES) {
    const value = (/** @type {number} */ k) => data.getInt16(row + 2 + 2 * k, true);
    const [w, x, y, z] = [3, 4, 5, 6].map((k) => value(k) / 32767);
    moved.push({
      number: data.getUint16(row, true),
      position: [value(0) / 1000, value(1) / 1000, value(2) / 1000],
      turn: [x, y, z, w],
    });
  }
  return { head, moved };
}
