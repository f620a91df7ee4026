// The page of a person who takes part in a session at a desk.

import * as THREE from "three";
import { FOV, lookFrom } from "./eye.js";
import { House, outdoors } from "./house.js";
import { Keys } from "./keys.js";
import { OwnMotion } from "./motion.js";
import { Panels } from "./panels.js";

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
    this.seat = this.problem = "";
    this.over = this.lost = false;
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
    /** How the trial ended. @type {any} */ this.ended = null;
    /** Why time stands still. */ this.paused = "";
    /** What there is to try, in the practice. @type {any} */ this.steps = null;
    this.skipped = false;
    this.ready = this.begun = this.rated = this.keysShown = false;
    this.known = { panel: false, map: false };
  }

  /** Whether the person can act. */
  get plays() {
    const still = this.paused || this.lost || this.problem || this.skipped;
    return this.begun && this.house !== null && this.ended === null && !still;
  }

  /** Show the card that fits, or the house. */
  show() {
    this.panels.reveal(this.begun && this.house !== null && this.ended === null);
    const { title, text, button, done, other, otherDone, help, rate } = this.card();
    if (rate) this.panels.rating(title, done);
    else this.panels.card(title ? { title, text, button, other } : null, done, otherDone);
    this.panels.steps(this.plays ? this.steps : null, () => this.skip());
    if (help) this.panels.help(this.trial.phases);
    if (!title) this.offer();
  }

  /** The card over the house; without a title there is none. @returns {any} */
  card() {
    if (this.problem) return { title: "This page cannot take part", text: this.problem };
    if (this.over) return { title: "The session is over", text: "Thank you for taking part. You can close this page." };
    if (this.lost) {
      return { title: "The connection is gone", text: "The page connects again by itself. Time stands still." };
    }
    if (this.trial === null) return { title: "hthor", text: "The session is being prepared …" };
    const task = this.trial.instruction;
    if (this.ended !== null) return this.endCard();
    if (this.skipped) return { title: "Practice", text: "The first task comes when everybody is ready …" };
    if (this.house === null) {
      return { title: this.trial.practice ? "Practice" : "The next task", text: "The house is being loaded …" };
    }
    if (this.begun && this.paused) return { title: "Paused", text: this.paused };
    if (this.begun && this.keysShown) {
      const done = () => this.change({ keysShown: false });
      return { title: "Keys", text: "Press a row to change its key.", button: "Go on", done, help: true };
    }
    if (this.begun) return {};
    if (this.ready) return { title: task, text: "The trial begins when everybody is ready …" };
    const done = () => {
      this.worker.postMessage({ type: "begin", trial: this.trial.trial });
      this.change({ ready: true });
    };
    if (this.trial.practice) {
      const text = "Try each control once, in any order, before the first task. A list shows what is left.";
      const [other, otherDone] = ["Skip the practice", () => this.skip()];
      return { title: "Practice", text, button: "Begin", done, other, otherDone, help: true };
    }
    return { title: task, text: `You have ${this.trial.time_limit} seconds.`, button: "Begin", done, help: true };
  }

  /** Leave the practice out. */
  skip() {
    this.worker.postMessage({ type: "skip", trial: this.trial.trial });
    this.change({ skipped: true });
  }

  endCard() {
    if (this.trial.practice) return { title: "The practice is over", text: "Please wait for the first task …" };
    const { voided, met, rate, trial } = this.ended;
    const words = voided ? `The trial does not count: ${voided}.` : met ? "Done!" : "The time is over.";
    if (!rate) return { title: words, text: "Please wait …" };
    if (this.rated) return { title: "Thank you", text: "Please wait for the next task …" };
    const done = (/** @type {number} */ value) => {
      this.worker.postMessage({ type: "rate", trial, value });
      this.change({ rated: true });
    };
    return { title: `${words} ${QUESTION}`, rate: true, done };
  }

  /** Change the state, and what is shown with it. @param {object} state */
  change(state) {
    Object.assign(this, state);
    this.show();
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
    this.change({ seat, lost: false });
  }

  on_lost() {
    this.change({ lost: true });
  }

  /** @param {any} message */
  on_problem({ words }) {
    this.change({ problem: words });
  }

  /** @param {any} trial */
  async on_trial(trial) {
    this.forget();
    this.trial = trial;
    this.self = trial.bodies.find((/** @type {any} */ body) => body.seat === this.seat);
    this.motion.reset();
    this.early = [];
    this.panels.task(trial);
    this.panels.time(trial.time_limit, "");
    this.panels.message(null);
    this.panels.map(null);
    if (this.house) this.scene.remove(this.house.group);
    this.house?.dispose();
    this.change({ house: null });
    const house = await House.load(trial.file, trial.own);
    if (this.trial !== trial) return;
    this.scene.add(house.group);
    house.move(this.early);
    house.step(1, null);
    this.change({ house });
  }

  /** @param {any} message */
  on_steps({ steps, skipped }) {
    this.change({ steps, skipped: this.skipped || skipped });
  }

  on_began() {
    this.change({ begun: true });
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
    const fresh = JSON.stringify(now.outcome) !== JSON.stringify(this.now.outcome);
    if (fresh && now.outcome && !now.outcome.ok) this.panels.notice(now.outcome.reason);
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
    this.change({ paused: reason });
  }

  /** @param {any} ended */
  on_ended(ended) {
    this.panels.message(null);
    this.panels.map(null);
    this.change({ ended });
  }

  on_over() {
    this.change({ over: true });
  }

  /** @param {string} action */
  press(action) {
    if (!this.plays) return;
    if (action === "keys") this.change({ keysShown: !this.keysShown });
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
  }

  /** @param {number} now */
  draw(now) {
    const seconds = Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    this.fps += 0.05 * (1 / Math.max(1e-3, seconds) - this.fps);
    if (this.head) {
      const drive = this.keys.drive(seconds, this.self.speed);
      if (!this.plays || this.now.busy) drive.forward = drive.left = 0; // as the world does with busy hands
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

  /** What is in hand, and where it is shown: in front of the person, without any delay. */
  inHand() {
    const number = this.house && this.now.holding ? this.house.numberOf(this.now.holding) : -1;
    const place = this.house?.places.get(number);
    if (!place || !this.head) return null;
    const dx = place.position[0] - this.head.x;
    const dy = place.position[1] - this.head.y;
    const turn = this.keys.yaw - this.head.yaw;
    const [cos, sin] = [Math.cos(turn), Math.sin(turn)];
    const [x, y] = [this.motion.x + cos * dx - sin * dy, this.motion.y + sin * dx + cos * dy];
    return { number, position: [x, y, place.position[2]], turn: place.turn };
  }

  aim() {
    const { yaw, pitch } = this.keys;
    lookFrom(this.camera, [this.motion.x, this.motion.y, this.self?.eye ?? 1.6], yaw, pitch);
  }
}

Object.assign(window, { page: new Page() });
