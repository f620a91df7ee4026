// The map of confirmed messages: directions and distances from the person, who looks up. As hthor/world draws it.

const RANGES_M = [4, 8, 16, 32, 64];
const RING = 0.4;
const PERSON = "#0072b2";
const OTHER = "#001f54";
const ROBOT = "#d55e00";
const PLACE = "#7a3b8f";

/**
 * @typedef {{forward: number, left: number}} Mark
 * @typedef {{bodies: (Mark & {seat: string})[], places: (Mark & {message: number, object: string})[]}} DisplayMap
 */

/** The map as the text of an SVG picture. @param {DisplayMap} shown */
export function drawMap({ bodies, places }) {
  const far = Math.max(0, ...[...bodies, ...places].map((mark) => Math.hypot(mark.forward, mark.left)));
  const range = RANGES_M.find((metres) => far <= metres) ?? RANGES_M[RANGES_M.length - 1];
  const at = (/** @type {Mark} */ { forward, left }) => {
    const length = Math.hypot(forward, left);
    const scale = (RING / range) * Math.min(1, length > 0 ? range / length : 1) * 100;
    return [50 - scale * left, 50 - scale * forward];
  };
  const marks = [...bodies, ...places].map(at);
  const parts = [0.5, 1].flatMap((share) => {
    const radius = 100 * RING * share;
    const [x, y] = label(radius + 4, marks);
    return [
      `<circle cx="50" cy="50" r="${radius}" fill="none" stroke="#c4c8ce" stroke-width="0.6"/>`,
      words(`${range * share} m`, x, y + 1.5, "#464a52"),
    ];
  });
  for (const place of places) {
    const [x, y] = at(place);
    parts.push(`<polygon points="${star(x, y, 3.6)}" fill="${PLACE}"/>`);
    const metres = Math.hypot(place.forward, place.left).toFixed(1);
    const name = place.object.replaceAll("_", " ");
    parts.push(words(`${name} ${metres} m`, x, y - 4.5, PLACE));
  }
  for (const body of bodies) {
    const [x, y] = at(body);
    const shade = body.seat.startsWith("human") ? OTHER : ROBOT;
    parts.push(`<circle cx="${x}" cy="${y}" r="2.8" fill="${shade}"/>`, words(body.seat, x, y + 7, shade));
  }
  parts.push(`<polygon points="50,45.5 53.4,53.6 50,51.8 46.6,53.6" fill="${PERSON}"/>`);
  return `<svg viewBox="0 0 100 100" role="img" aria-label="map">${parts.join("")}</svg>`;
}

/**
 * Where the words of a ring stand: below the person, or where no mark covers them.
 * @param {number} radius @param {number[][]} marks
 */
function label(radius, marks) {
  const free = (/** @type {number[]} */ [x, y]) => marks.every((mark) => Math.hypot(mark[0] - x, mark[1] - y) > 12);
  const turns = [0, 0.25, -0.25, 0.5, -0.5].map((share) => Math.PI * share);
  const spots = turns.map((turn) => [50 + radius * Math.sin(turn), 50 + radius * Math.cos(turn)]);
  return spots.find(free) ?? spots[0];
}

/** @param {string} text @param {number} x @param {number} y @param {string} shade */
function words(text, x, y, shade) {
  const safe = text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);
  return `<text x="${x}" y="${y}" fill="${shade}">${safe}</text>`;
}

/** @param {number} x @param {number} y @param {number} radius */
function star(x, y, radius) {
  return Array.from({ length: 10 }, (_, k) => {
    const far = k % 2 === 0 ? radius : 0.42 * radius;
    const angle = (Math.PI * k) / 5;
    return `${x + far * Math.sin(angle)},${y - far * Math.cos(angle)}`;
  }).join(" ");
}
