import assert from "node:assert/strict";
import { test } from "node:test";
import * as THREE from "three";
import { stage } from "./stage.js";

const { Headset } = await import("../src/headset/headset.js");

const USUAL = { hand: "right", turn: 0, seated: false, vignette: true };
const BODY = { x: 4, y: 2, yaw: 0.5, eye: 1.6 };

/** A picture of the headset with the head so high above its space's origin. */
function frame(height) {
  const matrix = new THREE.Matrix4().makeTranslation(0, height, 0).toArray();
  return { getViewerPose: () => ({ transform: { matrix } }), getPose: () => null };
}

for (const [spaces, seated, height, eyes] of [
  [["local-floor", "local", "viewer"], false, 1.72, 1.72],
  [["local-floor", "local", "viewer"], true, 1.2, 1.6],
  [["local", "viewer"], false, 0, 1.6],
  [["viewer"], false, 0, 1.6],
]) {
  test(`the eyes are ${eyes} m high in ${spaces[0]}${seated ? " for somebody who sits" : ""}`, async () => {
    const { renderer } = stage(spaces);
    const headset = new Headset(renderer, () => {});
    await headset.enter({ ...USUAL, seated });
    assert.equal(renderer.xr.kind, spaces[0]);
    headset.track(frame(height), 0.02, BODY);
    const { x, y, z, yaw } = headset.rig.head;
    for (const [found, wanted] of [[x, 4], [y, 2], [z, eyes], [yaw, 0.5]]) assert.ok(Math.abs(found - wanted) < 1e-9);
  });
}

test("the room is placed once, and once more when the person has recentred it", async () => {
  const { renderer } = stage();
  const headset = new Headset(renderer, () => {});
  await headset.enter(USUAL);
  headset.track(frame(1.7), 0.02, null); // the trial is not there yet
  headset.track(frame(1.7), 0.02, BODY);
  headset.track(frame(1.7), 0.02, { ...BODY, x: 9 });
  assert.ok(Math.abs(headset.rig.head.x - 4) < 1e-9);
  renderer.xr.getReferenceSpace().dispatchEvent(new Event("reset"));
  headset.track(frame(1.7), 0.02, { ...BODY, x: 9 });
  assert.ok(Math.abs(headset.rig.head.x - 9) < 1e-9);
});

test("twenty times in and out of VR, everything is there each time, and nothing is left", async () => {
  const { renderer } = stage();
  let changes = 0;
  const headset = new Headset(renderer, () => (changes += 1));
  for (let k = 0; k < 20; k += 1) {
    await headset.enter(USUAL);
    await headset.enter(USUAL); // pressed twice
    headset.track(frame(1.7), 0.02, BODY);
    assert.equal(headset.group.visible, true);
    assert.equal(headset.group.children.length, 2);
    assert.equal(Object.keys(headset.screens.sheets).length, 6);
    await headset.leave();
    assert.equal(headset.group.visible, false);
    assert.equal(headset.group.children.length, 0);
    assert.equal(headset.session, null);
  }
  assert.equal(changes, 40);
});

for (const refuse of ["browser", "renderer"]) {
  test(`a session that the ${refuse} refuses leaves no trace`, async () => {
    const { renderer, ended } = stage(undefined, refuse);
    const headset = new Headset(renderer, () => {});
    await assert.rejects(headset.enter(USUAL), /no headset|no layer/);
    assert.equal(headset.session, null);
    assert.equal(headset.group.children.length, 0);
    assert.equal(renderer.xr.enabled, false);
    assert.equal(ended.length, refuse === "renderer" ? 1 : 0);
  });
}
