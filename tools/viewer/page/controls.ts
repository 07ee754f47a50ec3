// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Mouse, fingers and keys: one turns about what is looked at, or flies. z is up.
import { PerspectiveCamera, Vector3 } from 'three';
import type { Extent } from './shown_cloud';

/** Where one looks from: metres from the cloud's origin, radians. */
export interface Eye { target: Vector3; distance: number; yaw: number; pitch: number; }

const STEEPEST = 1.5707;
const TURN = 0.006;         // rad a pixel
const CLICK = 5;            // pixels that a click may move
const NARROW = Math.tan(29 * Math.PI / 180);  // of half the field of view, of the window's narrower side
const PITCH = 0.9;          // rad, of the look at all of it
const ROOM = 1.15;          // about what is looked at
const MOVES: Record<string, [number, number, number]> = {  // right, forward, up
  KeyW: [0, 1, 0], ArrowUp: [0, 1, 0], KeyS: [0, -1, 0], ArrowDown: [0, -1, 0], KeyA: [-1, 0, 0], ArrowLeft: [-1, 0, 0],
  KeyD: [1, 0, 0], ArrowRight: [1, 0, 0], KeyE: [0, 0, 1], PageUp: [0, 0, 1], KeyQ: [0, 0, -1], PageDown: [0, 0, -1],
};

export function axesOf(eye: Eye): { back: Vector3; right: Vector3; up: Vector3 } {
  const flat = Math.cos(eye.pitch);
  const back = new Vector3(flat * Math.cos(eye.yaw), flat * Math.sin(eye.yaw), Math.sin(eye.pitch));
  const right = new Vector3(-Math.sin(eye.yaw), Math.cos(eye.yaw), 0);
  return { back, right, up: new Vector3().crossVectors(back, right) };
}

/** The longer side of what there is lies across the window, right of the panel that covers so many of its pixels. */
export function eyeOnAll(extent: Extent | null, size: number, width: number, height: number, panel: number): Eye {
  if (!extent) return { target: new Vector3(), distance: 0.95 * size, yaw: -0.6, pitch: PITCH };
  const { middle, heading, reach } = extent;
  const metre = Math.min(width, height) / (2 * NARROW);  // pixels of a metre, a metre away
  const free = width - panel > 0.4 * width ? panel : 0;
  const depth = Math.cos(PITCH) * reach.y + Math.sin(PITCH) * reach.z;
  const upright = Math.sin(PITCH) * reach.y + Math.cos(PITCH) * reach.z;
  const distance = Math.max(0.5, ROOM * metre * Math.max(reach.x / (width - free), upright / height)) + 0.5 * depth;
  const eye = { target: middle.clone(), distance, yaw: heading - 0.5 * Math.PI, pitch: PITCH };
  eye.target.addScaledVector(axesOf(eye).right, -0.5 * free * distance / metre);
  return eye;
}

export class Controls {
  eye: Eye = { target: new Vector3(), distance: 10, yaw: -0.6, pitch: 0.9 };
  size = 10;                // m, of what there is to see
  flying = false;
  /** Something is being moved by hand or key. */
  get busy(): boolean {
    return this.pointers.size > 0 || this.keys.size > 0 || performance.now() < this.busyUntil;
  }

  private readonly pointers = new Map<number, [number, number]>();
  private readonly keys = new Set<string>();
  private travelled = 0;
  private busyUntil = 0;

  constructor(private readonly canvas: HTMLCanvasElement, private readonly changed: () => void,
              private readonly clicked: (x: number, y: number) => void) {
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel'] as const) canvas.addEventListener(end, (event) => this.up(event));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    addEventListener('keydown', (event) => this.key(event, true));
    addEventListener('keyup', (event) => this.key(event, false));
    addEventListener('blur', () => this.keys.clear());
  }

  apply(camera: PerspectiveCamera, width: number, height: number): void {
    const { back, right, up } = axesOf(this.eye);
    camera.aspect = width / Math.max(height, 1);
    // The narrower side of the window sees the same, whichever it is.
    camera.fov = 2 * Math.atan(NARROW / Math.min(1, camera.aspect)) * 180 / Math.PI;
    camera.near = Math.max(this.eye.distance / 500, 0.02);
    camera.far = this.eye.distance + 6 * this.size;
    camera.up.copy(up);
    camera.position.copy(this.eye.target).addScaledVector(back, this.eye.distance);
    camera.matrixWorld.makeBasis(right, up, back).setPosition(camera.position);
    camera.matrixWorldInverse.copy(camera.matrixWorld).invert();
    camera.matrixAutoUpdate = camera.matrixWorldAutoUpdate = false;
    camera.updateProjectionMatrix();
  }

  /** Keys that are held move on. Returns whether there are any. */
  step(seconds: number): boolean {
    if (this.keys.size === 0) return false;
    const { back, right } = axesOf(this.eye);
    const forward = this.flying ? back.clone().negate() : new Vector3(-back.x, -back.y, 0).normalize();
    const metres = (this.flying ? Math.min(this.eye.distance, 15) : this.eye.distance) * 0.7 * Math.min(seconds, 0.2);
    for (const key of this.keys) {
      const [x, y, z] = MOVES[key];
      this.eye.target.addScaledVector(right, x * metres).addScaledVector(forward, y * metres);
      this.eye.target.z += z * metres;
    }
    this.changed();
    return true;
  }

  turn(dx: number, dy: number): void {
    const before = axesOf(this.eye).back;
    this.eye.yaw -= TURN * dx * (this.flying ? -0.5 : 1);
    this.eye.pitch = Math.max(-STEEPEST, Math.min(STEEPEST, this.eye.pitch + TURN * dy * (this.flying ? -0.5 : 1)));
    if (this.flying) {  // the eye stays
      this.eye.target.addScaledVector(before, this.eye.distance).addScaledVector(axesOf(this.eye).back, -this.eye.distance);
    }
  }

  shift(dx: number, dy: number): void {
    const { right, up } = axesOf(this.eye);
    const metres = 1.1 * this.eye.distance / Math.max(1, Math.min(this.canvas.clientHeight, this.canvas.clientWidth));
    this.eye.target.addScaledVector(right, -dx * metres).addScaledVector(up, dy * metres);
  }

  zoom(factor: number): void {
    this.eye.distance = Math.min(10 * this.size, Math.max(0.1, this.eye.distance * factor));
  }

  private down(event: PointerEvent): void {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (this.pointers.size === 1) this.travelled = 0;
  }

  private move(event: PointerEvent): void {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const dx = event.offsetX - before[0], dy = event.offsetY - before[1];
    this.travelled += Math.abs(dx) + Math.abs(dy);
    if (this.pointers.size === 2) {
      const other = [...this.pointers].find(([id]) => id !== event.pointerId)![1];
      const apart = (x: number, y: number) => Math.max(1, Math.hypot(x - other[0], y - other[1]));
      this.zoom(apart(...before) / apart(event.offsetX, event.offsetY));
      this.shift(0.5 * dx, 0.5 * dy);
    } else if (event.shiftKey || (event.buttons & 6) !== 0) this.shift(dx, dy);
    else this.turn(dx, dy);
    this.pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
    this.changed();
  }

  private up(event: PointerEvent): void {
    const isClick = event.type === 'pointerup' && this.pointers.size === 1 && this.travelled < CLICK;
    if (isClick) this.clicked(event.offsetX, event.offsetY);
    this.pointers.delete(event.pointerId);
    this.changed();
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    this.zoom(Math.exp(0.001 * Math.max(-400, Math.min(400, event.deltaY * (event.deltaMode === 1 ? 30 : 1)))));
    this.busyUntil = performance.now() + 200;
    this.changed();
  }

  private key(event: KeyboardEvent, down: boolean): void {
    const typing = event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement;
    if (!(event.code in MOVES)) return;
    if (down && !typing && !event.ctrlKey && !event.metaKey && !event.altKey) {
      this.keys.add(event.code);
      event.preventDefault();
      this.changed();
    } else this.keys.delete(event.code);
  }
}
