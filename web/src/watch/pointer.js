// Mouse, fingers and the wheel over the house.

const TURN_PER_PX = 0.005;
const ZOOM_PER_PX = 0.0012;

/**
 * @typedef {{turn: (yaw: number, pitch: number) => void, drag: (right: number, down: number) => void,
 *   zoom: (factor: number) => void}} Mover
 */

export class Pointer {
  /** @param {HTMLElement} place @param {Mover} mover */
  constructor(place, mover) {
    this.place = place;
    this.mover = mover;
    /** @type {Map<number, {x: number, y: number}>} */
    this.down = new Map();
    place.addEventListener("pointerdown", (event) => {
      place.setPointerCapture(event.pointerId);
      this.down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    place.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"]) {
      place.addEventListener(end, (event) => this.down.delete(/** @type {PointerEvent} */ (event).pointerId));
    }
    place.addEventListener("contextmenu", (event) => event.preventDefault());
    place.addEventListener("wheel", (event) => {
      event.preventDefault();
      const pixels = event.deltaMode === 0 ? event.deltaY : 30 * event.deltaY;
      this.mover.zoom(Math.exp(ZOOM_PER_PX * pixels));
    }, { passive: false });
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const before = this.down.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before.x, event.clientY - before.y];
    const high = this.place.clientHeight;
    if (this.down.size === 2) {
      const other = [...this.down].find(([id]) => id !== event.pointerId)?.[1] ?? before;
      const gap = (/** @type {{x: number, y: number}} */ at) => Math.hypot(at.x - other.x, at.y - other.y) || 1;
      this.mover.zoom(gap(before) / gap({ x: event.clientX, y: event.clientY }));
      this.mover.drag(dx / 2 / high, dy / 2 / high);
    } else if (event.shiftKey || event.buttons & 6) this.mover.drag(dx / high, dy / high);
    else this.mover.turn(-TURN_PER_PX * dx, -TURN_PER_PX * dy);
    this.down.set(event.pointerId, { x: event.clientX, y: event.clientY });
  }
}
