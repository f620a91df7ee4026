// The time of the trial: its slider with marks, the list of what happened, and how fast it goes.

export const SPEEDS = [0.5, 1, 2, 4, 8];
/** @type {Record<string, [string, string]>} the sign and the colour class of each kind of event that is marked */
const SIGNS = {
  sent: ["✉", "said"],
  answered: ["✓", "yes"],
  accepted: ["✓", "yes"],
  declined: ["✗", "no"],
  picked: ["▲", "act"],
  lifted: ["▲", "act"],
  placed: ["▼", "act"],
  dropped: ["▼", "act"],
  lowered: ["▼", "act"],
  opened: ["◇", "act"],
  closed: ["◆", "act"],
  success: ["★", "yes"],
  timeout: ["■", "no"],
  voided: ["■", "no"],
  fault: ["!", "no"],
};

/** @param {string} id */
const find = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** Minutes and seconds. @param {number} seconds @param {number} [digits] */
export function clock(seconds, digits = 1) {
  const minutes = Math.floor(seconds / 60);
  return `${minutes}:${(seconds - 60 * minutes).toFixed(digits).padStart(digits ? 3 + digits : 2, "0")}`;
}

export class Timeline {
  /**
   * @param {import("./recording.js").Recording} recording
   * @param {(seconds: number) => void} seek called when somebody chooses a time
   */
  constructor(recording, seek) {
    this.recording = recording;
    this.slider = /** @type {HTMLInputElement} */ (find("slider"));
    this.slider.max = String(recording.ticks);
    this.slider.oninput = () => seek(Number(this.slider.value) * recording.tick_s);
    this.shown = -2;
    find("marks").replaceChildren(
      ...recording.events.flatMap((event) => {
        const [sign, kind] = SIGNS[event.kind] ?? ["", ""];
        if (!sign || event.minor) return [];
        const mark = document.createElement("button");
        mark.textContent = sign;
        mark.className = `mark ${kind}`;
        mark.tabIndex = -1;
        mark.title = `${clock(event.tick * recording.tick_s)}  ${event.words}`;
        mark.style.left = `${(100 * event.tick) / Math.max(1, recording.ticks)}%`;
        const seat = recording.seats.find((one) => one.seat === event.seat);
        if (kind === "act" && seat) mark.style.color = seat.colour;
        mark.onclick = () => seek(event.tick * recording.tick_s);
        return [mark];
      }),
    );
    this.rows = recording.events.map((event) => {
      const row = document.createElement("li");
      const button = document.createElement("button");
      const time = document.createElement("time");
      time.textContent = clock(event.tick * recording.tick_s);
      const [sign, kind] = SIGNS[event.kind] ?? ["", ""];
      const mark = document.createElement("span");
      mark.className = `sign ${kind}`;
      mark.textContent = sign;
      const words = document.createElement("span");
      words.textContent = event.words;
      button.append(time, mark, words);
      button.onclick = () => seek(event.tick * recording.tick_s);
      row.classList.toggle("minor", event.minor);
      row.append(button);
      return row;
    });
    find("events").replaceChildren(...this.rows);
  }

  /** @param {number} seconds @param {boolean} playing @param {number} speed */
  show(seconds, playing, speed) {
    const { recording } = this;
    this.slider.value = String(seconds / recording.tick_s);
    this.slider.setAttribute("aria-valuetext", clock(seconds));
    find("now").textContent = clock(seconds);
    find("end").textContent = clock(recording.seconds);
    find("play").textContent = playing ? "❚❚" : "▶";
    find("play").setAttribute("aria-label", playing ? "pause" : "play");
    find("speed").textContent = `${speed}×`;
    const number = recording.eventAt(seconds);
    if (number === this.shown) return;
    this.shown = number;
    this.rows.forEach((row, k) => {
      row.classList.toggle("now", k === number);
      row.classList.toggle("ahead", k > number);
    });
    let told = number;
    while (told >= 0 && recording.events[told].minor) told -= 1;
    find("caption").textContent = told >= 0 ? recording.events[told].words : "";
    const list = find("events");
    const row = this.rows[Math.max(0, number)];
    if (row) list.scrollTop = row.offsetTop - list.clientHeight * 0.6;
  }

  /** The time [s] of the next or the last event that is marked. @param {number} seconds @param {number} way 1 or -1 */
  step(seconds, way) {
    const { events, tick_s, ticks } = this.recording;
    const tick = seconds / tick_s;
    const times = events.filter((event) => !event.minor).map((event) => event.tick);
    const found = way > 0 ? times.find((one) => one > tick + 0.01) : times.findLast((one) => one < tick - 0.01);
    return (found ?? (way > 0 ? ticks : 0)) * tick_s;
  }
}
