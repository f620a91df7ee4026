// The house on screen: two meshes, one of them of glass, which are drawn with one call each.
//
// Every corner knows which part it moves with, and the pose of each part is in a small texture. The light of what stands
// still is in its colours; what moves is lit by the probes of the place where it is.

import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const SIDE_PX = 256;
const STILL = -1;
const NONE = -2;
const CEILING = -3;
const LIT = -1; // the light of a part whose colours have it already
const AMBIENT = 0.39; // the light from all sides, as in the baked light
const FILL = [0.35, 0.55, -0.6];
const FOLLOW_PER_S = 22; // how fast a part goes to where the server says it is
const JUMP_M = 1.0;

const VERTEX = /* glsl */ `
in vec4 tint;
in float layer;
in float part;
uniform sampler2D poses;
uniform vec2 hidden;
uniform float roofed;
out vec3 mapped;
out vec4 shade;

vec3 turned(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }

void main() {
  vec3 place = position;
  vec3 light = vec3(1.0);
  if (part >= 0.0) {
    vec4 where = texelFetch(poses, ivec2(0, int(part)), 0);
    vec4 turn = texelFetch(poses, ivec2(1, int(part)), 0);
    place = turned(turn, position) + where.xyz;
    vec3 facing = turned(turn, normal);
    float fill = 0.1 * max(0.0, -dot(facing, normalize(vec3(${FILL.join(", ")}))));
    vec3 lamps = where.w * (0.52 + 0.48 * facing.z) * vec3(1.0, 0.97, 0.9);
    if (where.w >= 0.0) light = vec3(${AMBIENT} + fill) + lamps;
  }
  vec3 lit = tint.rgb * 2.0 * light;
  float most = layer < 0.0 ? 1.0 : max(1.0, max(lit.r, max(lit.g, lit.b)));
  shade = vec4(lit / most, tint.a); // no brighter than the texture, as in OpenGL
  mapped = vec3(uv, layer);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(place, 1.0);
  bool gone = part >= 0.0 ? part == hidden.x || part == hidden.y : roofed < 0.5 && part == ${CEILING.toFixed(1)};
  if (gone) gl_Position = vec4(0.0, 0.0, -2.0, 1.0); // outside
}`;

const FRAGMENT = /* glsl */ `
precision highp float;
precision highp sampler2DArray;
uniform sampler2DArray pictures;
in vec3 mapped;
in vec4 shade;
out vec4 colour;
void main() {
  vec3 seen = mapped.z < 0.0 ? vec3(1.0) : texture(pictures, vec3(mapped.xy, floor(mapped.z + 0.5))).rgb;
  colour = vec4(seen * shade.rgb, shade.a);
}`;

/** A house, and everything that moves in it. */
export class House {
  /**
   * Load the file of a house.
   * @param {string} url @param {number[]} own the parts of the person's own body, which they do not see
   */
  static async load(url, own) {
    const file = await new GLTFLoader().loadAsync(url);
    return new House(file, new Set(own));
  }

  /** The house of a file that is there already. @param {ArrayBuffer} data */
  static async parse(data) {
    return new House(await new GLTFLoader().parseAsync(data, ""), new Set());
  }

  /** @param {any} file @param {Set<number>} own */
  constructor(file, own) {
    const extras = file.scene.userData;
    /** The id of the thing that each part belongs to. @type {string[]} */
    this.owners = extras.moving;
    this.probes = extras.probes;
    const count = Math.max(1, this.owners.length);
    this.poses = new Float32Array(count * 8);
    for (let k = 0; k < count; k += 1) {
      this.poses[8 * k + 2] = -100;
      this.poses[8 * k + 7] = 1;
    }
    this.texture = new THREE.DataTexture(this.poses, 2, count, THREE.RGBAFormat, THREE.FloatType);
    /** Where the server says that each part is. @type {Map<number, {position: number[], turn: number[]}>} */
    this.places = new Map();
    /** The parts that are not there yet. @type {Set<number>} */
    this.moving = new Set();
    /** The parts whose light is in their colours. @type {Set<number>} */
    this.lit = new Set();
    const pictures = new Pictures();
    const heaps = [new Heap(), new Heap()];
    file.scene.traverse((/** @type {any} */ node) => {
      if (!node.isMesh) return;
      const { part, lit } = aboutPart(node);
      if (lit) this.lit.add(part);
      if (own.has(part)) return;
      const glass = node.material.opacity < 0.99;
      heaps[glass ? 1 : 0].add(node.geometry, pictures.layer(node.material.map), part, node.material.opacity);
    });
    this.pictures = pictures.texture();
    this.hidden = new THREE.Vector2(NONE, NONE);
    /** Whether ceilings are drawn, 1 or 0. */
    this.roofed = { value: 1 };
    const uniforms = {
      poses: { value: this.texture },
      pictures: { value: this.pictures },
      hidden: { value: this.hidden },
      roofed: this.roofed,
    };
    const solid = { glslVersion: THREE.GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms };
    const glass = { ...solid, transparent: true, depthWrite: false, side: THREE.DoubleSide };
    this.group = new THREE.Group();
    [new THREE.ShaderMaterial(solid), new THREE.ShaderMaterial(glass)].forEach((material, k) => {
      if (heaps[k].corners === 0) return;
      const mesh = new THREE.Mesh(heaps[k].geometry(), material);
      mesh.frustumCulled = false;
      mesh.renderOrder = k;
      this.group.add(mesh);
    });
  }

  /** The number of the part of a thing, -1 for none. @param {string} owner */
  numberOf(owner) {
    return this.owners.indexOf(owner);
  }

  /** Free what the graphics card keeps of the house. */
  dispose() {
    for (const one of this.group.children) {
      const mesh = /** @type {THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial>} */ (one);
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
    this.pictures.dispose();
    this.texture.dispose();
  }

  /** Hide the body and the head of one seat, and of nobody else. @param {number[]} own */
  hide(own) {
    this.hidden.set(own[0] ?? NONE, own[1] ?? NONE);
  }

  /** Where a part is on screen: position [m] and quaternion (x, y, z, w). @param {number} number */
  poseOf(number) {
    const row = [...this.poses.subarray(8 * number, 8 * number + 8)];
    return { position: row.slice(0, 3), turn: row.slice(4) };
  }

  /** Take where parts are. @param {import("./wire.js").Moved[]} moved */
  move(moved) {
    for (const { number, position, turn } of moved) {
      this.places.set(number, { position, turn });
      this.moving.add(number);
    }
  }

  /** Put parts where they are, at once. @param {import("./wire.js").Moved[]} moved */
  put(moved) {
    for (const place of moved) this.#follow(place.number, place, 1);
    this.texture.needsUpdate = true;
  }

  /**
   * Move every part towards where it is; what is in the person's hand goes there at once.
   * @param {number} seconds
   * @param {{number: number, position: number[], turn: number[]} | null} [held] the part in hand, and where it is shown
   */
  step(seconds, held = null) {
    const share = 1 - Math.exp(-FOLLOW_PER_S * seconds);
    for (const number of this.moving) {
      const place = /** @type {{position: number[], turn: number[]}} */ (this.places.get(number));
      if (this.#follow(number, place, share)) this.moving.delete(number);
    }
    if (held) {
      this.#follow(held.number, held, 1);
      this.moving.add(held.number); // once let go, it goes to where the server says
    }
    this.texture.needsUpdate = true;
  }

  /**
   * @param {number} number @param {{position: number[], turn: number[]}} goal @param {number} share
   * @returns whether the part has arrived
   */
  #follow(number, goal, share) {
    const at = 8 * number;
    const row = this.poses;
    const gap = Math.hypot(...goal.position.map((value, k) => value - row[at + k]));
    const sign = goal.turn.reduce((sum, value, k) => sum + value * row[at + 4 + k], 0) < 0 ? -1 : 1;
    const now = gap > JUMP_M ? 1 : share;
    for (let k = 0; k < 3; k += 1) row[at + k] += now * (goal.position[k] - row[at + k]);
    for (let k = 0; k < 4; k += 1) row[at + 4 + k] += now * (sign * goal.turn[k] - row[at + 4 + k]);
    const length = Math.hypot(row[at + 4], row[at + 5], row[at + 6], row[at + 7]) || 1;
    for (let k = 4; k < 8; k += 1) row[at + k] /= length;
    row[at + 3] = this.lit.has(number) ? LIT : this.#light(row[at], row[at + 1]);
    return now === 1 || gap < 5e-4;
  }

  /** The light of the lamps at a place. @param {number} x @param {number} y */
  #light(x, y) {
    const { origin, side, light } = this.probes;
    const row = light[Math.min(light.length - 1, Math.max(0, Math.round((y - origin[1]) / side)))];
    return row[Math.min(row.length - 1, Math.max(0, Math.round((x - origin[0]) / side)))];
  }
}

/** The number of the part that a mesh belongs to, and whether it has its light. @param {any} node */
function aboutPart(node) {
  for (let one = node; one !== null; one = one.parent) {
    const { part, lit, ceiling } = one.userData;
    if (part !== undefined) return { part, lit };
    if (ceiling) return { part: CEILING, lit: true };
  }
  return { part: STILL, lit: true };
}

/** The pictures of all materials as the layers of one texture. */
class Pictures {
  constructor() {
    /** @type {Map<any, number>} */
    this.known = new Map();
  }

  /** The layer of a texture, -1 without one. @param {any} map */
  layer(map) {
    if (!map) return -1;
    if (!this.known.has(map.image)) this.known.set(map.image, this.known.size);
    return /** @type {number} */ (this.known.get(map.image));
  }

  texture() {
    const canvas = new OffscreenCanvas(SIDE_PX, SIDE_PX);
    const pen = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext("2d", { willReadFrequently: true }));
    const size = SIDE_PX * SIDE_PX * 4;
    const data = new Uint8Array(size * Math.max(1, this.known.size));
    for (const [image, layer] of this.known) {
      pen.drawImage(image, 0, 0, SIDE_PX, SIDE_PX);
      data.set(pen.getImageData(0, 0, SIDE_PX, SIDE_PX).data, layer * size);
    }
    const made = new THREE.DataArrayTexture(data, SIDE_PX, SIDE_PX, Math.max(1, this.known.size));
    made.wrapS = made.wrapT = THREE.RepeatWrapping;
    made.minFilter = THREE.LinearMipmapLinearFilter;
    made.magFilter = THREE.LinearFilter;
    made.generateMipmaps = true;
    made.anisotropy = 4;
    made.needsUpdate = true;
    return made;
  }
}

/** Meshes that become one. */
class Heap {
  constructor() {
    /** @type {{source: THREE.BufferGeometry, layer: number, part: number, alpha: number}[]} */
    this.meshes = [];
    this.corners = this.indices = 0;
  }

  /** @param {THREE.BufferGeometry} source @param {number} layer @param {number} part @param {number} alpha */
  add(source, layer, part, alpha) {
    this.meshes.push({ source, layer, part, alpha });
    this.corners += source.attributes.position.count;
    this.indices += /** @type {THREE.BufferAttribute} */ (source.index).count;
  }

  geometry() {
    const count = this.corners;
    const position = new Float32Array(3 * count);
    const normal = new Int8Array(3 * count);
    const uv = new Float32Array(2 * count);
    const tint = new Uint8Array(4 * count);
    const layer = new Int16Array(count);
    const part = new Int16Array(count);
    const index = new Uint32Array(this.indices);
    let first = 0;
    let next = 0;
    for (const one of this.meshes) {
      const { position: places, normal: normals, uv: mapped, color } = one.source.attributes;
      const corners = places.count;
      const indices = /** @type {THREE.BufferAttribute} */ (one.source.index).array;
      for (let k = 0; k < indices.length; k += 1) index[next + k] = indices[k] + first;
      for (let k = 0; k < corners; k += 1) {
        const to = first + k;
        for (let a = 0; a < 3; a += 1) {
          position[3 * to + a] = places.getComponent(k, a);
          normal[3 * to + a] = Math.round(127 * normals.getComponent(k, a));
          tint[4 * to + a] = Math.round(255 * color.getComponent(k, a));
        }
        tint[4 * to + 3] = Math.round(255 * one.alpha);
        if (mapped) {
          uv[2 * to] = mapped.getX(k);
          uv[2 * to + 1] = mapped.getY(k);
        }
      }
      layer.fill(one.layer, first, first + corners);
      part.fill(one.part, first, first + corners);
      first += corners;
      next += indices.length;
    }
    this.meshes = [];
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(position, 3));
    made.setAttribute("normal", new THREE.BufferAttribute(normal, 3, true));
    made.setAttribute("uv", new THREE.BufferAttribute(uv, 2));
    made.setAttribute("tint", new THREE.BufferAttribute(tint, 4, true));
    made.setAttribute("layer", new THREE.BufferAttribute(layer, 1));
    made.setAttribute("part", new THREE.BufferAttribute(part, 1));
    made.setIndex(new THREE.BufferAttribute(index, 1));
    return made;
  }
}

const WAVES = [[4.1922, 5.6681], [2.4572, 5.7528], [2.7634, 3.9486], [2.6545, 4.2953], [2.2449, 4.6216]];

/** The sky of hthor.world.rendering.scene.lights: clouds, and trees along the horizon. */
const SKY = /* glsl */ `
varying vec3 way;

float waves(vec2 at) {
  float total = 0.0;
  ${WAVES.map(([turn, shift], k) => {
    const scale = 1.7 ** k;
    const [x, y] = [scale * Math.cos(turn), scale * Math.sin(turn)];
    return `total += sin(dot(at, vec2(${x.toFixed(4)}, ${y.toFixed(4)})) + ${shift.toFixed(4)}) / ${(1 + k).toFixed(1)};`;
  }).join("\n  ")}
  return total / 2.0;
}

void main() {
  vec3 to = normalize(way);
  float rise = to.z;
  float angle = atan(-to.y, to.x);
  vec3 colour = mix(vec3(0.86, 0.93, 0.98), vec3(0.36, 0.58, 0.86), pow(clamp(rise / 0.7, 0.0, 1.0), 0.6));
  vec3 cube = way / max(abs(way.x), max(abs(way.y), abs(way.z)));
  float clouds = waves(3.0 * vec2(cube.x, -cube.y) / (abs(cube.z) + 0.35));
  float veil = clamp(clouds - 0.15, 0.0, 0.8) * clamp(rise * 5.0, 0.0, 1.0);
  colour = mix(colour, vec3(1.0), 0.8 * veil);
  float crown = 0.055 + 0.03 * sin(7.0 * angle + 1.0) + 0.02 * sin(17.0 * angle) + 0.012 * sin(43.0 * angle + 2.0);
  vec3 leaves = vec3(0.38, 0.52, 0.30) * (1.0 + 0.12 * sin(60.0 * angle) * sin(130.0 * rise + 9.0 * angle));
  colour = mix(colour, leaves, clamp((crown - rise) * 90.0, 0.0, 1.0));
  gl_FragColor = vec4(mix(colour, vec3(0.52, 0.64, 0.36), clamp(-rise * 60.0, 0.0, 1.0)), 1.0);
}`;

/** What is outside: a lawn and the sky. */
export function outdoors() {
  const lawn = new THREE.Mesh(
    new THREE.CircleGeometry(80, 48),
    new THREE.MeshBasicMaterial({ color: new THREE.Color(0.52, 0.64, 0.36) }),
  );
  lawn.position.z = -0.06;
  const dome = new THREE.SphereGeometry(90, 24, 16);
  const sky = new THREE.ShaderMaterial({
    side: THREE.BackSide,
    depthWrite: false,
    vertexShader: `varying vec3 way; void main() {
      vec4 at = modelMatrix * vec4(position, 1.0);
      way = at.xyz - cameraPosition;
      gl_Position = projectionMatrix * viewMatrix * at; }`,
    fragmentShader: SKY,
  });
  const group = new THREE.Group();
  const above = new THREE.Mesh(dome, sky);
  above.renderOrder = -1;
  group.add(above, lawn);
  return group;
}
