// A dark edge of the picture, which keeps people well while they are moved without walking.

import * as THREE from "three";

/** A ring in front of the eyes; the uniform `strength`, 0 to 1, says how dark it is. */
export function vignette() {
  const material = new THREE.ShaderMaterial({
    transparent: true,
    depthTest: false,
    depthWrite: false,
    uniforms: { strength: { value: 0 } },
    vertexShader: `varying vec2 at; void main() {
      at = position.xy; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: `varying vec2 at; uniform float strength; void main() {
      gl_FragColor = vec4(0.0, 0.0, 0.0, 0.8 * strength * smoothstep(0.55, 1.3, length(at))); }`,
  });
  const mesh = new THREE.Mesh(new THREE.RingGeometry(0.5, 5, 48, 1), material);
  mesh.position.z = -1;
  mesh.renderOrder = 10;
  return mesh;
}
