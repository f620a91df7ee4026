// What keys and mouse do. Every key is shown on screen, and can be changed.

const STORE = "hthor-keys";
export const LOOK_PER_PIXEL = 0.0024; // [rad]
export const TILT_MOST = 1.35; // [rad]

/** Every action: its words, and its key unless the person chooses another. @type {Record<string, [string, string]>} */
export const ACTIONS = {
  forward: ["walk forward", "KeyW"],
  back: ["walk back", "KeyS"],
  left: ["walk left", "KeyA"],
  right: ["walk right", "KeyD"],
  turnLeft: ["turn left", "ArrowLeft"],
  turnRight: ["turn right", "ArrowRight"],
  lookUp: ["look up", "ArrowUp"],
  lookDown: ["look down", "ArrowDown"],
  hand: ["pick up or put down", "KeyE"],
  door: ["open or close", "KeyF"],
  drop: ["let go", "KeyG"],
  accept: ["confirm a message", "KeyY"],
  decline: ["decline a message", "KeyN"],
  panel: ["hide or show the message", "KeyP"],
  map: ["hide or show the map", "KeyM"],
  ready: ["ready for the next part", "KeyR"],
  keys: ["show the keys", "KeyK"],
};

const TURN_PER_S = 1.6; // [rad/s]

/** The words for a key. @param {string} code */
export function keyName(code) {
  const arrows = { ArrowLeft: "←", ArrowRight: "→", ArrowUp: "↑", ArrowDown: "↓" };
  return /** @type {Record<string, string>} */ (arrows)[code] ?? code.replace(/^Key|^Digit/, "");
}

/** The keys, the mouse, and where the person looks. */
export class Keys {
  /**
   * @param {HTMLElement} view where the mouse looks around
   * @param {(action: string) => void} onPress called when the key of an action is pressed
   */
  constructor(view, onPress) {
    this.yaw = this.pitch = 0;
    /** @type {Set<string>} */
    this.held = new Set();
    /** @type {Record<string, string>} */
    this.codes = { ...Object.fromEntries(Object.entries(ACTIONS).map(([name, [, code]]) => [name, code])), ...load() };
    /** What a digit does, while somebody is asked for one. @type {((value: number) => void) | null} */
    this.digits = null;
    /** The action whose key is being chosen, with what to do then. @type {[string, () => void] | null} */
    this.choosing = null;
    addEventListener("keydown", (event) => this.#down(event, onPress));
    addEventListener("keyup", (event) => this.held.delete(event.code));
    addEventListener("blur", () => this.held.clear());
    view.addEventListener("click", () => view.requestPointerLock?.()?.catch?.(() => {}));
    view.addEventListener("mousemove", (event) => this.#look(event, view));
  }

  /** Let the person choose the key of an action. @param {string} action @param {() => void} done */
  choose(action, done) {
    this.choosing = [action, done];
  }

  /**
   * The steering for a picture.
   * @param {number} seconds since the last @param {number} speed [m/s]
   * @returns {import("./wire.js").Drive}
   */
  drive(seconds, speed) {
    const on = (/** @type {string} */ action) => (this.held.has(this.codes[action]) ? 1 : 0);
    this.yaw += TURN_PER_S * seconds * (on("turnLeft") - on("turnRight"));
    this.#tilt(TURN_PER_S * seconds * (on("lookUp") - on("lookDown")));
    const forward = on("forward") - on("back");
    const left = on("left") - on("right");
    const scale = speed / Math.max(1, Math.hypot(forward, left));
    return { forward: forward * scale, left: left * scale, yaw: this.yaw, pitch: this.pitch };
  }

  /** @param {KeyboardEvent} event @param {(action: string) => void} onPress */
  #down(event, onPress) {
    if (event.target instanceof HTMLInputElement || event.ctrlKey || event.metaKey || event.altKey) return;
    if (this.choosing) {
      const [action, done] = this.choosing;
      this.choosing = null;
      if (event.code !== "Escape") this.#bind(action, event.code);
      event.preventDefault();
      done();
      return;
    }
    const digit = /^(?:Digit|Numpad)([0-9])$/.exec(event.code);
    if (digit && this.digits && !event.repeat) return this.digits(Number(digit[1]));
    const action = Object.keys(this.codes).find((name) => this.codes[name] === event.code);
    if (action === undefined) return;
    event.preventDefault();
    if (!event.repeat && !this.held.has(event.code)) onPress(action);
    this.held.add(event.code);
  }

  /** Give an action a key; the action that had it gets the other one's. @param {string} action @param {string} code */
  #bind(action, code) {
    const other = Object.keys(this.codes).find((name) => this.codes[name] === code);
    if (other) this.codes[other] = this.codes[action];
    this.codes[action] = code;
    localStorage.setItem(STORE, JSON.stringify(this.codes));
  }

  /** @param {MouseEvent} event @param {HTMLElement} view */
  #look(event, view) {
    if (document.pointerLockElement !== view && event.buttons === 0) return;
    this.yaw -= LOOK_PER_PIXEL * event.movementX;
    this.#tilt(-LOOK_PER_PIXEL * event.movementY);
  }

  /** @param {number} up */
  #tilt(up) {
    this.pitch = Math.min(TILT_MOST, Math.max(-TILT_MOST, this.pitch + up));
  }
}

function load() {
  try {
    const saved = JSON.parse(localStorage.getItem(STORE) ?? "{}");
    const known = Object.entries(saved).filter(([name, code]) => name in ACTIONS && typeof code === "string");
    return Object.fromEntries(known);
  } catch {
    return {};
  }
}
