import assert from "node:assert/strict";
import { test } from "node:test";
import * as THREE from "three";
import { Rig } from "../src/headset/rig.js";

/** A head in the room: its place, y up, and its heading to the left of ahead, and how far it looks up. */
function pose(x, y, z, yaw = 0, pitch = 0) {
  const turn = new THREE.Quaternion().setFromEuler(new THREE.Euler(pitch, yaw, 0, "YXZ"));
  return new THREE.Matrix4().compose(new THREE.Vector3(x, y, z), turn, new THREE.Vector3(1, 1, 1));
}

function near(found, wanted) {
  for (const [name, value] of Object.entries(wanted)) assert.ok(Math.abs(found[name] - value) < 1e-9, `${name}: ${found[name]}, not ${value}`);
}

test("a person stands where their body is, and looks where it looks", () => {
  const rig = new Rig();
  rig.look(pose(0.3, 1.7, -0.4, 0.5));
  rig.stand(4, 2, -1);
  near(rig.head, { x: 4, y: 2, z: 1.7, yaw: -1, pitch: 0 });
});

test("ahead in the room is ahead in the house", () => {
  const rig = new Rig();
  rig.look(pose(0, 1.6, 0));
  rig.stand(0, 0, 0);
  rig.look(pose(0, 1.6, -1));
  near(rig.head, { x: 1, y: 0, yaw: 0 });
  rig.look(pose(-1, 1.6, 0, Math.PI / 2));
  near(rig.head, { x: 0, y: 1, yaw: Math.PI / 2 });
});

test("a turn by stick is about the head, wherever it is in the room", () => {
  const rig = new Rig();
  rig.look(pose(0.8, 1.6, 1.1, 0.2));
  rig.stand(3, 1, 0.5);
  for (let k = 0; k < 8; k += 1) rig.turn(Math.PI / 4);
  near(rig.head, { x: 3, y: 1, z: 1.6 });
  rig.turn(-Math.PI / 6);
  near(rig.head, { x: 3, y: 1, yaw: 0.5 - Math.PI / 6 });
});

for (const [up, pitch] of [["down", -Math.PI / 2], ["up", Math.PI / 2]]) {
  test(`somebody who looks straight ${up} has a heading`, () => {
    const rig = new Rig();
    rig.look(pose(0, 1.6, 0));
    rig.stand(0, 0, 1.2);
    rig.look(pose(0, 1.6, 0, 0, pitch));
    near(rig.head, { yaw: 1.2, pitch });
  });
}

test("the eyes of somebody who sits are raised to those of the body", () => {
  const rig = new Rig();
  rig.look(pose(0, 1.15, 0));
  rig.raise(1.6);
  near(rig.head, { z: 1.6 });
  rig.look(pose(0, 1.05, 0)); // they bend down
  near(rig.head, { z: 1.5 });
});

test("the stick walks along the heading, no faster than the body can", () => {
  const rig = new Rig();
  rig.look(pose(0, 1.6, 0));
  rig.stand(0, 0, 1);
  const drive = rig.drive({ forward: 1, left: 1 }, 1.3, { x: 0, y: 0 });
  assert.ok(Math.abs(Math.hypot(drive.forward, drive.left) - 1.3) < 1e-9);
  near(drive, { yaw: 1, forward: drive.left });
});

test("walking by stick moves the room with the body", () => {
  const rig = new Rig();
  rig.look(pose(0, 1.6, 0));
  rig.stand(0, 0, 0);
  rig.drive({ forward: 1, left: 0 }, 1, { x: 0, y: 0 });
  rig.follow({ x: 0.02, y: 0 }, 0.02, 1);
  near(rig.head, { x: 0.02, y: 0 });
});

test("the body follows a step in the room, and the room stays where it is", () => {
  const rig = new Rig();
  rig.look(pose(0, 1.6, 0));
  rig.stand(0, 0, 0);
  rig.look(pose(0, 1.6, -0.3)); // a step ahead
  const body = { x: 0, y: 0 };
  for (let k = 0; k < 200; k += 1) {
    const drive = rig.drive({ forward: 0, left: 0 }, 1.3, body);
    const after = { x: body.x + 0.02 * drive.forward, y: body.y + 0.02 * drive.left };
    rig.follow(after, 0.02, 1);
    Object.assign(body, after);
  }
  near(rig.head, { x: 0.3, y: 0 });
  assert.ok(Math.abs(body.x - 0.3) < 0.05);
});

test("a head that sways moves nobody, and one behind a wall takes the room back to the body", () => {
  const rig = new Rig();
  rig.look(pose(0, 1.6, 0));
  rig.stand(0, 0, 0);
  rig.look(pose(0.02, 1.6, -0.02));
  near(rig.drive({ forward: 0, left: 0 }, 1.3, { x: 0, y: 0 }), { forward: 0, left: 0 });
  rig.look(pose(0, 1.6, -2));
  rig.drive({ forward: 0, left: 0 }, 1.3, { x: 0, y: 0 });
  rig.follow({ x: 0, y: 0 }, 0.02, 0); // a wall is in the way
  assert.ok(Math.abs(Math.hypot(rig.head.x, rig.head.y) - 0.4) < 1e-9);
});
