// What a person with a headset reads: the task, the message, the map, the practice, and the questions of the session.

import * as THREE from "three";
import { drawMap } from "../map.js";
import { Sheet } from "./sheets.js";

const AWAY_M = 1.3; // how far the sheets are from the eyes
const BEHIND = 0.5; // [rad] how far a head turns before the sheets come along
const FOLLOW_PER_S = 4;
const SMALL_PX = 38; // 1.5 degrees at that distance
const LARGE_PX = 46;
const GREY = "#5b636d";
const SENDER = "#b24a00";

/**
 * Where each sheet hangs: its size [m], and its middle in degrees to the left of the heading and above the eyes.
 * @type {Record<string, [number, number, number, number]>}
 */
const PLACES = {
  task: [0.95, 0.3, 0, -28],
  message: [0.5, 0.5, -23, -9.5],
  map: [0.46, 0.48, 23, -9.5],
  steps: [0.62, 0.66, 30, -8],
  notice: [0.8, 0.1, 0, -15],
  card: [0.95, 0.46, 0, -12],
};

/**
 * @typedef {{task: any, message: any, map: any, steps: any, notice: any, card: any}} Shown what each sheet shows; null
 *   for nothing
 */

/** All sheets. They stand round the head, and come along when it has turned away from them. */
export class Screens {
  constructor() {
    this.group = new THREE.Group();
    this.yaw = NaN;
    this.following = false;
    /** @type {Record<string, Sheet>} */
    this.sheets = {};
    for (const [name, [width, height, left, up]] of Object.entries(PLACES)) {
      const sheet = new Sheet(width, height);
      const [yaw, pitch] = [THREE.MathUtils.degToRad(left), THREE.MathUtils.degToRad(up)];
      const flat = AWAY_M * Math.cos(pitch);
      const { mesh } = sheet;
      mesh.position.set(flat * Math.cos(yaw), flat * Math.sin(yaw), AWAY_M * Math.sin(pitch));
      mesh.up.set(0, 0, 1);
      mesh.lookAt(0, 0, 0);
      this.group.add(mesh);
      this.sheets[name] = sheet;
    }
    /** The picture of the message on the sheet. @type {ImageBitmap | null} */
    this.picture = null;
    this.drawn = "";
    /** The map as a picture, the last that was ready, and how many there have been. @type {HTMLImageElement | null} */
    this.map = null;
    this.maps = 0;
  }

  /** Bring the sheets back in front of the eyes. */
  recentre() {
    this.yaw = NaN;
  }

  /** Take the picture that belongs to the message. @param {Blob | null} jpeg */
  async takePicture(jpeg) {
    this.picture = jpeg ? await createImageBitmap(jpeg) : null;
    this.sheets.message.shown = "";
  }

  /**
   * Show what there is to read.
   * @param {Shown} shown @param {{x: number, y: number, z: number, yaw: number}} head @param {number} seconds
   */
  show(shown, head, seconds) {
    this.#follow(head, seconds);
    this.sheets.task.show(shown.task, drawTask);
    this.sheets.message.show(shown.message, (sheet, what) => this.#message(sheet, what));
    this.#drawMap(shown.map?.map ?? null);
    const map = shown.map && { hints: shown.map.hints, number: this.maps };
    this.sheets.map.show(map, (sheet, what) => this.#map(sheet, what));
    this.sheets.steps.show(shown.steps, drawSteps);
    this.sheets.notice.show(shown.notice, (sheet, words) => sheet.write(words, 30, SMALL_PX, { align: "center" }));
    this.sheets.card.show(shown.card, drawCard);
  }

  /** Free what the graphics card keeps. */
  dispose() {
    Object.values(this.sheets).forEach((sheet) => sheet.dispose());
  }

  /** @param {{x: number, y: number, z: number, yaw: number}} head @param {number} seconds */
  #follow(head, seconds) {
    this.group.position.set(head.x, head.y, head.z);
    if (Number.isNaN(this.yaw)) this.yaw = head.yaw;
    const gap = Math.atan2(Math.sin(head.yaw - this.yaw), Math.cos(head.yaw - this.yaw));
    if (Math.abs(gap) > BEHIND) this.following = true;
    if (this.following) this.yaw += gap * (1 - Math.exp(-FOLLOW_PER_S * seconds));
    if (Math.abs(gap) < 0.05) this.following = false;
    this.group.rotation.z = this.yaw;
  }

  /** @param {Sheet} sheet @param {any} what */
  #message(sheet, { sender, text, hints, pictured }) {
    let top = sheet.write(sender, 24, LARGE_PX, { weight: 700, colour: SENDER }) + 6;
    if (pictured && this.picture) {
      const width = sheet.canvas.width - 52;
      const height = Math.min(200, (width * this.picture.height) / this.picture.width);
      const shown = (height * this.picture.width) / this.picture.height;
      sheet.pen.drawImage(this.picture, 26 + (width - shown) / 2, top, shown, height);
      top += height + 16;
    }
    top = sheet.write(text, top, SMALL_PX) + 14;
    sheet.hints(hints, top, SMALL_PX);
  }

  /** Have the map drawn as a picture, if it is another one. @param {any} map */
  #drawMap(map) {
    const drawn = map === null ? "" : drawMap(map);
    if (drawn === this.drawn) return;
    this.drawn = drawn;
    if (!drawn) return;
    const marked = drawn
      .replace("<svg ", `<svg xmlns="http://www.w3.org/2000/svg" width="460" height="460" `)
      .replaceAll("<text ", `<text font-size="5" font-family="sans-serif" text-anchor="middle" `);
    const url = URL.createObjectURL(new Blob([marked], { type: "image/svg+xml" }));
    const image = new Image();
    image.onload = () => {
      URL.revokeObjectURL(url);
      this.map = image;
      this.maps += 1;
    };
    image.src = url;
  }

  /** @param {Sheet} sheet @param {any} what */
  #map(sheet, { hints }) {
    if (this.map) sheet.pen.drawImage(this.map, 23, 10, 460, 460);
    sheet.hints(hints, 468, SMALL_PX);
  }
}

/** @param {Sheet} sheet @param {any} what */
function drawTask(sheet, { trial, instruction, time, short, held, offers }) {
  sheet.write(trial, 20, SMALL_PX, { colour: GREY });
  sheet.write(time, 20, SMALL_PX, { weight: 700, colour: short ? "#b3261e" : "#1d2126", align: "right" });
  const top = sheet.write(instruction, 20, SMALL_PX, { weight: 700, left: 190, right: sheet.canvas.width - 170 }) + 10;
  sheet.hints([...(held ? [["in hand", held]] : []), ...offers], Math.max(top, 130), SMALL_PX);
}

/** @param {Sheet} sheet @param {any} what */
function drawSteps(sheet, { left, steps }) {
  let top = sheet.write(left, 24, SMALL_PX, { weight: 700 }) + 8;
  for (const { words, done } of steps) {
    top = sheet.write(`${done ? "✓ " : "   "}${words}`, top, SMALL_PX, { colour: done ? GREY : "#1d2126" }) + 4;
  }
}

/** @param {Sheet} sheet @param {any} what */
function drawCard(sheet, { title, text, hints, scale, chosen }) {
  const style = /** @type {const} */ ({ align: "center" });
  let top = sheet.write(title, 44, LARGE_PX, { ...style, weight: 700 }) + 16;
  top = sheet.write(text, top, SMALL_PX, style) + 28;
  const { pen } = sheet;
  for (let value = 1; value <= scale; value += 1) {
    const side = 92;
    const x = (sheet.canvas.width - scale * (side + 18) + 18) / 2 + (value - 1) * (side + 18);
    pen.fillStyle = value === chosen ? "#0072b2" : "#fff";
    pen.strokeStyle = "#0072b2";
    pen.lineWidth = 3;
    pen.beginPath();
    pen.roundRect(x, top, side, side, 14);
    pen.fill();
    pen.stroke();
    sheet.write(String(value), top + 22, LARGE_PX, {
      ...style,
      weight: 700,
      colour: value === chosen ? "#fff" : "#0072b2",
      left: x,
      right: x + side,
    });
  }
  if (scale) top += 130;
  sheet.hints(hints, top, SMALL_PX);
}
