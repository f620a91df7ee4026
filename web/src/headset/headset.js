// Taking part with a headset: entering and leaving VR, the hands, and what is seen of oneself.

import * as THREE from "three";
import { FOV } from "../eye.js";
import { Controls } from "./controls.js";
import { Rig } from "./rig.js";
import { Screens } from "./screens.js";
import { vignette } from "./vignette.js";

/** The reference spaces in which a room can be told, best first. Only in the first the floor is known. */
const SPACES = /** @type {const} */ (["local-floor", "local", "viewer"]);
const HAND_COLOUR = 0x4a6fa5;

/** Whether this browser has a headset. */
export async function hasHeadset() {
  try {
    return Boolean(await navigator.xr?.isSessionSupported("immersive-vr"));
  } catch {
    return false;
  }
}

/** A person's headset. Everything it draws is in `group`. */
export class Headset {
  /** @param {THREE.WebGLRenderer} renderer @param {() => void} onChange called when VR has begun or ended */
  constructor(renderer, onChange) {
    this.renderer = renderer;
    this.onChange = onChange;
    this.group = new THREE.Group();
    this.group.visible = false;
    /** @type {XRSession | null} */
    this.session = null;
    this.entering = false;
    /** Which reference space tells where the head is. */
    this.space = "";
  }

  /**
   * Enter VR; browsers allow that only when somebody has just pressed something.
   * @param {import("./controls.js").Options} options
   */
  async enter(options) {
    if (this.session || this.entering || !navigator.xr) return;
    this.entering = true;
    try {
      await this.#open(await navigator.xr.requestSession("immersive-vr", { optionalFeatures: ["local-floor"] }));
    } finally {
      this.entering = false;
    }
    this.options = options;
    this.controls = new Controls(options);
    this.rig = new Rig();
    this.camera = new THREE.PerspectiveCamera(FOV, 1, 0.05, 200);
    this.shade = vignette();
    this.camera.add(this.shade);
    this.rig.room.add(this.camera);
    this.screens = new Screens();
    this.hands = { left: handMesh(), right: handMesh() };
    this.rig.room.add(this.hands.left, this.hands.right);
    this.group.add(this.rig.group, this.screens.group);
    this.group.visible = true;
    /** How what is in hand lies in it. @type {{number: number, turn: THREE.Quaternion} | null} */
    this.grip = null;
    this.height = 0;
    this.recentre();
    this.onChange();
  }

  /** @param {XRSession} session */
  async #open(session) {
    const { xr } = this.renderer;
    try {
      this.space = await firstSpace(session);
      xr.enabled = true;
      xr.setReferenceSpaceType(/** @type {XRReferenceSpaceType} */ (this.space));
      await xr.setSession(session);
    } catch (problem) {
      xr.enabled = false;
      await session.end().catch(() => {});
      throw problem;
    }
    session.addEventListener("end", () => this.#end());
    session.addEventListener("visibilitychange", () => this.onChange());
    xr.getReferenceSpace()?.addEventListener("reset", () => this.recentre());
    this.session = session;
  }

  /** Whether the person is in VR, but does not see the house: the headset is off, or its system's menu hides it. */
  get off() {
    return this.session?.visibilityState === "hidden";
  }

  /** Leave VR. */
  leave() {
    return this.session?.end();
  }

  /** Stand where the body is, and look where it looks, in the next picture. */
  recentre() {
    this.standing = false;
    this.screens?.recentre();
  }

  /**
   * Take where head and hands are.
   * @param {XRFrame} frame @param {number} seconds since the last one
   * @param {{x: number, y: number, yaw: number, eye: number} | null} body of the person, once it is known
   * @returns what they did with buttons and sticks
   */
  track(frame, seconds, body) {
    const space = /** @type {XRReferenceSpace} */ (this.renderer.xr.getReferenceSpace());
    const viewer = frame.getViewerPose(space);
    if (viewer) this.rig.look(new THREE.Matrix4().fromArray(viewer.transform.matrix));
    if (viewer && body && !this.standing) {
      this.rig.stand(body.x, body.y, body.yaw);
      if (this.options.seated || this.space !== "local-floor") this.rig.raise(body.eye);
      this.standing = true;
    }
    for (const source of this.session.inputSources) {
      const hand = this.hands[source.handedness];
      const pose = hand && source.gripSpace && frame.getPose(source.gripSpace, space);
      const ray = hand && frame.getPose(source.targetRaySpace, space);
      if (!hand) continue;
      hand.visible = Boolean(pose);
      if (!pose) continue;
      hand.matrix.fromArray(pose.transform.matrix);
      hand.matrix.decompose(hand.position, hand.quaternion, hand.scale);
      if (ray) hand.userData.ray = new THREE.Quaternion().copy(/** @type {any} */ (ray.transform.orientation));
    }
    return this.controls.read(this.session.inputSources, seconds);
  }

  /** The hand that acts, in the house; null without a controller. @returns {import("../wire.js").Hand | null} */
  get hand() {
    const hand = this.hands[this.controls.active];
    if (!hand.visible) return null;
    hand.updateWorldMatrix(true, false);
    const ray = hand.userData.ray ?? hand.quaternion;
    const direction = new THREE.Vector3(0, 0, -1).applyQuaternion(ray).transformDirection(this.rig.room.matrixWorld);
    return { place: new THREE.Vector3().setFromMatrixPosition(hand.matrixWorld).toArray(), direction: direction.toArray() };
  }

  /**
   * Where what is in hand is drawn: in the hand, and turned with it.
   * @param {number} number of its part @param {number[]} turn of the part now, x, y, z, w
   */
  held(number, turn) {
    const hand = this.hands[this.controls.active];
    if (number < 0 || !hand.visible) {
      this.grip = null;
      return null;
    }
    hand.updateWorldMatrix(true, false);
    const now = new THREE.Quaternion().setFromRotationMatrix(hand.matrixWorld);
    if (this.grip?.number !== number) this.grip = { number, turn: now.clone().invert().multiply(new THREE.Quaternion(...turn)) };
    const position = new THREE.Vector3().setFromMatrixPosition(hand.matrixWorld).toArray();
    return { number, position, turn: now.multiply(this.grip.turn).toArray() };
  }

  /** Darken the edge of the picture while the person is moved by stick. @param {boolean} moves @param {number} seconds */
  darken(moves, seconds) {
    const goal = moves && this.options.vignette ? 1 : 0;
    const { uniforms } = /** @type {THREE.ShaderMaterial} */ (this.shade.material);
    uniforms.strength.value += (1 - Math.exp(-8 * seconds)) * (goal - uniforms.strength.value);
  }

  #end() {
    this.session = null;
    this.renderer.xr.enabled = false;
    this.group.visible = false;
    this.group.clear();
    this.screens?.dispose();
    this.onChange();
  }
}

/** The best reference space that a session has. @param {XRSession} session */
async function firstSpace(session) {
  for (const space of SPACES) {
    try {
      await session.requestReferenceSpace(space);
      return space;
    } catch {
      // the next one
    }
  }
  return "viewer"; // which every session has
}

/** A hand: a fist. */
function handMesh() {
  const made = new THREE.Group();
  const fist = new THREE.Mesh(new THREE.SphereGeometry(0.04, 16, 12), new THREE.MeshBasicMaterial({ color: HAND_COLOUR }));
  fist.scale.set(0.8, 0.8, 1.2);
  made.add(fist);
  made.visible = false;
  return made;
}
