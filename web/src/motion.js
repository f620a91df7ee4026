// Where the person is on screen: what the server said last, and the steering that it has not answered yet.

const SETTLE_PER_S = 10; // how fast a correction is worked in, so that nothing jumps
const JUMP_M = 1.5; // a larger correction is no correction: the person was put somewhere else
const MEMORY = 240;

/** The person's own motion. */
export class OwnMotion {
  constructor() {
    this.x = this.y = 0;
    this.number = 0;
    /** How much of the commanded motion the house lets through, 0 to 1. */
    this.share = 1;
    this.largest = 0;
    this.reset();
  }

  /** A new trial: the next frame says where the person is. */
  reset() {
    /** @type {{number: number, dx: number, dy: number}[]} */
    this.sent = [];
    /** @type {{x: number, y: number} | null} */
    this.base = null;
    this.offX = this.offY = 0;
    this.share = 1;
  }

  /**
   * Count a picture's steering.
   * @param {import("./wire.js").Drive} drive @param {number} seconds
   */
  steer(drive, seconds) {
    this.number += 1;
    const [cos, sin] = [Math.cos(drive.yaw), Math.sin(drive.yaw)];
    const dx = (cos * drive.forward - sin * drive.left) * seconds;
    const dy = (sin * drive.forward + cos * drive.left) * seconds;
    this.sent.push({ number: this.number, dx, dy });
    if (this.sent.length > MEMORY) this.sent.shift();
    if (dx === 0 && dy === 0) this.share = 1;
    const fade = Math.exp(-SETTLE_PER_S * seconds);
    this.offX *= fade;
    this.offY *= fade;
    this.#place();
    return this.number;
  }

  /** Take a frame of the server. @param {import("./wire.js").FrameHead} head */
  correct(head) {
    const before = { x: this.x, y: this.y };
    if (this.base !== null) this.#measure(head);
    const first = this.base === null;
    this.base = { x: head.x, y: head.y };
    this.sent = this.sent.filter((one) => one.number > head.steering);
    this.offX = this.offY = 0;
    this.#place();
    const gap = Math.hypot(before.x - this.x, before.y - this.y);
    if (first || gap > JUMP_M) return;
    this.largest = Math.max(this.largest, gap);
    this.offX = before.x - this.x;
    this.offY = before.y - this.y;
    this.#place();
  }

  /** How much of the motion that this frame answers has happened. @param {import("./wire.js").FrameHead} head */
  #measure(head) {
    const answered = this.sent.filter((one) => one.number <= head.steering);
    const dx = answered.reduce((sum, one) => sum + one.dx, 0);
    const dy = answered.reduce((sum, one) => sum + one.dy, 0);
    const asked = dx * dx + dy * dy;
    if (asked < 1e-6 || this.base === null) return;
    const done = ((head.x - this.base.x) * dx + (head.y - this.base.y) * dy) / asked;
    this.share += 0.3 * (Math.min(1, Math.max(0, done)) - this.share);
  }

  #place() {
    const base = this.base ?? { x: this.x, y: this.y };
    const dx = this.sent.reduce((sum, one) => sum + one.dx, 0);
    const dy = this.sent.reduce((sum, one) => sum + one.dy, 0);
    this.x = base.x + this.share * dx + this.offX;
    this.y = base.y + this.share * dy + this.offY;
  }
}
