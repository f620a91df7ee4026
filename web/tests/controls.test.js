import assert from "node:assert/strict";
import { test } from "node:test";
import { Controls } from "../src/headset/controls.js";

const USUAL = { hand: "right", turn: 0, seated: false, vignette: true };
const BUTTONS = { trigger: 0, side: 1, stick: 3, lower: 4, upper: 5 };

/** Controllers with what is pressed and where their sticks are. */
function sources({ left = [], right = [], leftStick = [0, 0], rightStick = [0, 0], only = "" } = {}) {
  const made = (handedness, pressed, stick) => ({
    handedness,
    gamepad: {
      axes: [0, 0, ...stick],
      buttons: Array.from({ length: 7 }, (_, k) => {
        const on = pressed.some((name) => BUTTONS[name] === k);
        return { pressed: on, value: on ? 1 : 0 };
      }),
    },
  });
  const both = [made("left", left, leftStick), made("right", right, rightStick)];
  return both.filter((one) => !only || one.handedness === only);
}

test("a press counts once, however long it lasts", () => {
  const controls = new Controls(USUAL);
  assert.deepEqual(controls.read(sources({ right: ["side"] }), 0.02).actions, ["hand"]);
  for (let k = 0; k < 5; k += 1) assert.deepEqual(controls.read(sources({ right: ["side"] }), 0.02).actions, []);
  controls.read(sources(), 0.02);
  assert.deepEqual(controls.read(sources({ right: ["side"] }), 0.02).actions, ["hand"]);
});

for (const [hand, other] of [["right", "left"], ["left", "right"]]) {
  test(`with the ${hand} hand that answers, each button does what its name says`, () => {
    const controls = new Controls({ ...USUAL, hand });
    const says = (state) => {
      controls.read(sources(), 0.02);
      return controls.read(sources(state), 0.02).actions;
    };
    assert.deepEqual(says({ [hand]: ["lower"] }), ["accept"]);
    assert.deepEqual(says({ [hand]: ["upper"] }), ["decline"]);
    assert.deepEqual(says({ [other]: ["lower"] }), ["map"]);
    assert.deepEqual(says({ [other]: ["upper"] }), ["panel"]);
    assert.deepEqual(says({ [hand]: ["stick"] }), ["ready"]);
    assert.equal(controls.nameOf("accept"), hand === "right" ? "A" : "X");
    assert.equal(controls.nameOf("map"), hand === "right" ? "X" : "A");
    const walk = controls.read(sources({ [`${other}Stick`]: [0, -1] }), 0.02).stick;
    assert.equal(walk.forward, 1);
  });
}

test("the hand whose buttons were used last is the one that acts", () => {
  const controls = new Controls(USUAL);
  controls.read(sources({ left: ["trigger"] }), 0.02);
  assert.equal(controls.active, "left");
  controls.read(sources({ right: ["lower"] }), 0.02);
  assert.equal(controls.active, "left");
  controls.read(sources({ right: ["side"] }), 0.02);
  assert.equal(controls.active, "right");
});

test("one hand answers, walks, and shows and hides map and message", () => {
  for (const only of ["left", "right"]) {
    const controls = new Controls({ ...USUAL, hand: "one" });
    const press = (pressed, seconds) => {
      controls.read(sources({ [only]: pressed, only }), seconds);
      return controls.read(sources({ only }), 0.02).actions;
    };
    assert.deepEqual(controls.read(sources({ [only]: ["lower"], only }), 0.02).actions, ["accept"]);
    controls.read(sources({ only }), 0.02);
    assert.deepEqual(press(["stick"], 0.1), ["map"]);
    assert.deepEqual(press(["stick"], 0.7), ["panel"]);
    assert.equal(controls.nameOf("accept"), only === "left" ? "X" : "A");
    assert.equal(controls.read(sources({ [`${only}Stick`]: [0, -1], only }), 0.02).stick.forward, 1);
  }
});

test("a stick that is held to a side turns once", () => {
  const controls = new Controls({ ...USUAL, turn: 30 });
  const turned = [0.2, 0.9, 1, 0.9, 0, -1].map((x) => controls.read(sources({ rightStick: [x, 0] }), 0.02).turn);
  const angle = Math.PI / 6;
  assert.deepEqual(turned.map((turn) => Math.round((turn / angle) * 1e6) / 1e6 + 0), [0, -1, 0, 0, 0, 1]);
  assert.equal(new Controls(USUAL).read(sources({ rightStick: [1, 0] }), 0.02).turn, 0);
});

test("a stick that trembles does not walk", () => {
  const controls = new Controls(USUAL);
  const { forward, left } = controls.read(sources({ leftStick: [0.1, 0.08] }), 0.02).stick;
  assert.deepEqual([forward + 0, left + 0], [0, 0]);
});

test("controllers that are not there do nothing", () => {
  const controls = new Controls(USUAL);
  assert.deepEqual(controls.read([], 0.02).actions, []);
  assert.deepEqual(controls.read([{ handedness: "none", gamepad: null }], 0.02).actions, []);
});
