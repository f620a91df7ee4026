// The recording of a trial, see hthor/watch/recording.py: who took part, and how everything was at any time.

const METRE = 1000;
const ONE = 32767;
const JUMP_M = 0.6; // in a tick nothing moves so far; it was put somewhere else

/**
 * @typedef {{seat: string, name: string, person: boolean, colour: string, eye: number, height: number, own: number[],
 *   fov: [number, number] | null}} Seat
 * @typedef {{tick: number, seat: string, kind: string, words: string, minor: boolean}} Line
 * @typedef {{message: number, sender: string, text: string, question: boolean, object: string,
 *   position: number[] | null, picture: string}} Letter
 * @typedef {{tick: number, panel: number | null, answer: string, map: number[] | null}} Screen
 * @typedef {{position: number[], turn: number[]}} Place position [m] and quaternion (x, y, z, w)
 */

export class Recording {
  /** @param {any} given what the page was given */
  constructor(given) {
    Object.assign(this, given);
    /** @type {string} */ this.instruction = given.instruction;
    /** @type {string} */ this.task = given.task;
    /** @type {string[]} */ this.outcome = given.outcome;
    /** @type {number} */ this.ticks = given.ticks;
    /** [s] of a tick. @type {number} */ this.tick_s = given.tick_s;
    /** [m] of the rooms. @type {number} */ this.height = given.height;
    /** @type {{name: string, polygon: number[][]}[]} */ this.rooms = given.rooms;
    /** @type {Seat[]} */ this.seats = given.seats;
    /** @type {Line[]} */ this.events = given.events;
    /** @type {Letter[]} */ this.messages = given.messages;
    /** @type {Record<string, Screen[]>} */ this.screens = given.screens;
    /** @type {Record<string, [number, string][]>} */ this.hands = given.hands;
    /** @type {Map<number, Track>} */
    this.tracks = new Map(given.tracks.map((/** @type {any} */ track) => [track.part, new Track(track)]));
    /** What moves at all. @type {[number, Track][]} */
    this.moving = [...this.tracks].filter(([, track]) => track.ticks.length > 1);
  }

  /** [s] The length of the trial. */
  get seconds() {
    return this.ticks * this.tick_s;
  }

  /** Where all parts are at the beginning, as `House.put` takes them. */
  begin() {
    return [...this.tracks].map(([number, track]) => ({ number, ...track.at(0) }));
  }

  /** Where all parts are that ever move. @param {number} seconds */
  places(seconds) {
    return this.moving.map(([number, track]) => ({ number, ...track.at(seconds / this.tick_s) }));
  }

  /** Where somebody's body is and where they look. @param {Seat} seat @param {number} seconds */
  pose(seat, seconds) {
    const [body, head] = seat.own.map((part) => /** @type {Track} */ (this.tracks.get(part)).at(seconds / this.tick_s));
    const [x, y, z, w] = head.turn;
    const ahead = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)];
    const pitch = Math.asin(Math.max(-1, Math.min(1, ahead[2])));
    return { x: body.position[0], y: body.position[1], yaw: Math.atan2(ahead[1], ahead[0]), pitch };
  }

  /** What a person's display shows. @param {string} seat @param {number} seconds */
  screen(seat, seconds) {
    return last(this.screens[seat], this.tick(seconds), (screen) => screen.tick);
  }

  /** What somebody has in hand; empty for nothing. @param {string} seat @param {number} seconds */
  hand(seat, seconds) {
    return last(this.hands[seat], this.tick(seconds), ([tick]) => tick)[1];
  }

  /** The map of confirmed messages, as map.js draws it. @param {Seat} seat @param {number} seconds @param {number[]} shown */
  map(seat, seconds, shown) {
    const own = this.pose(seat, seconds);
    const letters = shown.map((number) => this.letter(number));
    const senders = [...new Set(letters.map((letter) => letter.sender))].sort();
    const bodies = senders.map((sender) => {
      const { x, y } = this.pose(this.seat(sender), seconds);
      return { seat: sender, ...relative(own, x, y) };
    });
    const places = letters.flatMap(({ message, object, position }) =>
      position ? [{ message, object, ...relative(own, position[0], position[1]) }] : []);
    return { bodies, places };
  }

  /** @param {string} name */
  seat(name) {
    return /** @type {Seat} */ (this.seats.find((seat) => seat.seat === name));
  }

  /** @param {number} number */
  letter(number) {
    return /** @type {Letter} */ (this.messages.find((one) => one.message === number));
  }

  /** The number of the last event so far, -1 before the first. @param {number} seconds */
  eventAt(seconds) {
    const tick = this.tick(seconds);
    return this.events.reduce((found, event, k) => (event.tick <= tick ? k : found), -1);
  }

  /** @param {number} seconds */
  tick(seconds) {
    return Math.floor(seconds / this.tick_s + 1e-6);
  }
}

/** Where one part was. */
class Track {
  /** @param {{ticks: number[], poses: number[][]}} given differences, see hthor/watch/recording.py */
  constructor(given) {
    this.ticks = sums(given.ticks);
    const columns = given.poses.map(sums);
    /** @type {Place[]} */
    this.places = this.ticks.map((_, k) => {
      const [x, y, z, qw, qx, qy, qz] = columns.map((column) => column[k]);
      return { position: [x / METRE, y / METRE, z / METRE], turn: [qx / ONE, qy / ONE, qz / ONE, qw / ONE] };
    });
  }

  /** Where it is at a time, which may be between two ticks. @param {number} tick @returns {Place} */
  at(tick) {
    const whole = Math.floor(tick + 1e-6);
    let low = 0;
    let high = this.ticks.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.ticks[middle] <= whole) low = middle;
      else high = middle;
    }
    const now = this.places[low];
    const share = tick - whole;
    if (share < 1e-3 || this.ticks[low + 1] !== whole + 1) return now;
    return between(now, this.places[low + 1], share);
  }
}

/** @param {Place} one @param {Place} other @param {number} share */
function between(one, other, share) {
  const gap = Math.hypot(...one.position.map((value, k) => other.position[k] - value));
  if (gap > JUMP_M) return one;
  const mix = (/** @type {number} */ a, /** @type {number} */ b) => a + share * (b - a);
  const sign = one.turn.reduce((sum, value, k) => sum + value * other.turn[k], 0) < 0 ? -1 : 1;
  const turn = one.turn.map((value, k) => mix(value, sign * other.turn[k]));
  const length = Math.hypot(...turn) || 1;
  return {
    position: one.position.map((value, k) => mix(value, other.position[k])),
    turn: turn.map((value) => value / length),
  };
}

/** A place as somebody sees it. @param {{x: number, y: number, yaw: number}} own @param {number} x @param {number} y */
function relative(own, x, y) {
  const [dx, dy] = [x - own.x, y - own.y];
  const [cos, sin] = [Math.cos(own.yaw), Math.sin(own.yaw)];
  return { forward: cos * dx + sin * dy, left: cos * dy - sin * dx };
}

/** The last of some rows, whose first is at 0, that began by a tick. @template T @param {T[]} rows @param {number} tick
 * @param {(row: T) => number} begins */
function last(rows, tick, begins) {
  return rows.reduce((found, row) => (begins(row) <= tick ? row : found), rows[0]);
}

/** @param {number[]} differences */
function sums(differences) {
  let sum = 0;
  return differences.map((difference) => (sum += difference));
}
