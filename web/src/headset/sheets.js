// Sheets that hang in front of a person with a headset: pictures that are drawn with words, and textures of them.

import * as THREE from "three";

const PX_PER_M = 1100;
const MARGIN_PX = 26;
const INK = "#1d2126";
const FONT = "system-ui, sans-serif";
const LINE = 1.28;

/** One sheet; its picture is drawn again only when what it shows has changed. */
export class Sheet {
  /** @param {number} width [m] @param {number} height [m] */
  constructor(width, height) {
    this.canvas = document.createElement("canvas");
    this.canvas.width = Math.round(width * PX_PER_M);
    this.canvas.height = Math.round(height * PX_PER_M);
    this.pen = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
    this.texture = new THREE.CanvasTexture(this.canvas);
    const material = new THREE.MeshBasicMaterial({ map: this.texture, transparent: true, depthTest: false, toneMapped: false });
    this.mesh = new THREE.Mesh(new THREE.PlaneGeometry(width, height), material);
    this.mesh.renderOrder = 20;
    this.mesh.visible = false;
    this.shown = "";
  }

  /**
   * Show something, or nothing.
   * @param {any} what null hides the sheet @param {(sheet: Sheet, what: any) => void} draw
   */
  show(what, draw) {
    this.mesh.visible = what !== null;
    const key = JSON.stringify(what);
    if (what === null || key === this.shown) return;
    this.shown = key;
    const { width, height } = this.canvas;
    this.pen.clearRect(0, 0, width, height);
    this.pen.fillStyle = "rgb(255 255 255 / 92%)";
    this.pen.beginPath();
    this.pen.roundRect(0, 0, width, height, 28);
    this.pen.fill();
    draw(this, what);
    this.texture.needsUpdate = true;
  }

  /**
   * Write words within the sheet, broken into lines.
   * @param {string} text @param {number} top [pixels] @param {number} size of the letters [pixels]
   * @param {{weight?: number, colour?: string, left?: number, right?: number, align?: CanvasTextAlign}} [style]
   * @returns the top of what comes below [pixels]
   */
  write(text, top, size, { weight = 400, colour = INK, left = MARGIN_PX, right = this.canvas.width - MARGIN_PX, align = "left" } = {}) {
    const pen = this.pen;
    pen.font = `${weight} ${size}px ${FONT}`;
    pen.fillStyle = colour;
    pen.textAlign = align;
    pen.textBaseline = "top";
    const at = align === "center" ? (left + right) / 2 : align === "right" ? right : left;
    for (const line of broken(pen, text, right - left)) {
      pen.fillText(line, at, top);
      top += size * LINE;
    }
    return top;
  }

  /**
   * Write a row of hints: the name of a button, and what it does.
   * @param {[string, string][]} hints @param {number} top [pixels] @param {number} size [pixels]
   * @returns the top of what comes below [pixels]
   */
  hints(hints, top, size) {
    const pen = this.pen;
    let x = MARGIN_PX;
    pen.textBaseline = "top";
    pen.textAlign = "left";
    for (const [button, words] of hints) {
      pen.font = `600 ${size * 0.82}px ${FONT}`;
      const key = pen.measureText(button).width + size * 0.7;
      pen.font = `400 ${size}px ${FONT}`;
      const wide = key + size * 0.35 + pen.measureText(words).width;
      if (x > MARGIN_PX && x + wide > this.canvas.width - MARGIN_PX) [x, top] = [MARGIN_PX, top + size * 1.5];
      pen.fillStyle = "#eef1f4";
      pen.strokeStyle = "#9aa3ad";
      pen.lineWidth = 2;
      pen.beginPath();
      pen.roundRect(x, top - size * 0.1, key, size * 1.25, 10);
      pen.fill();
      pen.stroke();
      pen.fillStyle = INK;
      pen.font = `600 ${size * 0.82}px ${FONT}`;
      pen.fillText(button, x + size * 0.35, top + size * 0.1);
      pen.font = `400 ${size}px ${FONT}`;
      pen.fillText(words, x + key + size * 0.35, top);
      x += wide + size * 0.9;
    }
    return top + size * 1.5;
  }

  /** Free what the graphics card keeps. */
  dispose() {
    this.texture.dispose();
    this.mesh.geometry.dispose();
    /** @type {THREE.Material} */ (this.mesh.material).dispose();
  }
}

/** @param {CanvasRenderingContext2D} pen @param {string} text @param {number} width [pixels] */
function broken(pen, text, width) {
  const lines = [];
  let line = "";
  for (const word of text.split(" ")) {
    const longer = line ? `${line} ${word}` : word;
    if (line && pen.measureText(longer).width > width) {
      lines.push(line);
      line = word;
    } else line = longer;
  }
  return line ? [...lines, line] : lines;
}
