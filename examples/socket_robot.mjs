// A robot of a live session in JavaScript, without a library (Node.js 22 or newer, or a browser):
//   node socket_robot.mjs "ws://127.0.0.1:8765/robot#TOKEN"
// `hthor live --agent socket` prints the address. The robot looks round, goes on where there is room, and sends people
// a message with the place of the target when it sees it. See docs/wire.md.

if (typeof WebSocket === "undefined") {
  console.error(`This needs Node.js 22 or newer, which has WebSockets; this is ${process.version}.`);
  process.exit(2);
}

function pack(value) {
  const parts = [];
  const head = (code, size) => parts.push(Uint8Array.of(code, size >> 24, size >> 16, size >> 8, size));
  const put = (one) => {
    if (one === null) parts.push(Uint8Array.of(0xc0));
    else if (typeof one === "boolean") parts.push(Uint8Array.of(one ? 0xc3 : 0xc2));
    else if (Number.isInteger(one) && Math.abs(one) < 2 ** 31) head(0xd2, one);
    else if (typeof one === "number") {
      const data = new DataView(new ArrayBuffer(9));
      data.setUint8(0, 0xcb);
      data.setFloat64(1, one);
      parts.push(new Uint8Array(data.buffer));
    } else if (typeof one === "string") {
      const data = new TextEncoder().encode(one);
      head(0xdb, data.length);
      parts.push(data);
    } else if (Array.isArray(one)) {
      head(0xdd, one.length);
      one.forEach(put);
    } else {
      head(0xdf, Object.keys(one).length);
      Object.entries(one).flat().forEach(put);
    }
  };
  put(value);
  const whole = new Uint8Array(parts.reduce((size, part) => size + part.length, 0));
  parts.reduce((at, part) => (whole.set(part, at), at + part.length), 0);
  return whole;
}

function unpack(buffer) {
  const data = new DataView(buffer);
  let at = 0;
  const number = (kind, size) => data[`get${kind}`]((at += size) - size);
  const bytes = (size) => new Uint8Array(buffer, (at += size) - size, size);
  const text = (size) => new TextDecoder().decode(bytes(size));
  const list = (size) => Array.from({ length: size }, take);
  const map = (size) => Object.fromEntries(Array.from({ length: size }, () => [take(), take()]));
  const unsigned = (width) => [() => number("Uint8", 1), () => number("Uint16", 2), () => number("Uint32", 4)][width]();
  function take() {
    const tag = number("Uint8", 1);
    if (tag < 0x80) return tag;
    if (tag < 0x90) return map(tag & 15);
    if (tag < 0xa0) return list(tag & 15);
    if (tag < 0xc0) return text(tag & 31);
    if (tag >= 0xe0) return tag - 256;
    if (tag >= 0xc4 && tag <= 0xc6) return bytes(unsigned(tag - 0xc4));
    if (tag >= 0xcc && tag <= 0xce) return unsigned(tag - 0xcc);
    if (tag >= 0xd9 && tag <= 0xdb) return text(unsigned(tag - 0xd9));
    if (tag === 0xdc || tag === 0xdd) return list(unsigned(tag - 0xdb));
    if (tag === 0xde || tag === 0xdf) return map(unsigned(tag - 0xdd));
    switch (tag) {
      case 0xc0: return null;
      case 0xc2: return false;
      case 0xc3: return true;
      case 0xca: return number("Float32", 4);
      case 0xcb: return number("Float64", 8);
      case 0xcf: return Number(number("BigUint64", 8));
      case 0xd0: return number("Int8", 1);
      case 0xd1: return number("Int16", 2);
      case 0xd2: return number("Int32", 4);
      case 0xd3: return Number(number("BigInt64", 8));
    }
    throw new Error(`MessagePack ${tag}`);
  }
  return take();
}

const ROUND = 9, TURN = 0.7, STEPS = 6; // so many turns [rad] look once round; then it goes on for so many steps
const [address, token] = process.argv[2].split("#");
const socket = new WebSocket(address, ["hthor.wire", token]);
socket.binaryType = "arraybuffer";
const received = [];
let waiting = null;
socket.onmessage = ({ data }) => {
  received.push(unpack(data));
  waiting?.();
};
socket.onclose = ({ code, reason }) => {
  console.error(`the connection was closed: ${code} ${reason}`);
  process.exit(code <= 1001 ? 0 : 1);
};
const send = (message) => socket.send(pack(message));
const hear = async () => {
  while (!received.length) await new Promise((resolve) => (waiting = resolve));
  return received.shift();
};
const ask = async (what) => {
  send({ type: "ask", what });
  return (await hear()).value;
};

function tell(thing) {
  const [x, y, z] = thing.position;
  const words = `The ${thing.kind.replaceAll("_", " ")} is at ${x.toFixed(1)}, ${y.toFixed(1)}.`;
  return { type: "send", text: words, object: thing.id, position: [x, y, z] };
}

await new Promise((resolve) => (socket.onopen = resolve));
send({ type: "ready", wire: 2, name: "socket-robot", doc: "Looks round, and tells.", privileges: ["ideal_detector"] });
let target = "", count = 0;
for (;;) {
  const message = await hear();
  if (message.type === "begin") {
    [target, count] = [message.briefing.target, 0];
    send({ type: "done" });
  } else if (message.type === "look") {
    const ranges = new Float64Array((await ask("scan")).ranges.d.slice().buffer);
    const room = Math.min(...ranges.slice(ranges.length / 3, (2 * ranges.length) / 3));
    const turn = count++ % (ROUND + STEPS) < ROUND || room < 0.6;
    const action = { motion: turn ? { type: "rotate", yaw: TURN } : { type: "move", forward: 0.4 } };
    const found = (await ask("detections")).find((thing) => thing.kind === target);
    if (found && message.observation.receipt === null) action.say = tell(found);
    send({ type: "acted", action });
  }
}
