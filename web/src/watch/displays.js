// What people had on their displays: the message with its picture, and the map of confirmed messages.

import { drawMap } from "../map.js";

/** @param {string} tag @param {string} kind @param {string} [text] */
function make(tag, kind, text = "") {
  const made = document.createElement(tag);
  made.className = kind;
  made.textContent = text;
  return made;
}

export class Displays {
  /** @param {HTMLElement} panels @param {HTMLElement} maps @param {import("./recording.js").Recording} recording */
  constructor(panels, maps, recording) {
    this.recording = recording;
    this.people = recording.seats.filter((seat) => seat.person).map((seat) => {
      const panel = make("aside", "box panel hidden");
      const map = make("aside", "box map hidden");
      panel.dataset.seat = map.dataset.seat = seat.seat;
      panels.append(panel);
      maps.append(map);
      return { seat, panel, map, shown: "", drawn: "" };
    });
  }

  /** @param {number} seconds @param {string} only the person whose display is shown; empty for everybody's */
  show(seconds, only) {
    for (const person of this.people) {
      const { seat, panel, map } = person;
      const screen = this.recording.screen(seat.seat, seconds);
      const mine = !only || only === seat.seat;
      panel.classList.toggle("hidden", !mine || screen.panel === null);
      map.classList.toggle("hidden", !mine || screen.map === null);
      const shown = `${screen.panel} ${screen.answer}`;
      if (screen.panel !== null && shown !== person.shown) {
        person.shown = shown;
        this.#fill(panel, seat.seat, this.recording.letter(screen.panel), screen.answer);
      }
      if (screen.map === null || !mine) continue;
      const drawn = drawMap(this.recording.map(seat, seconds, screen.map));
      if (drawn === person.drawn) continue;
      person.drawn = drawn;
      map.innerHTML = drawn;
      if (this.people.length > 1) map.append(make("div", "whose", `the map of ${seat.seat}`));
    }
  }

  /** @param {HTMLElement} panel @param {string} seat @param {import("./recording.js").Letter} letter @param {string} answer */
  #fill(panel, seat, letter, answer) {
    const parts = [make("div", "sender", letter.sender)];
    if (letter.picture) {
      const picture = /** @type {HTMLImageElement} */ (make("img", "picture"));
      picture.alt = `what ${letter.sender} saw`;
      picture.src = `data:image/jpeg;base64,${letter.picture}`;
      parts.push(picture);
    }
    parts.push(make("p", "words", letter.text));
    const asks = letter.question ? "yes or no?" : "confirm or decline?";
    parts.push(make("div", `answer ${answer}`, answer ? `${seat}: ${answer}` : `${seat}: ${asks}`));
    panel.replaceChildren(...parts);
  }
}
