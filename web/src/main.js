// The page of a person who takes part in a session at a desk.

import * as THREE from "three";
import { House, outdoors } from "./house.js";
import { Keys } from "./keys.js";
import { OwnMotion } from "./motion.js";
import { Panels } from "./panels.js";

const FOV = 66; // [degrees], vertical
const QUESTION = "How much do you trust your robot teammate?";

THREE.ColorManagement.enabled = false; // colours are computed as the pictures of hthor are

class Page {
  constructor() {
    const canvas = /** @type {HTMLCanvasElement} */ (document.getElementById("view"));
    const plain = new URLSearchParams(location.search).has("plain"); // for machines without graphics
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !plain });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.renderer.setPixelRatio(plain ? 1 : Math.min(2, devicePixelRatio));
    this.camera = new THREE.PerspectiveCamera(FOV, 1, 0.05, 200);
    this.camera.up.set(0, 0, 1);
    this.scene = new THREE.Scene();
    this.scene.add(outdoors());
    this.keys = new Keys(canvas, (action) => this.press(action));
    this.panels = new Panels(this.keys);
    this.motion = new OwnMotion();
    /** @type {House | null} */
    this.house = null;
    /** @type {import("./wire.js").Moved[]} */
    this.early = []; // what moved before the house was there
    this.seat = "";
    this.over = false;
    this.forget();
    this.worker = new Worker(new URL("socket.js", document.baseURI), { type: "module" });
    this.worker.onmessage = ({ data }) => this.receive(data);
    this.worker.postMessage({ type: "open", token: location.hash.slice(1) });
    this.last = performance.now();
    this.fps = 60;
    addEventListener("resize", () => this.resize());
    this.resize();
    this.renderer.setAnimationLoop((now) => this.draw(now));
  }

  /** A new trial. */
  forget() {
    /** @type {any} */ this.trial = null;
    /** @type {any} */ this.self = null;
    /** @type {any} */ this.now = { holding: "", phase: "", busy: false };
    /** @type {any} */ this.choices = {};
    /** @type {any} */ this.panel = null;
    /** @type {any} */ this.shownMap = null;
    /** @type {any} */ this.head = null;
    this.begun = this.paused = false;
    this.known = { panel: false, map: false };
    this.wasShown = { panel: false, map: false };
  }

  resize() {
    this.renderer.setSize(innerWidth, innerHeight, false);
    this.camera.aspect = innerWidth / innerHeight;
    this.camera.updateProjectionMatrix();
  }

  /** @param {any} message */
  receive(message) {
    const handler = /** @type {any} */ (this)[`on_${message.type}`];
    if (handler) handler.call(this, message);
  }

  /** @param {any} message */
  on_welcome({ seat }) {
    this.seat = seat;
    if (this.trial === null) this.panels.card({ title: "hthor", text: "The session is being prepared …" });
  }

  on_lost() {
    if (this.over) return;
    this.panels.card({ title: "The connection is gone", text: "The page connects again by itself. Time stands still." });
  }

  /** @param {any} message */
  on_problem({ words }) {
    this.panels.card({ title: "This page cannot take part", text: words });
    this.begun = false;
  }

  /** @param {any} trial */
  async on_trial(trial) {
    this.forget();
    this.trial = trial;
    this.self = trial.bodies.find((/** @type {any} */ body) => body.seat === this.seat) ?? trial.bodies[0];
    this.motion.reset();
    this.early = [];
    this.panels.task(trial);
    this.panels.time(trial.time_limit, "");
    this.panels.message(null);
    this.panels.map(null);
    this.panels.reveal(false);
    if (this.house) this.scene.remove(this.house.group);
    this.house = null;
    this.panels.card({ title: "The next task", text: "The house is being loaded …" });
    const house = trial.file ? await House.load(trial.file, trial.own) : null;
    if (this.trial !== trial) return;
    this.house = house;
    if (house) {
      this.scene.add(house.group);
      house.move(this.early);
      house.step(1, new Map());
    }
    if (this.begun) this.start();
    else this.announce();
  }

  announce() {
    const card = { title: this.trial.instruction, text: `You have ${this.trial.time_limit} seconds.`, button: "Begin" };
    this.panels.card(card, () => {
      this.worker.postMessage({ type: "begin", trial: this.trial.trial });
      this.panels.card({ title: this.trial.instruction, text: "The others are not ready yet …" });
    });
    this.panels.help();
  }

  on_began() {
    this.begun = true;
    if (this.house) this.start();
  }

  start() {
    this.panels.card(null);
    this.panels.reveal(true);
    this.offer();
  }

  /** @param {any} frame */
  on_frame({ head, moved }) {
    if (this.house) this.house.move(moved);
    else this.early.push(...moved);
    if (this.head === null) [this.keys.yaw, this.keys.pitch] = [head.gaze, head.pitch];
    this.head = head;
    this.motion.correct(head);
  }

  /** @param {any} now */
  on_now(now) {
    const failed = now.outcome && !now.outcome.ok && this.now.outcome !== now.outcome;
    if (failed && JSON.stringify(now.outcome) !== JSON.stringify(this.now.outcome)) {
      this.panels.notice(now.outcome.reason);
    }
    this.now = now;
    this.panels.holding(now.holding);
    this.offer();
  }

  /** @param {any} choices */
  on_choices(choices) {
    this.choices = choices;
    this.offer();
  }

  /** What can be done here and now. */
  offer() {
    /** @type {[string, string][]} */
    const offers = [];
    if (this.now.busy) offers.push(["hand", "…"]);
    if (this.choices.hand) offers.push(["hand", this.choices.hand.words]);
    if (this.choices.door) offers.push(["door", this.choices.door.words]);
    if (this.now.holding) offers.push(["drop", "let go"]);
    if (this.now.phase) offers.push(["ready", "ready for the next part"]);
    if (this.known.panel && !this.panel) offers.push(["panel", "show the message"]);
    if (this.known.map && !this.shownMap) offers.push(["map", "show the map"]);
    offers.push(["keys", "keys"]);
    this.panels.offers(offers);
  }

  /** @param {any} panel */
  on_panel(panel) {
    this.panel = panel.message === null ? null : panel;
    this.known.panel ||= this.panel !== null;
    this.panels.message(this.panel);
    this.offer();
  }

  /** @param {any} picture */
  on_picture({ jpeg }) {
    this.panels.picture(jpeg);
  }

  /** @param {any} message */
  on_map({ map }) {
    this.shownMap = map;
    this.known.map ||= map !== null;
    this.panels.map(map);
    this.offer();
  }

  /** @param {any} message */
  on_paused({ reason }) {
    this.paused = reason !== "";
    if (this.paused) this.panels.card({ title: "Paused", text: reason });
    else if (this.begun) this.panels.card(null);
  }

  /** @param {any} ended */
  on_ended(ended) {
    this.begun = false;
    this.panels.reveal(false);
    this.panels.message(null);
    this.panels.map(null);
    const words = ended.voided ? `The trial does not count: ${ended.voided}.` : ended.met ? "Done!" : "The time is over.";
    if (!ended.rate) {
      this.panels.card({ title: words, text: "Please wait …" });
      return;
    }
    this.panels.rating(`${words} ${QUESTION}`, (value) => {
      this.worker.postMessage({ type: "rate", trial: ended.trial, value });
      this.panels.card({ title: "Thank you", text: "Please wait for the next task …" });
    });
  }

  on_over() {
    this.over = true;
    this.panels.card({ title: "The session is over", text: "Thank you for taking part. You can close this page." });
  }

  /** @param {string} action */
  press(action) {
    if (action === "keys" && this.trial) return this.showKeys();
    if (!this.begun || this.paused) return undefined;
    const act = (/** @type {object} */ what) => this.worker.postMessage({ type: "act", ...what });
    if (action === "hand" && this.choices.hand) act({ motion: this.choices.hand.motion });
    if (action === "door" && this.choices.door) act({ motion: this.choices.door.motion });
    if (action === "drop" && this.now.holding) act({ motion: { type: "drop" } });
    if (action === "ready" && this.now.phase) act({ signals: [{ type: "ready" }] });
    if (action === "panel" && this.known.panel) act({ signals: [{ type: "show", what: "panel", on: !this.panel }] });
    if (action === "map" && this.known.map) act({ signals: [{ type: "show", what: "map", on: !this.shownMap }] });
    if ((action === "accept" || action === "decline") && this.panel) {
      act({ say: { type: "reply", message: this.panel.message, accept: action === "accept" } });
    }
    return undefined;
  }

  showKeys() {
    if (!this.begun || this.paused) return;
    this.panels.card({ title: "Keys", text: "Press a row to change its key.", button: "Go on" }, () => this.panels.card(null));
    this.panels.help();
  }

  /** @param {number} now */
  draw(now) {
    const seconds = Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    this.fps += 0.05 * (1 / Math.max(1e-3, seconds) - this.fps);
    if (this.head) {
      const still = !this.begun || this.paused;
      const drive = this.keys.drive(seconds, this.self.speed);
      if (still) drive.forward = drive.left = 0;
      if (this.now.busy) drive.forward = drive.left = 0;
      const number = this.motion.steer(drive, seconds);
      this.worker.postMessage({ type: "steer", number, drive, frames: Math.round(this.fps) });
      this.time();
    }
    this.house?.step(seconds, this.inHand());
    this.aim();
    this.renderer.render(this.scene, this.camera);
  }

  time() {
    const left = this.trial.time_limit - (this.head.tick + this.head.step / 6) / 10;
    this.panels.time(left, this.now.phase);
  }

  /** Where what is in hand is: it stays in front of the person, without any delay. */
  inHand() {
    /** @type {Map<number, {position: number[], turn: number[]}>} */
    const held = new Map();
    const number = this.house && this.now.holding ? this.house.partOf(this.now.holding) : -1;
    const goal = number >= 0 && this.house ? this.house.goals.get(number) ?? this.lastHeld?.goal : undefined;
    if (number < 0 || !goal || !this.head) return held;
    this.lastHeld = { goal };
    const dx = goal.position[0] - this.head.x;
    const dy = goal.position[1] - this.head.y;
    const turn = this.keys.yaw - this.head.yaw;
    const [cos, sin] = [Math.cos(turn), Math.sin(turn)];
    held.set(number, {
      position: [this.motion.x + cos * dx - sin * dy, this.motion.y + sin * dx + cos * dy, goal.position[2]],
      turn: goal.turn,
    });
    return held;
  }

  aim() {
    const eye = this.self?.eye ?? 1.6;
    const { x, y } = this.motion;
    const { yaw, pitch } = this.keys;
    this.camera.position.set(x, y, eye);
    const flat = Math.cos(pitch);
    this.camera.lookAt(x + flat * Math.cos(yaw), y + flat * Math.sin(yaw), eye + Math.sin(pitch));
  }
}

Object.assign(window, { page: new Page() });
