// The controllers of a headset: which button does what for which hand, and when one has just been pressed.

const [TRIGGER, SIDE, STICK, LOWER, UPPER] = [0, 1, 3, 4, 5]; // of the layout "xr-standard"
const PRESSED = 0.5;
const DEAD = 0.15;
const TURNED = 0.7;
const LONG_S = 0.6;

/**
 * @typedef {{hand: "right" | "left" | "one", turn: number, seated: boolean, vignette: boolean}} Options hand: the one that
 *   answers, or one that does everything; turn: the angle [degrees] of a turn by stick, 0 to turn round oneself
 */

/** The names of buttons, for a hand that answers and the other one. */
const BUTTONS = { right: ["A", "B", "X", "Y"], left: ["X", "Y", "A", "B"] };

/** One controller. */
class Controller {
  constructor() {
    this.was = this.now = /** @type {boolean[]} */ ([]);
    this.stick = [0, 0];
    this.there = false;
  }

  /** @param {any} gamepad null without one */
  update(gamepad) {
    this.was = this.now;
    this.there = gamepad !== null;
    this.now = this.there ? gamepad.buttons.map((/** @type {any} */ one) => one.pressed || one.value > PRESSED) : [];
    this.stick = this.there ? [gamepad.axes[2] ?? 0, gamepad.axes[3] ?? 0] : [0, 0];
  }

  /** Whether a button has just gone down. @param {number} button */
  pressed(button) {
    return Boolean(this.now[button]) && !this.was[button];
  }

  /** Whether a button has just come up. @param {number} button */
  released(button) {
    return !this.now[button] && Boolean(this.was[button]);
  }
}

/** Both controllers, as one person uses them. */
export class Controls {
  /** @param {Options} options */
  constructor(options) {
    this.options = options;
    this.left = new Controller();
    this.right = new Controller();
    this.turned = this.picked = false;
    this.stickDown = 0;
    /** The controller that acts: the one whose buttons were used last. @type {"left" | "right"} */
    this.active = options.hand === "left" ? "left" : "right";
  }

  /** The hand that answers; with one hand, the one whose controller is there. @returns {"left" | "right"} */
  get main() {
    if (this.options.hand !== "one") return this.options.hand;
    return this.left.there && !this.right.there ? "left" : "right";
  }

  get other() {
    return this.main === "left" ? "right" : "left";
  }

  /**
   * What the person does with buttons and sticks in this picture.
   * @param {Iterable<any>} sources the session's input sources @param {number} seconds since the last picture
   * @returns {{actions: string[], stick: {forward: number, left: number}, turn: number, choose: number}} the actions by
   *   name, the stick that walks (-1 to 1), the angle to turn by [rad], and a step along a scale (-1, 0 or 1)
   */
  read(sources, seconds) {
    const pads = /** @type {Record<string, any>} */ ({});
    for (const source of sources) if (source.gamepad) pads[source.handedness] = source.gamepad;
    if (this.options.hand === "one") delete pads[this.#unused(pads)];
    this.left.update(pads.left ?? null);
    this.right.update(pads.right ?? null);
    const walks = this[this.options.hand === "one" ? this.main : this.other];
    const turns = this[this.main];
    const one = this.options.hand === "one";
    const steps = this.options.turn > 0;
    const [x, y] = dead(walks.stick);
    return {
      actions: this.#actions(seconds),
      stick: { forward: -y, left: one && steps ? 0 : -x },
      turn: steps ? this.#turn(turns.stick[0]) : 0,
      choose: this.#choose(turns.stick[0]),
    };
  }

  /** The name of the button of an action. @param {string} action */
  nameOf(action) {
    const [accept, decline, map, panel] = BUTTONS[this.main];
    const one = this.options.hand === "one";
    const names = {
      hand: "side button",
      door: "trigger",
      drop: "side button",
      accept,
      decline,
      map: one ? "stick" : map,
      panel: one ? "stick, long" : panel,
      ready: one ? "" : "stick",
    };
    return /** @type {Record<string, string>} */ (names)[action] ?? "";
  }

  /** @param {number} seconds */
  #actions(seconds) {
    const actions = [];
    for (const hand of /** @type {const} */ (["left", "right"])) {
      const controller = this[hand];
      if (controller.pressed(SIDE) || controller.pressed(TRIGGER)) this.active = hand;
      if (controller.pressed(SIDE)) actions.push("hand");
      if (controller.pressed(TRIGGER)) actions.push("door");
    }
    const [main, other] = [this[this.main], this[this.other]];
    if (main.pressed(LOWER)) actions.push("accept");
    if (main.pressed(UPPER)) actions.push("decline");
    if (this.options.hand === "one") {
      if (main.now[STICK]) this.stickDown += seconds;
      if (main.released(STICK)) {
        actions.push(this.stickDown > LONG_S ? "panel" : "map");
        this.stickDown = 0;
      }
    } else {
      if (other.pressed(LOWER)) actions.push("map");
      if (other.pressed(UPPER)) actions.push("panel");
      if (main.pressed(STICK)) actions.push("ready");
    }
    return actions;
  }

  /** A turn by stick: one for each time that it goes to a side. @param {number} x */
  #turn(x) {
    const far = Math.abs(x) > TURNED;
    const turn = far && !this.turned ? (-Math.sign(x) * this.options.turn * Math.PI) / 180 : 0;
    this.turned = far;
    return turn;
  }

  /** @param {number} x */
  #choose(x) {
    const far = Math.abs(x) > TURNED;
    const step = far && !this.picked ? Math.sign(x) : 0;
    this.picked = far;
    return step;
  }

  /** The controller that somebody with one hand does not hold. @param {Record<string, any>} pads */
  #unused(pads) {
    const used = (/** @type {any} */ pad) => pad?.buttons.some((/** @type {any} */ button) => button.pressed);
    if (used(pads.left)) this.active = "left";
    else if (used(pads.right)) this.active = "right";
    return pads.left && pads.right ? (this.active === "left" ? "right" : "left") : "";
  }
}

/** A stick without the trembling around its middle. @param {number[]} stick */
function dead([x, y]) {
  const far = Math.hypot(x, y);
  if (far < DEAD) return [0, 0];
  const scale = Math.min(1, (far - DEAD) / (1 - DEAD)) / far;
  return [x * scale, y * scale];
}
