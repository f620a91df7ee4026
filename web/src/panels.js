// What is written over the picture: the task, what can be done here, the message, the map, and the questions.

import { ACTIONS, keyName } from "./keys.js";
import { drawMap } from "./map.js";
import { answers, countdown, nameOf, progress, stepsLeft } from "./words.js";

/** How long a notice is shown. */
export const NOTICE_MS = 4000;

/** @param {string} id */
const find = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** @param {string} id @param {boolean} on */
const toggle = (id, on) => find(id).classList.toggle("hidden", !on);

/** The panels of the page. */
export class Panels {
  /** @param {import("./keys.js").Keys} keys */
  constructor(keys) {
    this.keys = keys;
    /** @type {number | undefined} */
    this.noticed = undefined;
    this.url = "";
  }

  /** Show the house and what belongs to it, or nothing. @param {boolean} on */
  reveal(on) {
    for (const id of ["view", "top", "bottom", "aim"]) toggle(id, on);
  }

  /** The task, and how far the session is. @param {any} trial */
  task(trial) {
    find("task").textContent = trial.instruction;
    find("trial").textContent = progress(trial);
    toggle("time", !trial.practice);
  }

  /** @param {number} seconds @param {string} phase */
  time(seconds, phase) {
    const { time, short } = countdown(seconds);
    find("time").textContent = phase || time;
    find("time").classList.toggle("short", !phase && short);
  }

  /** What is in hand. @param {string} name */
  holding(name) {
    find("held").textContent = name ? `in hand: ${nameOf(name)}` : "hands free";
  }

  /** What can be done here. @param {[string, string][]} offers pairs of an action and its words */
  offers(offers) {
    find("offers").replaceChildren(...offers.map(([action, words]) => this.#hint(action, words)));
  }

  /** The message on the panel, null to hide it. @param {any} panel */
  message(panel) {
    toggle("panel", panel !== null);
    if (panel === null) return;
    find("sender").textContent = panel.sender;
    find("words").textContent = panel.text;
    const [yes, no] = answers(panel);
    find("answers").replaceChildren(
      this.#hint("accept", yes),
      this.#hint("decline", no),
      this.#hint("panel", "hide"),
    );
    if (!panel.picture) this.picture(null);
  }

  /** The picture of the message. @param {Blob | null} jpeg */
  picture(jpeg) {
    if (this.url) URL.revokeObjectURL(this.url);
    this.url = jpeg ? URL.createObjectURL(jpeg) : "";
    const image = /** @type {HTMLImageElement} */ (find("picture"));
    image.classList.toggle("hidden", !jpeg);
    if (jpeg) image.src = this.url;
  }

  /** The map, null to hide it. @param {import("./map.js").DisplayMap | null} map */
  map(map) {
    toggle("map", map !== null);
    if (map === null) return;
    find("drawing").innerHTML = drawMap(map);
    find("map-keys").replaceChildren(this.#hint("map", "hide"));
  }

  /**
   * What there is to try in the practice; null outside of it.
   * @param {{words: string, actions: string[], done: boolean}[] | null} steps
   * @param {() => void} skip
   */
  steps(steps, skip) {
    toggle("steps", steps !== null);
    if (steps === null) return;
    find("steps-left").textContent = stepsLeft(steps);
    find("steps-list").replaceChildren(
      ...steps.map(({ words, actions, done }) => {
        const row = document.createElement("li");
        row.classList.toggle("done", done);
        const keys = document.createElement("span");
        keys.className = "keys";
        keys.append(...actions.map((action) => this.#key(action)));
        const text = document.createElement("span");
        text.textContent = words;
        row.append(keys, text);
        return row;
      }),
    );
    find("skip").onclick = skip;
  }

  /** Words that go away after a while. @param {string} words */
  notice(words) {
    find("notice").textContent = words;
    toggle("notice", words !== "");
    clearTimeout(this.noticed);
    if (words) this.noticed = setTimeout(() => toggle("notice", false), NOTICE_MS);
  }

  /**
   * A card in the middle, with a button, and another one for something else; null takes it away.
   * @param {{title: string, text: string, button?: string, other?: string} | null} card
   * @param {() => void} [done]
   * @param {() => void} [otherDone]
   */
  card(card, done, otherDone) {
    toggle("card", card !== null);
    document.body.classList.toggle("asking", card !== null);
    if (card === null) return;
    document.exitPointerLock?.();
    find("title").textContent = card.title;
    find("text").textContent = card.text;
    const button = /** @type {HTMLButtonElement} */ (find("go"));
    button.classList.toggle("hidden", !card.button);
    button.textContent = card.button ?? "";
    button.onclick = () => done?.();
    const other = find("other");
    toggle("other", Boolean(card.other));
    other.textContent = card.other ?? "";
    other.onclick = () => otherDone?.();
    toggle("scale", false);
    this.keys.digits = null;
    find("help").replaceChildren();
    if (card.button) button.focus();
  }

  /**
   * Ask for a rating.
   * @param {string} title @param {string} text @param {number} scale its largest value; the smallest is 1
   * @param {(value: number) => void} done
   */
  rating(title, text, scale, done) {
    this.card({ title, text });
    const buttons = Array.from({ length: scale }, (_, k) => {
      const button = document.createElement("button");
      button.textContent = String(k + 1);
      button.dataset.value = String(k + 1);
      button.onclick = () => done(k + 1);
      return button;
    });
    find("scale").replaceChildren(...buttons);
    this.keys.digits = (value) => value >= 1 && value <= scale && done(value);
    toggle("scale", true);
  }

  /** The list of keys, in the card. @param {boolean} phases whether there are phases to be ready for */
  help(phases) {
    const useful = Object.entries(ACTIONS).filter(([action]) => action !== "ready" || phases);
    find("help").replaceChildren(
      ...useful.map(([action, [words]]) => {
        const row = document.createElement("button");
        row.className = "key-row";
        row.dataset.action = action;
        row.append(this.#hint(action, words));
        row.onclick = () => {
          row.textContent = `press a key to ${words}, Escape to leave it`;
          row.blur();
          this.keys.choose(action, () => this.help(phases));
        };
        return row;
      }),
    );
  }

  /** @param {string} action @param {string} words */
  #hint(action, words) {
    const hint = document.createElement("span");
    hint.className = "hint";
    hint.append(this.#key(action), ` ${words}`);
    return hint;
  }

  /** @param {string} action */
  #key(action) {
    const key = document.createElement("kbd");
    key.textContent = keyName(this.keys.codes[action]);
    return key;
  }
}
