// The connection to the server, in a thread of its own, so that drawing never holds it up. It connects again by itself.

import { VERSION, decode, encodeSteering } from "./wire.js";

const RETRY_MS = [250, 500, 1000, 2000];
const PING_MS = 1000;

/** @type {WebSocket | null} */
let socket = null;
let token = "";
/** Which start of the server the acts were sent to. */
let server = "";
let failures = 0;
let steered = 0;
let acted = 0;
let frames = 0;
let roundTrip = 0;
/** Whether the person is in VR, and whether they do not see the house there. */
let vr = false;
let off = false;
/** Acts that the server has not acknowledged, oldest first. @type {{number: number}[]} */
let pending = [];

/** @param {object} message */
const tell = (message) => socket?.readyState === WebSocket.OPEN && socket.send(JSON.stringify(message));

const ping = () => tell({ type: "ping", sent: performance.now(), frames, round_trip: roundTrip, vr, off });

function connect() {
  const scheme = self.location.protocol === "https:" ? "wss" : "ws";
  const made = new WebSocket(`${scheme}://${self.location.host}/live`, [VERSION]);
  socket = made;
  made.binaryType = "arraybuffer";
  made.onopen = () => tell({ type: "join", token });
  made.onmessage = (event) => (typeof event.data === "string" ? onWords(JSON.parse(event.data)) : onFrame(event.data));
  made.onclose = () => {
    if (socket !== made) return;
    self.postMessage({ type: "lost" });
    setTimeout(connect, RETRY_MS[Math.min(failures, RETRY_MS.length - 1)]);
    failures += 1;
  };
}

/** @param {any} message */
function onWords(message) {
  if (message.type === "welcome") {
    failures = 0;
    if (message.server !== server) [server, acted, pending] = [message.server, 0, []];
    acted = Math.max(acted, message.acts);
    pending = pending.filter((act) => act.number > message.acts);
    pending.forEach(tell);
    ping();
  } else if (message.type === "acknowledged") {
    pending = pending.filter((act) => act.number > message.act);
  } else if (message.type === "pong") {
    roundTrip = (performance.now() - message.sent) / 1000;
  } else if (message.type === "problem" || (message.type === "over" && !message.making)) {
    const closed = socket;
    socket = null; // do not connect again
    closed?.close();
  }
  self.postMessage(message);
}

/** @param {ArrayBuffer} buffer */
function onFrame(buffer) {
  const frame = decode(buffer);
  if (frame !== null) self.postMessage({ type: "head" in frame ? "frame" : "picture", ...frame });
}

self.onmessage = ({ data }) => {
  if (data.type === "open") {
    token = data.token;
    connect();
    setInterval(ping, PING_MS);
  } else if (data.type === "steer") {
    steered = data.number;
    frames = data.frames;
    if (socket?.readyState === WebSocket.OPEN) socket.send(encodeSteering(steered, data.drive, data.hand ?? null));
  } else if (data.type === "headset") {
    ({ vr, off } = data);
    ping();
  } else if (data.type === "act") {
    acted += 1;
    const act = { ...data, number: acted };
    pending.push(act);
    tell(act);
  } else {
    tell(data);
  }
};
