// The experimenter's page: a session from outside. Everything on it comes from the server's log of the session.

import { Views } from "./views.js";
import { VERSION, decode } from "./wire.js";

const TICKS_PER_S = 10;
const COLOURS = ["#0072b2", "#d55e00", "#001f54", "#7a3b8f", "#009e73"];
const RETRY_MS = 1000;
/** @type {[string, boolean | null][]} */
const CORRECTIONS = [["yes", true], ["no", false], ["exclude", null]];

/** @param {string} id */
const find = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** The reason that the experimenter has written, which is then gone from the page: it is for one command. */
function reason() {
  const field = /** @type {HTMLInputElement} */ (find("reason"));
  const given = field.value;
  field.value = "";
  return given;
}

/** A text inside a picture. @param {string} text @param {number} x @param {number} y @param {string} colour */
function words(text, x, y, colour) {
  const safe = text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
  return `<text x="${x}" y="${y}" font-size="0.35" text-anchor="middle" fill="${colour}">${safe}</text>`;
}

/** An element with text in it. @param {string} tag @param {string} text @param {string} [kind] */
function make(tag, text, kind = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  made.className = kind;
  return made;
}

class Desk {
  constructor() {
    /** @type {any} */ this.plan = null;
    this.practice = false;
    this.begun = false;
    /** Where everybody has been. @type {Map<string, number[][]>} */
    this.trails = new Map();
    /** What the seats see, while that is shown. @type {Views | null} */
    this.views = null;
    find("start").onclick = () => this.tell({ type: "start" });
    this.asked = false;
    find("ask-vr").onclick = () => this.tell({ type: "ask_for_headset", on: !this.asked });
    find("look").onclick = () => this.look(this.views === null);
    find("pause").onclick = () => this.tell({ type: "pause", reason: reason() });
    find("go-on").onclick = () => this.tell({ type: "go_on" });
    find("void").onclick = () => {
      const given = reason();
      this.tell({ type: "void", reason: given || (this.practice ? "the experimenter ended the practice" : "") });
    };
    this.connect();
  }

  connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    this.socket = new WebSocket(`${scheme}://${location.host}/live`, [VERSION]);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => {
      this.tell({ type: "join", token: location.hash.slice(1) });
      if (this.views) this.tell({ type: "look", on: true });
    };
    this.socket.onmessage = ({ data }) => {
      if (typeof data !== "string") return this.on_frame(data);
      const message = JSON.parse(data);
      /** @type {any} */ (this)[`on_${message.type}`]?.(message);
    };
    this.socket.onclose = () => {
      find("state").textContent = "not connected";
      if (!this.refused) setTimeout(() => this.connect(), RETRY_MS);
    };
  }

  /** @param {object} message */
  tell(message) {
    find("refused").textContent = "";
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /** @param {any} message */
  on_problem({ words }) {
    this.refused = true;
    find("task").textContent = words;
  }

  /** @param {any} message */
  on_refused({ words }) {
    find("refused").textContent = words;
  }

  /** @param {any} plan */
  on_plan(plan) {
    this.plan = plan;
    this.trails = new Map(plan.seats.map((/** @type {string} */ seat) => [seat, []]));
    const attempt = plan.attempt ? `, attempt ${plan.attempt + 1}` : "";
    this.practice = plan.trial < 0;
    const what = this.practice ? "Practice" : `Trial ${plan.trial + 1}${attempt}`;
    find("void").textContent = this.practice ? "End the practice" : "Void and repeat";
    find("task").textContent = `${what}: ${plan.instruction}`;
    find("state").textContent = "waiting for everybody to begin";
    find("events").replaceChildren();
    find("start").classList.add("hidden");
    find("look").classList.toggle("hidden", !plan.file);
    this.draw([]);
    this.views?.open(plan.file, plan.eyes);
  }

  /** @param {any} gathering */
  on_gathering({ ready, missing, begun }) {
    const waits = `waiting for ${missing.join(", ")}${ready.length > 0 ? `; ready: ${ready.join(", ")}` : ""}`;
    this.begun = begun;
    find("state").textContent = begun ? "the trial begins" : missing.length > 0 ? waits : "everybody is ready";
    const start = /** @type {HTMLButtonElement} */ (find("start"));
    start.classList.toggle("hidden", begun || !this.plan.starts);
    start.disabled = missing.length > 0;
  }

  /** @param {any} message */
  on_session_over({ folder, pages }) {
    const files = Object.entries(pages).map(([seat, file]) => `${seat}: ${file}`);
    const words = files.length > 0 ? ` The people's own pages, in ${folder}: ${files.join(", ")}` : "";
    find("task").textContent = `The session is over.${words}`;
    find("state").textContent = "";
  }

  /** @param {any} message */
  on_ways({ ways }) {
    for (const [seat, way] of Object.entries(ways)) this.trails.set(seat, [.../** @type {any} */ (way)]);
  }

  /** @param {ArrayBuffer} data */
  on_frame(data) {
    const frame = decode(data);
    if (frame !== null && "moved" in frame) this.views?.take(frame.moved);
  }

  /** @param {any} message */
  on_headset_asked({ on }) {
    this.asked = on;
    find("ask-vr").textContent = on ? "Ask for VR no longer" : "Ask for VR";
  }

  /** Show what the seats see, or no longer. @param {boolean} on */
  look(on) {
    find("look").textContent = on ? "Hide what everybody sees" : "Show what everybody sees";
    if (on) {
      const views = new Views(find("views"));
      this.views = views;
      views.open(this.plan.file, this.plan.eyes);
      views.renderer.setAnimationLoop((now) => views.draw(now));
    } else {
      this.views?.renderer.setAnimationLoop(null);
      this.views?.close();
      this.views = null;
    }
    this.tell({ type: "look", on });
  }

  /** @param {any} watch */
  on_watch({ tick, paused, factor, people }) {
    const left = this.plan.time_limit - tick / TICKS_PER_S;
    const time = this.practice ? "people practise" : `${left.toFixed(0)} s left`;
    const speed = factor < 0.98 ? `, real-time factor ${factor.toFixed(2)}` : "";
    if (this.begun) find("state").textContent = paused ? `paused: ${paused}` : `${time}${speed}`;
    find("state").classList.toggle("paused", paused !== "");
    for (const one of people) this.trails.get(one.seat)?.push([one.x, one.y]);
    this.draw(people);
    const rows = people.map((/** @type {any} */ one) => {
      const row = make("tr", "");
      const page = one.away_s === null ? "" : one.away_s > 0 ? `away for ${one.away_s} s` : "there";
      const time = one.round_trip_ms === null ? "" : `${one.round_trip_ms} ms`;
      const frames = one.frames === null ? "" : `${one.frames} pictures/s`;
      const where = one.vr === null ? "" : one.vr ? "in VR" : "at a desk";
      row.append(...[one.seat, page, where, time, frames].map((words) => make("td", words)));
      return row;
    });
    find("people").replaceChildren(...rows);
  }

  /** @param {any} over */
  on_trial_over({ met, voided }) {
    const how = this.practice ? "the practice is over" : voided ? "the trial was voided" : `the trial is over, ${met ? "" : "not "}done`;
    find("state").textContent = `${how}; people rate, and the next one is prepared …`;
    find("state").classList.remove("paused");
  }

  /** @param {any} message */
  on_happened({ events }) {
    const lines = events.map((/** @type {any} */ { tick, words }) => {
      const line = make("li", "");
      line.append(make("b", (tick / TICKS_PER_S).toFixed(1)), words);
      return line;
    });
    find("events").prepend(...lines.reverse());
  }

  /** @param {any} message */
  on_played({ trials }) {
    const head = make("tr", "");
    head.append(...["task", "", "time", "adopted", ""].map((words) => make("th", words)));
    const rows = trials.map((/** @type {any} */ trial) => {
      const row = make("tr", "", trial.voided ? "void" : "");
      const outcome = trial.voided ? `void: ${trial.voided}` : trial.met ? "done" : "not done";
      const task = trial.attempt ? `${trial.task}, attempt ${trial.attempt + 1}` : trial.task;
      row.append(make("td", task), make("td", outcome), make("td", `${trial.seconds} s`), this.adoption(trial));
      const last = make("td", "");
      if (!trial.voided) last.append(this.repeat(trial));
      row.append(last);
      trial.corrections.forEach((/** @type {string} */ words) => row.children[0].append(make("small", words)));
      return row;
    });
    find("trials").replaceChildren(head, ...rows);
  }

  /** The button that voids a trial that is over, and has it repeated. @param {any} trial */
  repeat(trial) {
    const button = make("button", "void and repeat", "grave");
    button.onclick = () => this.tell({ type: "repeat", trial: trial.key, reason: reason() });
    return button;
  }

  /** The adoption of everybody in a trial, with what corrects it. @param {any} trial */
  adoption(trial) {
    const cell = make("td", "");
    for (const [seat, adopted] of Object.entries(trial.adopted)) {
      const line = make("div", `${seat}: ${adopted === null ? "–" : adopted ? "yes" : "no"} `);
      if (!trial.voided) {
        for (const [words, value] of CORRECTIONS) {
          const button = make("button", words);
          const command = { type: "adoption", trial: trial.key, seat, adopted: value };
          button.onclick = () => this.tell({ ...command, reason: reason() });
          line.append(button, " ");
        }
      }
      cell.append(line);
    }
    return cell;
  }

  /** The house from above, with the way of everybody. @param {any[]} people */
  draw(people) {
    const points = this.plan.rooms.flatMap((/** @type {any} */ room) => room.polygon);
    const xs = points.map((/** @type {number[]} */ [x]) => x);
    const ys = points.map((/** @type {number[]} */ [, y]) => y);
    const [x0, y1] = [Math.min(...xs) - 0.3, Math.max(...ys) + 0.3];
    const [wide, high] = [Math.max(...xs) + 0.3 - x0, y1 - Math.min(...ys) + 0.3];
    const at = (/** @type {number[]} */ [x, y]) => `${(x - x0).toFixed(2)},${(y1 - y).toFixed(2)}`;
    const parts = this.plan.rooms.flatMap((/** @type {any} */ room) => {
      /** @type {number[][]} */
      const corners = room.polygon;
      const [x, y] = [0, 1].map((k) => corners.reduce((sum, corner) => sum + corner[k], 0) / corners.length);
      return [
        `<polygon points="${corners.map(at).join(" ")}" fill="#fff" stroke="#464a52" stroke-width="0.06"/>`,
        words(room.name, x - x0, y1 - y, "#8a9099"),
      ];
    });
    [...this.trails].forEach(([seat, trail], k) => {
      const colour = COLOURS[k % COLOURS.length];
      parts.push(`<polyline points="${trail.map(at).join(" ")}" fill="none" stroke="${colour}" stroke-width="0.05"/>`);
      const one = people.find((person) => person.seat === seat);
      if (!one) return;
      const ahead = [one.x + 0.45 * Math.cos(one.yaw), one.y + 0.45 * Math.sin(one.yaw)];
      parts.push(`<polyline points="${at([one.x, one.y])} ${at(ahead)}" stroke="${colour}" stroke-width="0.08"/>`);
      parts.push(`<circle cx="${one.x - x0}" cy="${y1 - one.y}" r="0.2" fill="${colour}"/>`);
      parts.push(words(seat, one.x - x0, y1 - one.y + 0.6, colour));
    });
    find("map").innerHTML = `<svg viewBox="0 0 ${wide} ${high}">${parts.join("")}</svg>`;
  }
}

Object.assign(window, { desk: new Desk() });
