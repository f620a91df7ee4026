// Where a body looks from, and how much of the house a person sees on screen.

export const FOV = 66; // [degrees], vertical

/**
 * Put a camera where an eye is.
 * @param {import("three").PerspectiveCamera} camera @param {number[]} eye [m] @param {number} yaw @param {number} pitch
 */
export function lookFrom(camera, [x, y, z], yaw, pitch) {
  const flat = Math.cos(pitch);
  camera.position.set(x, y, z);
  camera.lookAt(x + flat * Math.cos(yaw), y + flat * Math.sin(yaw), z + Math.sin(pitch));
}
