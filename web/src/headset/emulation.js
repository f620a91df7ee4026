// A headset that is not there: Meta's emulator of the Quest, with the keys and the mouse of the desk.

import { XRDevice, metaQuest2, metaQuest3 } from "iwer";
import { ACTIONS, LOOK_PER_PIXEL, TILT_MOST } from "../keys.js";

const EYES_M = 1.6;
/** The button that the key of an action at a desk presses. @type {Record<string, [string, string]>} */
const BUTTONS = {
  hand: ["right", "squeeze"],
  door: ["right", "trigger"],
  accept: ["right", "a-button"],
  decline: ["right", "b-button"],
  map: ["left", "x-button"],
  panel: ["left", "y-button"],
  ready: ["right", "thumbstick"],
};
const KEYS = Object.fromEntries(Object.entries(BUTTONS).map(([action, button]) => [ACTIONS[action][1], button]));

/** Put an emulated headset where the browser would have its own. @param {string} name "quest2" or "quest3" */
export function emulate(name) {
  const device = new XRDevice(name === "quest2" ? metaQuest2 : metaQuest3);
  device.installRuntime(/** @type {any} */ ({ forceInstall: true }));
  device.stereoEnabled = false;
  device.position.set(0, EYES_M, 0);
  return device;
}

/** Let keys and mouse move an emulated headset. @param {any} device @param {HTMLElement} view where the mouse looks around */
export function steerByKeys(device, view) {
  /** @type {Set<string>} */
  const held = new Set();
  let yaw = 0;
  let pitch = 0;
  const stick = () => {
    const on = (/** @type {string} */ code) => (held.has(code) ? 1 : 0);
    device.controllers.left.updateAxes("thumbstick", on("KeyD") - on("KeyA"), on("KeyS") - on("KeyW"));
    device.controllers.right.updateAxes("thumbstick", on("ArrowRight") - on("ArrowLeft"), 0);
  };
  const key = (/** @type {KeyboardEvent} */ event) => {
    const down = event.type === "keydown";
    if (down) held.add(event.code);
    else held.delete(event.code);
    const button = KEYS[event.code];
    if (button) device.controllers[button[0]].updateButtonValue(button[1], down ? 1 : 0);
    stick();
  };
  addEventListener("keydown", key);
  addEventListener("keyup", key);
  view.addEventListener("mousemove", (event) => {
    if (document.pointerLockElement !== view) return;
    yaw -= LOOK_PER_PIXEL * event.movementX;
    pitch = Math.max(-TILT_MOST, Math.min(TILT_MOST, pitch - LOOK_PER_PIXEL * event.movementY));
    const [sy, cy, sp, cp] = [Math.sin(yaw / 2), Math.cos(yaw / 2), Math.sin(pitch / 2), Math.cos(pitch / 2)];
    device.quaternion.set(cy * sp, sy * cp, -sy * sp, cy * cp);
  });
}
