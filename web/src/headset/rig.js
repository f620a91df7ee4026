// Where the room of a person with a headset is in the house. It moves as they walk by stick, and turns about their head.

import * as THREE from "three";

const FOLLOW_PER_S = 5; // how fast the body follows a step that the person takes in their room
const STILL_M = 0.04; // a head that is no farther from the body sways
const APART_M = 0.4; // how far the head can be from the body, as when somebody leans over a table
const STEEP = 0.95; // of a direction that is nearly straight up or down

/** The room, and the head in it. */
export class Rig {
  constructor() {
    /** In the frame of the house. */
    this.group = new THREE.Group();
    /** In the frame of the headset, whose y axis points up. */
    this.room = new THREE.Group();
    this.room.rotation.x = Math.PI / 2;
    this.group.add(this.room);
    /** The head in the house [m], and where it looks [rad]. */
    this.head = { x: 0, y: 0, z: 0, yaw: 0, pitch: 0 };
    /** The velocity [m/s] with which the body follows a step in the room. */
    this.step = { x: 0, y: 0 };
    /** Where the body was in the last picture [m]. */
    this.body = { x: 0, y: 0 };
    this.pose = new THREE.Matrix4();
  }

  /** Take where the head is in the room. @param {THREE.Matrix4} pose */
  look(pose) {
    this.pose.copy(pose);
    this.group.updateMatrixWorld(true);
    const place = new THREE.Matrix4().multiplyMatrices(this.room.matrixWorld, pose);
    const e = place.elements;
    const [x, y, z] = [-e[8], -e[9], -e[10]];
    // who looks straight down has the top of their head ahead, and who looks straight up the back of it behind
    const [ahead, aside] = Math.abs(z) < STEEP ? [x, y] : z < 0 ? [e[4], e[5]] : [-e[4], -e[5]];
    const [yaw, pitch] = [Math.atan2(aside, ahead), Math.asin(Math.max(-1, Math.min(1, z)))];
    this.head = { x: e[12], y: e[13], z: e[14], yaw, pitch };
  }

  /** Turn the room about the head. @param {number} angle [rad] */
  turn(angle) {
    const { x, y } = this.head;
    const { position, rotation } = this.group;
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const [dx, dy] = [position.x - x, position.y - y];
    position.set(x + cos * dx - sin * dy, y + sin * dx + cos * dy, position.z);
    rotation.z += angle;
    this.look(this.pose);
  }

  /** Put the room where the head is at a place and looks along a heading. @param {number} x @param {number} y @param {number} yaw */
  stand(x, y, yaw) {
    this.turn(yaw - this.head.yaw);
    this.group.position.x += x - this.head.x;
    this.group.position.y += y - this.head.y;
    this.body = { x, y };
    this.look(this.pose);
  }

  /** Raise the room until the eyes are at a height [m]. @param {number} height */
  raise(height) {
    this.group.position.z += height - this.head.z;
    this.look(this.pose);
  }

  /**
   * The steering: what the stick says, and steps in the room, which the body follows.
   * @param {{forward: number, left: number}} stick each -1 to 1
   * @param {number} speed [m/s], at most
   * @param {{x: number, y: number}} body
   * @returns {import("../wire.js").Drive}
   */
  drive(stick, speed, body) {
    const { yaw, pitch } = this.head;
    const [dx, dy] = [this.head.x - body.x, this.head.y - body.y];
    const follow = Math.hypot(dx, dy) > STILL_M ? FOLLOW_PER_S : 0;
    const [cos, sin] = [Math.cos(yaw), Math.sin(yaw)];
    const forward = speed * stick.forward + follow * (cos * dx + sin * dy);
    const left = speed * stick.left + follow * (cos * dy - sin * dx);
    const scale = Math.min(1, speed / Math.max(1e-9, Math.hypot(forward, left)));
    this.step = { x: scale * follow * dx, y: scale * follow * dy };
    return { forward: scale * forward, left: scale * left, yaw, pitch };
  }

  /**
   * Take the room along with the body, less what the body only followed.
   * @param {{x: number, y: number}} body where it is now [m] @param {number} seconds since the last picture
   * @param {number} share of the steering that the house let through, 0 to 1
   */
  follow({ x, y }, seconds, share) {
    const { position } = this.group;
    position.x += x - this.body.x - share * seconds * this.step.x;
    position.y += y - this.body.y - share * seconds * this.step.y;
    this.body = { x, y };
    this.look(this.pose);
    const [dx, dy] = [this.head.x - x, this.head.y - y];
    const apart = Math.hypot(dx, dy);
    if (apart > APART_M) {
      position.x -= dx * (1 - APART_M / apart);
      position.y -= dy * (1 - APART_M / apart);
      this.look(this.pose);
    }
  }
}
