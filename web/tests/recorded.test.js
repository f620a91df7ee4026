// What somebody with an emulated headset did, repeated without a browser: the page makes of it what it did then.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { test } from "node:test";
import * as THREE from "three";
import { stage } from "./stage.js";

const { Headset } = await import("../src/headset/headset.js");

const FOLDER = new URL("recordings/", import.meta.url);
const CLOSE = 2e-3; // recordings are rounded to a tenth of a millimetre

/** A pose as browsers give it. @param {number[] | null} numbers position and orientation (x, y, z, w) */
function poseOf(numbers) {
  if (!numbers) return null;
  const [position, orientation] = [new THREE.Vector3(...numbers.slice(0, 3)), new THREE.Quaternion(...numbers.slice(3))];
  const matrix = new THREE.Matrix4().compose(position, orientation, new THREE.Vector3(1, 1, 1)).toArray();
  return { transform: { matrix, orientation: { x: numbers[3], y: numbers[4], z: numbers[5], w: numbers[6] } } };
}

/** An input source as browsers give it. @param {any} one */
function sourceOf({ hand, grip, ray, buttons, axes }) {
  const pressed = buttons.map((/** @type {number} */ value) => ({ value, pressed: value > 0.5 }));
  return { handedness: hand, gripSpace: { pose: grip }, targetRaySpace: { pose: ray }, gamepad: { buttons: pressed, axes } };
}

/** @param {any} found @param {any} wanted @param {string} where */
function assertClose(found, wanted, where) {
  if (typeof wanted !== "number") {
    assert.equal(found === null, wanted === null, where);
    for (const key of Object.keys(wanted ?? {})) assertClose(found[key], wanted[key], `${where}, ${key}`);
  } else {
    const gap = Math.abs(found - wanted);
    assert.ok(Math.min(gap, Math.abs(gap - 2 * Math.PI)) < CLOSE, `${where}: ${found}, recorded ${wanted}`);
  }
}

for (const name of readdirSync(FOLDER).sort()) {
  test(`${name.replace(".json", "")}: what was done in a delivery is understood as it was then`, async () => {
    const { options, space, pictures } = JSON.parse(readFileSync(new URL(name, FOLDER), "utf8"));
    const headset = new Headset(stage([space]).renderer, () => {});
    await headset.enter(options);
    /** @type {any} */
    const now = {};
    const acted = new Set();
    pictures.forEach((/** @type {any} */ changes, /** @type {number} */ number) => {
      Object.assign(now, changes);
      headset.session.inputSources = now.sources.map(sourceOf);
      const frame = { getViewerPose: () => poseOf(now.head), getPose: (/** @type {any} */ { pose }) => poseOf(pose) };
      const done = headset.track(/** @type {any} */ (frame), now.seconds, now.body);
      const where = `picture ${number}`;
      assert.deepEqual(done.actions, now.actions, where);
      done.actions.forEach((action) => acted.add(action));
      if (done.turn) headset.rig.turn(done.turn);
      assertClose(headset.hand, now.hand, `${where}, hand`);
      if (!now.drive) return;
      assertClose(headset.rig.drive(done.stick, now.speed, now.body), now.drive, `${where}, drive`);
      headset.rig.follow(now.follow, now.seconds, now.follow.share);
    });
    assert.deepEqual([...acted].sort(), ["accept", "door", "hand"]);
  });
}
