import assert from "node:assert/strict";
import { test } from "node:test";
import { Controls } from "../src/headset/controls.js";
import { shownIn } from "../src/headset/shown.js";

/** The state of a page in the middle of a trial. */
function page(changes = {}) {
  const trial = { trial: 1, trials: 3, instruction: "Find a mug.", practice: false };
  const controls = new Controls({ hand: "right", turn: 0, seated: false, vignette: true });
  return {
    headset: { controls },
    trial,
    begun: true,
    plays: true,
    house: {},
    head: { tick: 0, step: 0 },
    left: 61.2,
    ended: null,
    now: { holding: "", phase: "" },
    offers: [["hand", "pick up the mug"], ["drop", "let go"], ["map", "show the map"]],
    panel: null,
    shownMap: null,
    steps: null,
    notice: { words: "", until: 0 },
    chosen: 4,
    card: () => ({}),
    ...changes,
  };
}

test("the task, the time and what the buttons do are there all the time", () => {
  const { task, card } = shownIn(page());
  assert.deepEqual(
    [task.trial, task.instruction, task.time, task.short],
    ["2 of 3", "Find a mug.", "1:02", false],
  );
  assert.deepEqual(task.offers, [["side button", "pick up the mug"], ["X", "show the map"]]);
  assert.equal(card, null);
});

test("nothing is told of a trial that has begun, but of which nothing has arrived yet", () => {
  const early = page({ head: null });
  Object.defineProperty(early, "left", { get: () => early.head.tick });
  assert.equal(shownIn(early).task, null);
});

test("a message has its answers, and a question has other ones", () => {
  const panel = { message: 3, sender: "robot", text: "Here.", picture: true, question: false };
  const words = (one) => shownIn(page({ panel: one })).message.hints.map(([, what]) => what);
  assert.deepEqual(words(panel), ["confirm", "decline", "hide"]);
  assert.deepEqual(words({ ...panel, question: true }), ["yes", "no", "hide"]);
});

test("a card takes the place of message and map, and a rating has seven values", () => {
  const rating = { title: "Done!", text: "", rate: 7, done: () => {} };
  const shown = shownIn(page({ plays: false, shownMap: {}, chosen: 6, card: () => rating }));
  assert.deepEqual([shown.message, shown.map], [null, null]);
  assert.deepEqual([shown.card.scale, shown.card.chosen], [7, 6]);
  const begin = shownIn(page({ card: () => ({ title: "Find a mug.", text: "", button: "Begin" }) })).card;
  assert.deepEqual([begin.scale, begin.hints], [0, [["A", "Begin"]]]);
});
