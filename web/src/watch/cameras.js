// From where the page looks: freely, from above, or through somebody's eyes.

import * as THREE from "three";
import { FOV, lookFrom } from "../eye.js";

const FREE_FOV = 45; // [degrees]
const LOW = -1.45; // [rad] how far down and up the free camera looks
const HIGH = 1.2;
const WALK_PER_S = 0.9; // of the distance to what it looks at
const SLOWEST_M_S = 1.6;
const NEAREST_M = 0.4;
const FARTHEST_M = 45;
const MARGIN_M = 0.4;

/**
 * @typedef {{left: number, right: number, low: number, high: number}} Bounds [m] of the house
 * @typedef {{wide: number, high: number, clear: {left: number, right: number, low: number, high: number}}} Frame the
 *   window, and the part of it that nothing covers, from its lower left [px]
 */

/** The middle of what nothing covers, from the middle of the window [px]. @param {Frame} frame */
function middle({ wide, high, clear }) {
  return [(clear.left + clear.right - wide) / 2, (clear.low + clear.high - high) / 2];
}

/** A camera that turns round a point, which moves with the keys. */
export class FreeCamera {
  /** @param {Bounds} bounds */
  constructor(bounds) {
    this.camera = new THREE.PerspectiveCamera(FREE_FOV, 1, 0.05, 250);
    this.camera.up.set(0, 0, 1);
    this.bounds = bounds;
  }

  /** Show the whole house. @param {Frame} frame */
  reset({ high: windowHigh, clear }) {
    const { left, right, low, high } = this.bounds;
    this.target = new THREE.Vector3((left + right) / 2, (low + high) / 2, 0.4);
    this.yaw = Math.PI / 2; // from the south
    this.pitch = -1.12;
    const half = Math.tan(THREE.MathUtils.degToRad(FREE_FOV / 2)) / windowHigh; // of a pixel's angle
    const wide = (right - left) / (half * (clear.right - clear.left)) / 2;
    const tall = ((high - low) * Math.sin(-this.pitch)) / (half * (clear.high - clear.low)) / 2;
    this.distance = Math.min(FARTHEST_M, Math.max(wide, tall) + ((high - low) / 2) * Math.cos(this.pitch));
  }

  /** Turn. @param {number} yaw @param {number} pitch [rad] */
  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.max(LOW, Math.min(HIGH, this.pitch + pitch));
  }

  /** @param {number} factor of the distance */
  zoom(factor) {
    const wanted = this.distance * factor;
    this.distance = Math.max(NEAREST_M, Math.min(FARTHEST_M, wanted));
    if (wanted < NEAREST_M) this.go(NEAREST_M - wanted, 0, 0); // it flies on
  }

  /** Move along the floor, and up. @param {number} ahead @param {number} left @param {number} up [m] */
  go(ahead, left, up) {
    const [cos, sin] = [Math.cos(this.yaw), Math.sin(this.yaw)];
    this.target.x += cos * ahead - sin * left;
    this.target.y += sin * ahead + cos * left;
    this.target.z = Math.max(0.1, Math.min(12, this.target.z + up));
  }

  /** Drag what is seen along. @param {number} right @param {number} down [share of the window's height] */
  drag(right, down) {
    const metres = 2 * this.distance * Math.tan(THREE.MathUtils.degToRad(FREE_FOV / 2));
    this.go(metres * down, metres * right, 0);
  }

  /** Walk with the keys. @param {Set<string>} held @param {number} seconds @returns whether it moved */
  walk(held, seconds) {
    const way = (/** @type {string} */ more, /** @type {string} */ less) => Number(held.has(more)) - Number(held.has(less));
    const [ahead, left, up] = [way("KeyW", "KeyS"), way("KeyA", "KeyD"), way("KeyE", "KeyQ")];
    if (!ahead && !left && !up) return false;
    const fast = held.has("ShiftLeft") || held.has("ShiftRight") ? 3 : 1;
    const metres = fast * seconds * Math.max(SLOWEST_M_S, WALK_PER_S * this.distance);
    this.go(metres * ahead, metres * left, metres * up);
    return true;
  }

  /** The camera now. @param {Frame} frame */
  aim(frame) {
    const flat = Math.cos(this.pitch) * this.distance;
    const { x, y, z } = this.target;
    const eye = [
      x - flat * Math.cos(this.yaw),
      y - flat * Math.sin(this.yaw),
      Math.max(0.1, z - Math.sin(this.pitch) * this.distance),
    ];
    lookFrom(this.camera, eye, this.yaw, this.pitch);
    const { wide, high } = frame;
    const [right, up] = middle(frame);
    this.camera.aspect = wide / high;
    this.camera.setViewOffset(wide, high, -right, up, wide, high);
    return this.camera;
  }
}

/** A camera high above, north up, without perspective. */
export class CameraAbove {
  /** @param {Bounds} bounds */
  constructor(bounds) {
    this.camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 100);
    this.bounds = bounds;
    this.reset();
  }

  /** Show the whole house. */
  reset() {
    const { left, right, low, high } = this.bounds;
    [this.x, this.y, this.scale] = [(left + right) / 2, (low + high) / 2, 1];
  }

  /** @param {number} factor */
  zoom(factor) {
    this.scale = Math.max(0.1, Math.min(2, this.scale * factor));
  }

  /** @param {number} right @param {number} down [share of the window's height] */
  drag(right, down) {
    this.x -= 2 * this.half * right;
    this.y += 2 * this.half * down;
  }

  /** The camera now. @param {Frame} frame */
  aim(frame) {
    const { left, right, low, high } = this.bounds;
    const { wide, high: windowHigh, clear } = frame;
    const tall = (high - low + 2 * MARGIN_M) / (clear.high - clear.low);
    const broad = (right - left + 2 * MARGIN_M) / (clear.right - clear.left);
    const pixel = this.scale * Math.max(tall, broad); // [m]
    this.half = (pixel * windowHigh) / 2;
    const [dx, dy] = middle(frame).map((pixels) => pixels * pixel);
    const { camera } = this;
    [camera.left, camera.right] = [(-pixel * wide) / 2 - dx, (pixel * wide) / 2 - dx];
    [camera.top, camera.bottom] = [this.half - dy, -this.half - dy];
    camera.up.set(0, 1, 0);
    camera.position.set(this.x, this.y, 50);
    camera.lookAt(this.x, this.y, 0);
    camera.updateProjectionMatrix();
    return camera;
  }
}

/** A camera in somebody's eye. */
export class EyeCamera {
  constructor() {
    this.camera = new THREE.PerspectiveCamera(FOV, 1, 0.05, 200);
    this.camera.up.set(0, 0, 1);
  }

  /** @param {import("./recording.js").Seat} seat @param {{x: number, y: number, yaw: number, pitch: number}} pose @param {number} aspect */
  aim(seat, { x, y, yaw, pitch }, aspect) {
    lookFrom(this.camera, [x, y, seat.eye], yaw, pitch);
    this.camera.fov = seat.fov ? THREE.MathUtils.radToDeg(seat.fov[1]) : FOV;
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
    return this.camera;
  }
}

/** How much wider than high somebody's view is. @param {import("./recording.js").Seat} seat @param {number} own */
export function aspectOf({ fov }, own) {
  return fov ? Math.tan(fov[0] / 2) / Math.tan(fov[1] / 2) : own;
}
