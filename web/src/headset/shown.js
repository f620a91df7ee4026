// What the sheets before the eyes of a person with a headset show, from the state of the page.

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
  const left = Math.max(0, Math.ceil(page.left));
  const time = page.now.phase || `${Math.floor(left / 60)}:${String(left % 60).padStart(2, "0")}`;
  const { practice, trial, trials, instruction } = page.trial;
  return {
    trial: practice ? "Practice" : `${trial + 1} of ${trials}`,
    instruction,
    time: practice ? "" : time,
    short: !page.now.phase && !practice && left <= 10,
    held: page.now.holding.replaceAll("_", " ").replaceAll("|", " "),
    offers: page.offers
      .filter((/** @type {[string, string]} */ [action]) => action !== "drop") // which the side button does
      .map((/** @type {[string, string]} */ [action, words]) => hint(action, words)),
  };
}

/** @param {any} panel @param {(action: string, words: string) => [string, string]} hint */
function message(panel, hint) {
  const [yes, no] = panel.question ? ["yes", "no"] : ["confirm", "decline"];
  const hints = [hint("accept", yes), hint("decline", no), hint("panel", "hide")];
  return { message: panel.message, sender: panel.sender, text: panel.text, pictured: panel.picture, hints };
}

/** @param {any[]} all @param {import("./controls.js").Controls} controls */
function steps(all, controls) {
  const left = all.filter((step) => !step.done).length;
  return {
    left: left > 0 ? `Still to try: ${left}` : "All done. Please wait for the others.",
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
    return { title, text: "1: not at all   ·   7: completely", hints, scale: 7, chosen };
  }
  const hints = [...(button ? [hint("accept", button)] : []), ...(other ? [hint("decline", other)] : [])];
  return { title, text, hints, scale: 0, chosen: 0 };
}
