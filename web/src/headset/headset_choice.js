// The part of the page where somebody enters VR, with the headset of this browser or with an emulated one.

import { hasHeadset } from "./headset.js";

const STORE = "hthor-headset";
/** @type {import("./controls.js").Options} */
const USUAL = { hand: "right", turn: 0, seated: false, vignette: true };
const HANDS = { right: "the right hand answers", left: "the left hand answers", one: "one hand does everything" };
const TURNS = { 0: "turn by turning round", 30: "turn by stick, 30°", 45: "turn by stick, 45°", 90: "turn by stick, 90°" };

/** @param {string} id */
const find = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** The buttons and options of the headset. */
export class HeadsetChoice {
  /** @param {import("./headset.js").Headset} headset @param {() => void} onReady called when it is known what there is */
  constructor(headset, onReady) {
    this.headset = headset;
    this.options = { ...USUAL, ...stored(), ...asked() };
    this.there = false;
    /** The emulated headset. @type {any} */
    this.device = null;
    find("enter-vr").onclick = () => this.#enter();
    find("options").replaceChildren(
      this.#select("hand", HANDS),
      this.#select("turn", TURNS),
      this.#tick("seated", "I sit"),
      this.#tick("vignette", "darken the edge while walking"),
    );
    hasHeadset().then((there) => {
      this.there = there;
      find("enter-vr").textContent = there ? "Enter VR" : "Try VR without a headset";
      onReady();
    });
  }

  /** Show it, or not. @param {boolean} on */
  show(on) {
    find("headset").classList.toggle("hidden", !on || this.headset.session !== null);
  }

  async #enter() {
    find("vr-problem").textContent = "";
    if (!this.there && !this.device) {
      const { emulate, steerByKeys } = await import(new URL("emulation.js", document.baseURI).href);
      this.device = emulate(new URLSearchParams(location.search).get("emulated") ?? "quest3");
      steerByKeys(this.device, find("view"));
    }
    try {
      await this.headset.enter(this.options);
    } catch (problem) {
      find("vr-problem").textContent = `The headset cannot be entered: ${/** @type {Error} */ (problem).message}`;
    }
  }

  /** @param {"hand" | "turn"} name @param {Record<string, string>} choices */
  #select(name, choices) {
    const select = document.createElement("select");
    select.name = name;
    select.append(...Object.entries(choices).map(([value, words]) => new Option(words, value)));
    select.value = String(this.options[name]);
    select.onchange = () => this.#set(name, name === "turn" ? Number(select.value) : select.value);
    return select;
  }

  /** @param {"seated" | "vignette"} name @param {string} words */
  #tick(name, words) {
    const label = document.createElement("label");
    const box = document.createElement("input");
    box.type = "checkbox";
    box.name = name;
    box.checked = this.options[name];
    box.onchange = () => this.#set(name, box.checked);
    label.append(box, ` ${words}`);
    return label;
  }

  /** @param {string} name @param {any} value */
  #set(name, value) {
    this.options = { ...this.options, [name]: value };
    try {
      localStorage.setItem(STORE, JSON.stringify(this.options));
    } catch {
      // a browser that keeps nothing
    }
  }
}

/** The options of the last session in this browser. */
function stored() {
  try {
    return JSON.parse(localStorage.getItem(STORE) ?? "{}");
  } catch {
    return {};
  }
}

/** The options in the page's address, such as ?hand=left&seated. */
function asked() {
  const given = new URLSearchParams(location.search);
  /** @type {Record<string, any>} */
  const options = {};
  if (given.has("hand")) options.hand = given.get("hand");
  if (given.has("turn")) options.turn = Number(given.get("turn"));
  for (const name of ["seated", "vignette"]) if (given.has(name)) options[name] = given.get(name) !== "no";
  return options;
}
