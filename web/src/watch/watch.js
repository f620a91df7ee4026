// The page of `hthor watch`: a trial that was played, from anywhere and at any time.

import * as THREE from "three";
import { House, outdoors } from "../house.js";
import { CameraAbove, EyeCamera, FreeCamera, aspectOf } from "./cameras.js";
import { Displays } from "./displays.js";
import { Labels, Overlays } from "./overlays.js";
import { Pointer } from "./pointer.js";
import { Recording } from "./recording.js";
import { SPEEDS, Timeline } from "./timeline.js";

const FREE = "free";
const ABOVE = "above";
const EYE_PX = 108; // height of the small pictures
const EYE_ASPECT = 1.4; // of the window of somebody at a page, which nobody knows
const EYES_EVERY_MS = 150;
const NARROW_PX = 900; // as in the style sheet
const GAP_PX = 10;
const NOTE_MS = 300; // until the address names the moment
const KEYS = [
  ["Space", "play and pause"],
  ["← →", "to the event before, or after"],
  [", .", "a tenth of a second back, or on"],
  ["− +", "slower, faster"],
  ["1 2 3 …", "free, from above, and everybody's eyes"],
  ["W A S D", "fly, with Shift faster; E and Q: up and down"],
  ["mouse", "turn; with Shift or the right button: move; wheel: nearer"],
  ["R", "the whole house again"],
  ["L", "show or hide what happens"],
  ["K", "these keys"],
];

THREE.ColorManagement.enabled = false; // colours are computed as the pictures of hthor are

/** @param {string} id */
const find = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

class Watch {
  /** @param {Recording} recording @param {House} house */
  constructor(recording, house) {
    this.recording = recording;
    this.house = house;
    this.plain = new URLSearchParams(location.search).has("plain"); // for machines without graphics
    const canvas = /** @type {HTMLCanvasElement} */ (find("view"));
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.plain });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.renderer.setPixelRatio(this.plain ? 1 : Math.min(2, devicePixelRatio));
    this.scene = new THREE.Scene();
    this.overlays = new Overlays(recording);
    this.scene.add(outdoors(), house.group, this.overlays.group);
    const points = recording.rooms.flatMap((room) => room.polygon);
    const along = (/** @type {number} */ k) => points.map((point) => point[k]);
    const bounds = {
      left: Math.min(...along(0)), right: Math.max(...along(0)), low: Math.min(...along(1)), high: Math.max(...along(1)),
    };
    this.free = new FreeCamera(bounds);
    this.above = new CameraAbove(bounds);
    this.eye = new EyeCamera();
    this.labels = new Labels(find("labels"), recording);
    this.displays = new Displays(find("panels"), find("maps"), recording);
    this.timeline = new Timeline(recording, (seconds) => this.seek(seconds));
    this.seconds = 0;
    this.playing = false;
    this.speed = 1;
    this.view = FREE;
    this.stale = true; // something has changed since the last picture
    this.eyesAt = 0;
    this.eyesStale = true;
    /** @type {Set<string>} */
    this.held = new Set();
    this.last = performance.now();
    this.#title();
    this.#views();
    this.#controls();
    house.put(recording.begin());
    addEventListener("resize", () => this.resize());
    addEventListener("hashchange", () => this.follow(location.hash));
    this.resize();
    this.free.reset(this.clear());
    this.follow(location.search);
    this.follow(location.hash);
    document.body.classList.remove("loading");
    this.renderer.setAnimationLoop((now) => this.frame(now));
  }

  /** Go to the moment and the view that an address names. @param {string} address such as "#t=42&view=human" */
  follow(address) {
    if (address === this.noted) return;
    const named = new URLSearchParams(address.slice(1));
    const seconds = Number(named.get("t") ?? Number.NaN);
    if (Number.isFinite(seconds)) this.seek(seconds);
    const view = named.get("view");
    if (view && this.views.has(view)) this.look(view);
    if (named.has("play")) this.play(true);
  }

  /** Let the address name this moment, so that it can be handed on. */
  note() {
    clearTimeout(this.noting);
    this.noting = setTimeout(() => {
      if (this.playing) return;
      this.noted = `#t=${this.seconds.toFixed(1)}&view=${this.view}`;
      if (location.hash !== this.noted) location.replace(this.noted);
    }, NOTE_MS);
  }

  /** @param {number} seconds */
  seek(seconds) {
    this.seconds = Math.max(0, Math.min(this.recording.seconds, seconds));
    this.stale = this.eyesStale = true;
    this.note();
  }

  /** @param {boolean} on */
  play(on) {
    if (on && this.seconds >= this.recording.seconds) this.seconds = 0;
    this.playing = on;
    this.stale = true;
    if (!on) this.note();
  }

  /** @param {number} way */
  hurry(way) {
    const at = SPEEDS.indexOf(this.speed) + way;
    this.speed = SPEEDS[Math.max(0, Math.min(SPEEDS.length - 1, at))];
    this.stale = true;
  }

  /** @param {string} view */
  look(view) {
    this.view = view;
    for (const [name, { button }] of this.views) button.setAttribute("aria-pressed", String(name === view));
    const seat = this.recording.seats.find((one) => one.seat === view);
    document.body.classList.toggle("eyes", Boolean(seat));
    this.stale = true;
    this.note();
  }

  resize() {
    this.renderer.setSize(innerWidth, innerHeight, false);
    const below = find("top").getBoundingClientRect().bottom + GAP_PX;
    document.documentElement.style.setProperty("--below-top", `${below}px`);
    this.stale = true;
  }

  /** The window, and the part of it that nothing covers. @returns {import("./cameras.js").Frame} */
  clear() {
    const [wide, high] = [innerWidth, innerHeight];
    const edge = (/** @type {string} */ id) => find(id).getBoundingClientRect();
    const narrow = wide < NARROW_PX;
    const left = narrow ? 0 : edge("left").right + GAP_PX;
    const bare = document.body.classList.contains("no-list") && this.recording.messages.length === 0;
    const right = narrow ? wide : bare ? wide - GAP_PX : edge("right").left - GAP_PX;
    return { wide, high, clear: { left, right, low: high - edge("bottom").top + GAP_PX, high: high - edge("top").bottom - GAP_PX } };
  }

  /** @param {number} now [ms] */
  frame(now) {
    const seconds = Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    if (this.playing) {
      this.seconds = Math.min(this.recording.seconds, this.seconds + this.speed * seconds);
      this.stale = this.eyesStale = true;
      if (this.seconds >= this.recording.seconds) this.play(false);
    }
    if (this.view === FREE && this.free.walk(this.held, seconds)) this.stale = true;
    if (this.eyesStale && now - this.eyesAt > EYES_EVERY_MS) {
      this.eyesAt = now;
      this.eyesStale = false;
      this.house.put(this.recording.places(this.seconds));
      this.#drawEyes();
      this.stale = true;
    }
    if (!this.stale) return;
    this.stale = false;
    this.draw();
  }

  /** Draw this moment. */
  draw() {
    const { recording, seconds } = this;
    this.house.put(recording.places(seconds));
    const seat = recording.seats.find((one) => one.seat === this.view);
    const camera = seat ? this.#through(seat) : this.#outside();
    this.renderer.render(this.scene, camera);
    this.labels.show(seat ? null : camera, seconds, innerWidth, innerHeight);
    this.displays.show(seconds, seat?.person ? seat.seat : "");
    this.timeline.show(seconds, this.playing, this.speed);
    const hand = seat ? recording.hand(seat.seat, seconds) : "";
    find("held").textContent = hand ? `in hand: ${hand.replaceAll("_", " ").replaceAll("|", " ")}` : "";
    find("held").classList.toggle("hidden", !hand);
  }

  /** @returns {THREE.Camera} */
  #outside() {
    this.overlays.group.visible = true;
    this.overlays.show(this.seconds);
    this.house.hide([]);
    this.renderer.setScissorTest(false);
    this.renderer.setViewport(0, 0, innerWidth, innerHeight);
    const frame = this.clear();
    const camera = this.view === ABOVE ? this.above.aim(frame) : this.free.aim(frame);
    this.house.roofed.value = Number(camera.position.z < this.recording.height);
    return camera;
  }

  /** The camera of a seat, and its field of view in the window. @param {import("./recording.js").Seat} seat @returns {THREE.Camera} */
  #through(seat) {
    const { wide, high, clear } = this.clear();
    const room = seat.fov ? clear : { left: 0, right: wide, low: 0, high };
    const [across, up] = [room.right - room.left, room.high - room.low];
    const aspect = aspectOf(seat, across / up);
    const size = [Math.min(across, up * aspect), Math.min(up, across / aspect)];
    const corner = [room.left + (across - size[0]) / 2, room.low + (up - size[1]) / 2];
    this.renderer.setScissorTest(false);
    this.renderer.setClearColor(0x1d2126);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    this.renderer.setScissor(corner[0], corner[1], size[0], size[1]);
    this.renderer.setViewport(corner[0], corner[1], size[0], size[1]);
    this.overlays.group.visible = false;
    this.house.roofed.value = 1;
    this.house.hide(seat.own);
    return this.eye.aim(seat, this.recording.pose(seat, this.seconds), size[0] / size[1]);
  }

  /** The small pictures of what everybody sees. */
  #drawEyes() {
    this.overlays.group.visible = false;
    this.house.roofed.value = 1;
    const ratio = this.renderer.getPixelRatio();
    for (const { seat, pen } of this.views.values()) {
      if (!seat || !pen || pen.canvas.offsetParent === null) continue;
      const { width, height } = pen.canvas;
      this.renderer.setScissorTest(true);
      this.renderer.setScissor(0, 0, width / ratio, height / ratio);
      this.renderer.setViewport(0, 0, width / ratio, height / ratio);
      this.house.hide(seat.own);
      const camera = this.eye.aim(seat, this.recording.pose(seat, this.seconds), width / height);
      this.renderer.render(this.scene, camera);
      const whole = this.renderer.domElement;
      pen.drawImage(whole, 0, whole.height - height, width, height, 0, 0, width, height);
    }
  }

  #title() {
    const { recording } = this;
    find("task").textContent = recording.instruction;
    find("about").textContent = [recording.task, ...recording.outcome].join("  ·  ");
  }

  /** The buttons of all views. */
  #views() {
    /** @type {Map<string, {button: HTMLElement, seat?: import("./recording.js").Seat, pen?: CanvasRenderingContext2D}>} */
    this.views = new Map();
    const add = (/** @type {string} */ name, /** @type {string} */ words) => {
      const button = document.createElement("button");
      const key = document.createElement("kbd");
      key.textContent = String(this.views.size + 1);
      button.append(key, words);
      button.dataset.view = name;
      button.onclick = () => this.look(name);
      return button;
    };
    for (const [name, words] of [[FREE, "free"], [ABOVE, "above"]]) {
      const button = add(name, words);
      find("ways").append(button);
      this.views.set(name, { button });
    }
    const ratio = this.renderer.getPixelRatio();
    for (const seat of this.recording.seats) {
      const button = add(seat.seat, seat.seat);
      button.className = "eye";
      button.style.borderColor = seat.colour;
      const about = document.createElement("small");
      about.textContent = seat.name;
      const canvas = document.createElement("canvas");
      canvas.height = Math.round(EYE_PX * ratio);
      canvas.width = Math.round(EYE_PX * ratio * aspectOf(seat, EYE_ASPECT));
      button.title = `${seat.seat}: ${seat.name}`;
      button.append(about, canvas);
      find("eyes").append(button);
      const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
      this.views.set(seat.seat, { button, seat, pen });
    }
    find("eyes").classList.toggle("many", this.recording.seats.length > 2);
    this.look(FREE);
  }

  #controls() {
    new Pointer(find("view"), {
      turn: (yaw, pitch) => this.#moved(() => (this.view === FREE ? this.free.turn(yaw, pitch) : this.view === ABOVE && this.above.drag(-yaw / 5, -pitch / 5))),
      drag: (right, down) => this.#moved(() => (this.view === FREE ? this.free.drag(right, down) : this.view === ABOVE && this.above.drag(right, down))),
      zoom: (factor) => this.#moved(() => (this.view === FREE ? this.free.zoom(factor) : this.view === ABOVE && this.above.zoom(factor))),
    });
    find("play").onclick = () => this.play(!this.playing);
    find("before").onclick = () => this.seek(this.timeline.step(this.seconds, -1));
    find("next").onclick = () => this.seek(this.timeline.step(this.seconds, 1));
    find("speed").onclick = () => {
      if (this.speed === SPEEDS[SPEEDS.length - 1]) this.speed = SPEEDS[0];
      else this.hurry(1);
      this.stale = true;
    };
    find("list").onclick = () => this.#toggle("no-list");
    find("keys").onclick = () => find("help").classList.toggle("hidden");
    find("help").onclick = () => find("help").classList.add("hidden");
    find("help").replaceChildren(
      ...KEYS.flatMap(([keys, words]) => {
        const key = document.createElement("kbd");
        key.textContent = keys;
        const what = document.createElement("span");
        what.textContent = words;
        return [key, what];
      }),
    );
    addEventListener("keydown", (event) => this.#press(event));
    addEventListener("keyup", (event) => this.held.delete(event.code));
    addEventListener("blur", () => this.held.clear());
  }

  /** @param {() => void} move */
  #moved(move) {
    move();
    this.stale = true;
  }

  /** @param {string} name */
  #toggle(name) {
    document.body.classList.toggle(name);
    this.stale = true;
  }

  /** @param {KeyboardEvent} event */
  #press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { tick_s } = this.recording;
    const { key, code } = event;
    const names = [...this.views.keys()];
    const number = Number(key);
    if (code === "Space") this.play(!this.playing);
    else if (key === "ArrowRight") this.seek(this.timeline.step(this.seconds, 1));
    else if (key === "ArrowLeft") this.seek(this.timeline.step(this.seconds, -1));
    else if (key === ".") this.seek((this.recording.tick(this.seconds) + 1) * tick_s);
    else if (key === ",") this.seek((Math.ceil(this.seconds / tick_s - 1e-6) - 1) * tick_s);
    else if (key === "+" || key === "=") this.hurry(1);
    else if (key === "-" || key === "−") this.hurry(-1);
    else if (number >= 1 && number <= names.length) this.look(names[number - 1]);
    else if (key.toLowerCase() === "r") this.#moved(() => (this.view === ABOVE ? this.above.reset() : this.free.reset(this.clear())));
    else if (key.toLowerCase() === "l") this.#toggle("no-list");
    else if (key.toLowerCase() === "k" || key === "?") find("help").classList.toggle("hidden");
    else if (key === "Escape") find("help").classList.add("hidden");
    else if (/^(Key[WASDQE]|Shift(Left|Right))$/.test(code)) {
      this.held.add(code);
      return;
    } else return;
    event.preventDefault();
  }
}

/** What is embedded in the page under a name, uncompressed. @param {string} id */
async function embedded(id) {
  const text = find(id).textContent ?? "";
  const packed = Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

async function main() {
  try {
    const recording = new Recording(JSON.parse(new TextDecoder().decode(await embedded("recording"))));
    document.body.classList.toggle("no-list", innerWidth < NARROW_PX);
    const house = await House.parse(await embedded("house"));
    Object.assign(window, { watch: new Watch(recording, house) });
  } catch (error) {
    find("wait").classList.add("problem");
    find("wait").textContent = `This browser cannot show the trial: ${error instanceof Error ? error.message : error}. ` +
      "The page needs WebGL 2 and a browser of 2023 or later. If the browser does not let pages from a folder do that, " +
      "run “python3 -m http.server” in the folder of this file, and open http://localhost:8000/.";
    throw error;
  }
}

main();
