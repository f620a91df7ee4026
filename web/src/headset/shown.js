// What the sheets before the eyes of a person with a headset show, from the state of the page.

import { answers, countdown, nameOf, progress, stepsLeft } from "../words.js";

/**
 * @param {any} page
 * @returns {import("./screens.js").Shown}
 */
export function shownIn(page) {
  const { controls } = page.headset;
  const hint = (/** @type {string} */ action, /** @type {string} */ words) =>
    /** @type {[string, string]} */ ([controls.nameOf(action), words]);
  const card = page.card();
  const plays = page.plays && !card.title;
  const { panel } = page;
  return {
    task: page.begun && page.head && page.ended === null && page.house ? task(page, hint) : null,
    message: plays && panel ? message(panel, hint) : null,
    map: plays && page.shownMap ? { map: page.shownMap, hints: [hint("map", "hide")] } : null,
    steps: plays && page.steps ? steps(page.steps, controls) : null,
    notice: plays && performance.now() < page.notice.until ? page.notice.words : null,
    card: card.title ? question(card, page.chosen, hint) : null,
  };
}

/** @param {any} page @param {(action: string, words: string) => [string, string]} hint */
function task(page, hint) {
  const { time, short } = countdown(page.left);
  const { practice, instruction } = page.trial;
  return {
    trial: progress(page.trial),
    instruction,
    time: practice ? "" : page.now.phase || time,
    short: !page.now.phase && !practice && short,
    held: nameOf(page.now.holding),
    offers: page.offers
      .filter((/** @type {[string, string]} */ [action]) => action !== "drop") // which the side button does
      .map((/** @type {[string, string]} */ [action, words]) => hint(action, words)),
  };
}

/** @param {any} panel @param {(action: string, words: string) => [string, string]} hint */
function message(panel, hint) {
  const [yes, no] = answers(panel);
  const hints = [hint("accept", yes), hint("decline", no), hint("panel", "hide")];
  return { message: panel.message, sender: panel.sender, text: panel.text, pictured: panel.picture, hints };
}

/** @param {any[]} all @param {import("./controls.js").Controls} controls */
function steps(all, controls) {
  return {
    left: stepsLeft(all),
    steps: all.map(({ words, actions, done }) => {
      const names = actions.map((/** @type {string} */ action) => controls.nameOf(action)).filter(Boolean);
      return { words: names.length > 0 ? `${words} (${names.join(", ")})` : words, done };
    }),
  };
}

/** @param {any} card @param {number} chosen @param {(action: string, words: string) => [string, string]} hint */
function question({ title, text, button, other, rate }, chosen, hint) {
  if (rate) {
    const hints = [/** @type {[string, string]} */ (["stick", "choose"]), hint("accept", "answer")];
    return { title, text, hints, scale: rate, chosen };
  }
  const hints = [...(button ? [hint("accept", button)] : []), ...(other ? [hint("decline", other)] : [])];
  return { title, text, hints, scale: 0, chosen: 0 };
}
