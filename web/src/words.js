// Words that stand on the page at a desk and on the sheets of a headset alike.

/** A time that is left, and whether it is short. @param {number} seconds */
export function countdown(seconds) {
  const left = Math.max(0, Math.ceil(seconds));
  return { time: `${Math.floor(left / 60)}:${String(left % 60).padStart(2, "0")}`, short: left <= 10 };
}

/** How far the session is. @param {any} trial */
export const progress = (trial) => (trial.practice ? "Practice" : `${trial.trial + 1} of ${trial.trials}`);

/** The name of a thing by its id. @param {string} id */
export const nameOf = (id) => id.replaceAll("_", " ").replaceAll("|", " ");

/** The two answers to a message. @param {any} panel */
export const answers = (panel) => (panel.question ? ["yes", "no"] : ["confirm", "decline"]);

/** How much of the practice is left. @param {{done: boolean}[]} steps */
export function stepsLeft(steps) {
  const left = steps.filter((step) => !step.done).length;
  return left > 0 ? `Still to try: ${left}` : "All done. Please wait for the others.";
}
