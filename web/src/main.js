// The page of a person who takes part in a session at a desk.

import * as THREE from "three";
import { FOV, lookFrom } from "./eye.js";
import { Headset } from "./headset/headset.js";
import { HeadsetChoice } from "./headset/headset_choice.js";
import { shownIn } from "./headset/shown.js";
import { House, outdoors } from "./house.js";
import { Keys } from "./keys.js";
import { OwnMotion } from "./motion.js";
import { showOwnPage } from "./own_page.js";
import { NOTICE_MS, Panels } from "./panels.js";

const QUESTION = "How much do you trust your robot teammate?";
const SCALE = 7;
const SCALE_ENDS = "1: not at all   ·   7: completely";
const ASKED = "The experimenter asks you to enter VR. ";
const LOAD_AGAIN_MS = 2000;
const SWITCH_MS = 200; // until the server offers what the other hand can do

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
    this.headset = new Headset(this.renderer, () => this.onHeadset());
    this.scene.add(this.headset.group);
    this.headsetChoice = new HeadsetChoice(this.headset, () => this.show());
    /** What the hand that acts no longer has just been told to do. @type {{actions: string[], at: number} | null} */
    this.later = null;
    this.notice = { words: "", until: 0 };
    /** @type {House | null} */
    this.house = null;
    /** What the house was loaded from. */ this.loaded = "";
    /** Whether the house has just been loaded, so that the graphics card gets it before it is shown. */
    this.fresh = false;
    /** @type {import("./wire.js").Moved[]} */
    this.early = []; // what moved before the house was there
    this.seat = this.problem = "";
    /** How often the page has joined the session. */ this.joined = 0;
    this.over = this.lost = false;
    /** Whether the experimenter asks for VR, and the person has not said that they stay at the desk. */
    this.vrAsked = false;
    /** Whether the person has left VR in a trial, and has not said that they go on at the desk. */
    this.vrLeft = false;
    this.farewell = "";
    this.forget();
    this.worker = new Worker(new URL("socket.js", document.baseURI), { type: "module" });
    this.worker.onmessage = ({ data }) => this.receive(data);
    this.worker.postMessage({ type: "open", token: location.hash.slice(1) });
    this.last = performance.now();
    this.fps = 60;
    addEventListener("resize", () => this.resize());
    this.resize();
    this.renderer.setAnimationLoop((now, frame) => this.draw(now, frame));
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
    this.skipped = this.unloadable = false;
    this.later = null;
    /** The rating that is chosen with a headset. */ this.chosen = 4;
    /** What can be done here and now. @type {[string, string][]} */ this.offers = [];
    this.headset?.recentre();
    this.ready = this.begun = this.rated = this.keysShown = false;
    this.known = { panel: false, map: false };
  }

  /** Whether the person can act. */
  get plays() {
    const still = this.paused || this.lost || this.problem || this.skipped;
    return this.begun && this.house !== null && this.ended === null && !still;
  }

  /** Whether the trial is going on, in a house that is there. */
  get underWay() {
    return this.begun && this.house !== null && this.ended === null;
  }

  /** What the experimenter asks of a person at the desk, in words. */
  get asked() {
    return this.vrAsked && !this.headset.session ? ASKED : "";
  }

  /** Go on without a headset. */
  stayAtDesk() {
    this.vrAsked = this.vrLeft = false;
    this.onHeadset();
  }

  /** VR has begun or ended, or the house is hidden from the person in it, or no longer. */
  onHeadset() {
    const vr = this.headset.session !== null;
    this.vrLeft = !vr && this.begun && this.ended === null && (this.vrLeft || document.body.classList.contains("in-vr"));
    this.worker.postMessage({ type: "headset", vr, off: this.headset.off || this.vrLeft });
    document.body.classList.toggle("in-vr", vr);
    if (!vr) this.resize();
    else if (this.jpeg) this.headset.screens.takePicture(this.jpeg);
    this.show();
  }

  /** Show the card that fits, or the house. */
  show() {
    this.panels.reveal(this.underWay);
    const { title, text, button, done, other, otherDone, help, rate } = this.card();
    this.headsetChoice.show(Boolean(button));
    if (rate) this.panels.rating(title, text, rate, done);
    else this.panels.card(title ? { title, text, button, other } : null, done, otherDone);
    this.panels.steps(this.plays ? this.steps : null, () => this.skip());
    if (help) this.panels.help(this.trial.phases);
    if (!title) this.offer();
  }

  /** The card over the house; without a title there is none. @returns {any} */
  card() {
    if (this.problem) return { title: "This page cannot take part", text: this.problem };
    if (this.over) return { title: "The session is over", text: this.farewell };
    if (this.lost) {
      return { title: "The connection is gone", text: "The page connects again by itself. Time stands still." };
    }
    if (this.trial === null) return { title: "hthor", text: "The session is being prepared …" };
    const task = this.trial.instruction;
    if (this.ended !== null) return this.endCard();
    if (this.skipped) return { title: "Practice", text: "The first task comes when everybody is ready …" };
    if (this.house === null) {
      const text = this.unloadable ? "The house cannot be loaded. The page tries again …" : "The house is being loaded …";
      return { title: this.trial.practice ? "Practice" : "The next task", text };
    }
    const desk = { button: "Go on at the desk", done: () => this.stayAtDesk() };
    if (this.begun && this.vrLeft) return { ...desk, title: "You have left VR", text: "Enter it again, or go on here." };
    if (this.begun && this.paused) return { title: "Paused", text: this.paused };
    if (this.begun && this.keysShown) {
      const done = () => this.change({ keysShown: false });
      return { title: "Keys", text: "Press a row to change its key.", button: "Go on", done, help: true };
    }
    if (this.begun && this.asked) return { ...desk, title: "Please put on the headset", text: this.asked };
    if (this.begun) return {};
    if (this.ready) return { title: task, text: "The trial begins when everybody is ready …" };
    const done = () => {
      this.worker.postMessage({ type: "begin", trial: this.trial.trial });
      this.change({ ready: true });
    };
    if (this.trial.practice) {
      const text = `${this.asked}Try each control once, in any order, before the first task. A list shows what is left.`;
      const [other, otherDone] = ["Skip the practice", () => this.skip()];
      return { title: "Practice", text, button: "Begin", done, other, otherDone, help: true };
    }
    const text = `${this.asked}You have ${this.trial.time_limit} seconds.`;
    return { title: task, text, button: "Begin", done, help: true };
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
    return { title: `${words} ${QUESTION}`, text: SCALE_ENDS, rate: SCALE, done };
  }

  /** Change the state, and what is shown with it. @param {object} state */
  change(state) {
    Object.assign(this, state);
    this.show();
  }

  resize() {
    if (this.headset.session) return; // its size is the headset's
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
    this.joined += 1;
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
    const source = JSON.stringify([trial.file, trial.own]);
    if (this.house && this.loaded === source) return this.show(); // the first frame says where everything is
    if (this.house) this.scene.remove(this.house.group);
    this.house?.dispose();
    this.change({ house: null });
    const house = await this.load(trial);
    if (house === null) return;
    this.scene.add(house.group);
    house.move(this.early);
    house.step(1, null);
    this.change({ house, loaded: source, fresh: true });
  }

  /**
   * The house of a trial, again and again until it can be loaded; null once another trial has come.
   * @param {any} trial @returns {Promise<House | null>}
   */
  async load(trial) {
    while (this.trial === trial) {
      const house = await House.load(trial.file, trial.own).catch(() => null);
      if (this.trial !== trial) house?.dispose();
      else if (house) return house;
      else {
        this.change({ unloadable: true });
        await new Promise((done) => setTimeout(done, LOAD_AGAIN_MS));
      }
    }
    return null;
  }

  /** @param {any} message */
  on_steps({ steps, skipped }) {
    this.change({ steps, skipped: this.skipped || skipped });
  }

  /** @param {any} message */
  on_headset_asked({ on }) {
    this.change({ vrAsked: on });
  }

  on_began() {
    this.change({ begun: true });
  }

  /** @param {any} frame */
  on_frame({ head, moved }) {
    if (this.house) this.house.move(moved);
    else this.early.push(...moved);
    if (this.head === null) {
      this.house?.step(1); // nothing slides from where it was before
      [this.keys.yaw, this.keys.pitch] = [head.gaze, head.pitch];
    }
    this.head = head;
    this.motion.correct(head);
  }

  /** @param {any} now */
  on_now(now) {
    const fresh = JSON.stringify(now.outcome) !== JSON.stringify(this.now.outcome);
    if (fresh && now.outcome && !now.outcome.ok) {
      this.panels.notice(now.outcome.reason);
      this.notice = { words: now.outcome.reason, until: performance.now() + NOTICE_MS };
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
    this.offers = offers;
    this.panels.offers([...offers, ["keys", "keys"]]);
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
    this.jpeg = jpeg;
    this.headset.screens?.takePicture(jpeg);
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
    if (this.vrLeft) this.onHeadset(); // there is nothing to go on with
  }

  /** @param {any} message */
  on_over({ page, making }) {
    const next = making ? "A page about your session is being made for you …" : "You can close this page.";
    this.change({ over: true, farewell: `Thank you for taking part. ${next}` });
    if (page) showOwnPage(page);
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

  /** @param {number} now @param {XRFrame} [frame] of the headset, if there is one */
  draw(now, frame) {
    const seconds = Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    this.fps += 0.05 * (1 / Math.max(1e-3, seconds) - this.fps);
    const worn = this.headset.session && frame ? this.wear(frame, seconds) : null;
    if (this.head) {
      const { speed } = this.self;
      const still = !this.plays || this.now.busy; // as the world does with busy hands
      const drive = worn ? this.headset.rig.drive(worn.stick, speed, this.motion) : this.keys.drive(seconds, speed);
      if (still) drive.forward = drive.left = 0;
      const number = this.motion.steer(drive, seconds);
      if (worn) this.headset.rig.follow(this.motion, seconds, still ? 0 : this.motion.share);
      const hand = worn ? this.headset.hand : null;
      this.worker.postMessage({ type: "steer", number, drive, hand, frames: Math.round(this.fps) });
      this.panels.time(this.left, this.now.phase);
      if (worn) this.headset.darken(!still && Math.hypot(worn.stick.forward, worn.stick.left) > 0, seconds);
    }
    this.house?.step(seconds, this.inHand());
    if (worn) this.headset.screens.show(shownIn(this), this.headset.rig.head, seconds);
    else this.aim();
    const seen = this.headset.session !== null || this.underWay || this.fresh; // else a card covers all of it
    if (seen) this.renderer.render(this.scene, worn ? this.headset.camera : this.camera);
    this.fresh = false;
  }

  /** [s] How much time is left. */
  get left() {
    return this.trial.time_limit - (this.head.tick + this.head.step / 6) / 10;
  }

  /** Take what somebody with a headset does. @param {XRFrame} frame @param {number} seconds */
  wear(frame, seconds) {
    const { x, y } = this.motion;
    const body = this.head ? { x, y, yaw: this.head.gaze, eye: this.self.eye } : null;
    const { controls } = this.headset;
    const hand = controls.active;
    const done = this.headset.track(frame, seconds, body);
    const card = this.card();
    if (card.rate) this.chosen = Math.max(1, Math.min(SCALE, this.chosen + done.choose));
    else if (done.turn) this.headset.rig.turn(done.turn);
    if (card.title) this.answer(card, done.actions);
    else if (controls.active !== hand) this.later = { actions: done.actions, at: performance.now() + SWITCH_MS };
    else done.actions.forEach((action) => this.press(action));
    if (this.later && performance.now() > this.later.at) {
      this.later.actions.forEach((action) => this.press(action));
      this.later = null;
    }
    return done;
  }

  /** Press the buttons of a card with a headset's. @param {any} card @param {string[]} actions */
  answer({ rate, done, otherDone }, actions) {
    const yes = actions.includes("accept") || actions.includes("door");
    if (yes && done) done(rate ? this.chosen : undefined);
    else if (actions.includes("decline")) otherDone?.();
  }

  /** What is in hand, and where it is shown: in the hand, or in front of the person, without any delay. */
  inHand() {
    const number = this.house && this.now.holding ? this.house.numberOf(this.now.holding) : -1;
    const place = this.house?.places.get(number);
    if (this.headset.session) return this.headset.held(place ? number : -1, place?.turn ?? [0, 0, 0, 1]);
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
