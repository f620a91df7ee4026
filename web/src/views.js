// What every seat of a trial sees, drawn from the house's file and the poses that a person's page gets too.

import * as THREE from "three";
import { FOV, lookFrom } from "./eye.js";
import { House, outdoors } from "./house.js";

const HEIGHT_PX = 200;
const ASPECT = 1.6; // of somebody's window, which the server does not know
const EVERY_MS = 200;

THREE.ColorManagement.enabled = false; // colours are computed as the pictures of hthor are

/** @typedef {{seat: string, height: number, own: number[], fov: [number, number] | null}} Eye */

/** Small pictures, one for each seat, which one renderer draws after another. */
export class Views {
  /** @param {HTMLElement} place where the pictures are shown */
  constructor(place) {
    this.place = place;
    const plain = new URLSearchParams(location.search).has("plain"); // for machines without graphics
    this.renderer = new THREE.WebGLRenderer({ antialias: !plain });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.camera = new THREE.PerspectiveCamera(FOV, ASPECT, 0.05, 200);
    this.camera.up.set(0, 0, 1);
    this.scene = new THREE.Scene();
    this.scene.add(outdoors());
    /** @type {House | null} */
    this.house = null;
    this.file = "";
    /** What moved before the house was there. @type {import("./wire.js").Moved[]} */
    this.early = [];
    /** @type {{eye: Eye, pen: CanvasRenderingContext2D}[]} */
    this.pictures = [];
    this.last = performance.now();
  }

  /** Show the seats of another trial. @param {string} file @param {Eye[]} eyes */
  async open(file, eyes) {
    if (this.house) this.scene.remove(this.house.group);
    this.house?.dispose();
    this.house = null;
    this.file = file;
    this.early = [];
    this.pictures = eyes.map((eye) => this.#picture(eye));
    this.place.replaceChildren(...this.pictures.map(({ pen }) => /** @type {Node} */ (pen.canvas.parentNode)));
    if (!file) return;
    const house = await House.load(file, []);
    if (this.file !== file || this.house) return;
    house.move(this.early);
    house.step(1);
    this.scene.add(house.group);
    this.house = house;
  }

  /** Take where parts are. @param {import("./wire.js").Moved[]} moved */
  take(moved) {
    if (this.house) this.house.move(moved);
    else this.early.push(...moved);
  }

  /** Draw all pictures, if it is time. @param {number} now [ms] */
  draw(now) {
    const seconds = (now - this.last) / 1000;
    if (this.house === null || 1000 * seconds < EVERY_MS) return;
    this.last = now;
    this.house.step(Math.min(0.25, seconds));
    for (const { eye, pen } of this.pictures) {
      if (!this.house.places.has(eye.own[0])) continue; // the trial has not begun
      this.#aim(this.house, eye);
      const { width, height } = pen.canvas;
      this.renderer.setSize(width, height, false);
      this.house.hide(eye.own);
      this.renderer.render(this.scene, this.camera);
      pen.drawImage(this.renderer.domElement, 0, 0);
    }
  }

  /** Draw no longer. */
  close() {
    this.place.replaceChildren();
    this.file = "";
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  /** Put the camera where the eye of a seat is. @param {House} house @param {Eye} eye */
  #aim(house, eye) {
    const [body, head] = eye.own.map((number) => house.poseOf(number));
    const [x, y, z] = new THREE.Vector3(1, 0, 0).applyQuaternion(new THREE.Quaternion(...head.turn)).toArray();
    lookFrom(this.camera, [body.position[0], body.position[1], eye.height], Math.atan2(y, x), Math.asin(z));
    this.camera.fov = eye.fov ? THREE.MathUtils.radToDeg(eye.fov[1]) : FOV;
    this.camera.aspect = aspect(eye);
    this.camera.updateProjectionMatrix();
  }

  /** The picture of a seat on the page. @param {Eye} eye */
  #picture(eye) {
    const canvas = document.createElement("canvas");
    canvas.width = Math.round(HEIGHT_PX * aspect(eye));
    canvas.height = HEIGHT_PX;
    canvas.dataset.seat = eye.seat;
    const figure = document.createElement("figure");
    const caption = document.createElement("figcaption");
    caption.textContent = eye.seat;
    figure.append(canvas, caption);
    return { eye, pen: /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d")) };
  }
}

/** How much wider than high a seat's picture is. @param {Eye} eye */
function aspect({ fov }) {
  return fov ? Math.tan(fov[0] / 2) / Math.tan(fov[1] / 2) : ASPECT;
}
