// What is drawn into the house for whoever looks from outside: ways on the floor, fields of view, and names.

import * as THREE from "three";

const HALF_WAY_M = 0.035;
const ABOVE_FLOOR_M = 0.02;
const SIGHT_M = 2.4;
const SEGMENTS = 24;

/** The way that everybody has come, and what they look at. */
export class Overlays {
  /** @param {import("./recording.js").Recording} recording */
  constructor(recording) {
    this.recording = recording;
    this.group = new THREE.Group();
    this.seats = recording.seats.map((seat) => {
      const colour = new THREE.Color(seat.colour);
      const way = new THREE.Mesh(ribbon(recording, seat), paint(colour, 0.8));
      const sight = new THREE.Mesh(fan(seat.fov ? seat.fov[0] : 1.6), paint(colour, 0.22));
      for (const mesh of [way, sight]) mesh.frustumCulled = false;
      way.renderOrder = 2;
      sight.renderOrder = 3;
      this.group.add(way, sight);
      return { seat, way, sight };
    });
  }

  /** @param {number} seconds */
  show(seconds) {
    const done = Math.min(this.recording.ticks, Math.floor(seconds / this.recording.tick_s + 1e-6));
    for (const { seat, way, sight } of this.seats) {
      way.geometry.setDrawRange(0, 6 * done);
      const { x, y, yaw } = this.recording.pose(seat, seconds);
      sight.position.set(x, y, ABOVE_FLOOR_M);
      sight.rotation.z = yaw;
    }
  }
}

/** @param {THREE.Color} color @param {number} opacity */
function paint(color, opacity) {
  return new THREE.MeshBasicMaterial({
    color, opacity, transparent: true, depthWrite: false, side: THREE.DoubleSide,
    polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -2,
  });
}

/** A band along somebody's way, of two triangles for each tick. @param {any} recording @param {any} seat */
function ribbon(recording, seat) {
  const { ticks, tick_s } = recording;
  const places = Array.from({ length: ticks + 1 }, (_, k) => recording.pose(seat, k * tick_s));
  const corners = new Float32Array(6 * (ticks + 1));
  const index = [];
  let [ux, uy] = [0, 1]; // across
  places.forEach((place, k) => {
    const [before, after] = [places[Math.max(0, k - 1)], places[Math.min(ticks, k + 1)]];
    const [dx, dy] = [after.x - before.x, after.y - before.y];
    const length = Math.hypot(dx, dy);
    if (length > 1e-3) [ux, uy] = [-dy / length, dx / length];
    corners.set([place.x + HALF_WAY_M * ux, place.y + HALF_WAY_M * uy, ABOVE_FLOOR_M], 6 * k);
    corners.set([place.x - HALF_WAY_M * ux, place.y - HALF_WAY_M * uy, ABOVE_FLOOR_M], 6 * k + 3);
    if (k < ticks) index.push(2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 2, 2 * k + 1, 2 * k + 3);
  });
  const made = new THREE.BufferGeometry();
  made.setAttribute("position", new THREE.BufferAttribute(corners, 3));
  made.setIndex(index);
  return made;
}

/** A field of view on the floor. @param {number} angle [rad] */
function fan(angle) {
  return new THREE.CircleGeometry(SIGHT_M, SEGMENTS, -angle / 2, angle);
}

/** Names over heads, and what messages are about at the place that they claim. */
export class Labels {
  /** @param {HTMLElement} place @param {import("./recording.js").Recording} recording */
  constructor(place, recording) {
    this.place = place;
    this.recording = recording;
    /** @type {Map<string, HTMLElement>} */
    this.known = new Map();
  }

  /**
   * Show them where a camera sees them.
   * @param {THREE.Camera | null} camera null to show none @param {number} seconds
   * @param {number} width @param {number} height of the window [px]
   */
  show(camera, seconds, width, height) {
    const wanted = camera ? [...this.#bodies(seconds), ...this.#claims(seconds)] : [];
    const left = new Set(this.known.keys());
    for (const { key, text, colour, at } of wanted) {
      const spot = new THREE.Vector3(...at).project(/** @type {THREE.Camera} */ (camera));
      if (spot.z > 1 || Math.abs(spot.x) > 1.05 || Math.abs(spot.y) > 1.05) continue;
      left.delete(key);
      const label = this.known.get(key) ?? this.#make(key, text, colour);
      const [x, y] = [(0.5 + 0.5 * spot.x) * width, (0.5 - 0.5 * spot.y) * height];
      label.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -100%)`;
    }
    for (const key of left) {
      this.known.get(key)?.remove();
      this.known.delete(key);
    }
  }

  /** @param {number} seconds */
  #bodies(seconds) {
    return this.recording.seats.map((seat) => {
      const { x, y } = this.recording.pose(seat, seconds);
      return { key: seat.seat, text: seat.seat, colour: seat.colour, at: /** @type {[number, number, number]} */ ([x, y, seat.height + 0.12]) };
    });
  }

  /** The places of messages that are on anybody's panel or map. @param {number} seconds */
  #claims(seconds) {
    const numbers = new Set();
    for (const seat of Object.keys(this.recording.screens)) {
      const { panel, map } = this.recording.screen(seat, seconds);
      for (const number of [...(map ?? []), ...(panel === null ? [] : [panel])]) numbers.add(number);
    }
    return [...numbers].flatMap((number) => {
      const { object, position } = this.recording.letter(number);
      if (!position) return [];
      const text = `★ ${object.replaceAll("_", " ").replaceAll("|", " ")}`;
      return [{ key: `message ${number}`, text, colour: "#7a3b8f", at: /** @type {[number, number, number]} */ ([...position]) }];
    });
  }

  /** @param {string} key @param {string} text @param {string} colour */
  #make(key, text, colour) {
    const label = document.createElement("div");
    label.textContent = text;
    label.style.background = colour;
    this.known.set(key, label);
    this.place.append(label);
    return label;
  }
}
