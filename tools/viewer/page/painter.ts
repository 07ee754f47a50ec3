// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Draws when there is something to draw: points, with or without eye-dome lighting, and what lies over them. While
// something moves there are only so many points that a frame is soon done.
import { ColorManagement, LinearSRGBColorSpace, PerspectiveCamera, Scene as Stage, WebGLRenderer } from 'three';
import type { Cloud } from './cloud';
import { EyeDome } from './eye_dome';
import { theme } from './palette';

const SLOW = 70, FAST = 28; // ms a frame while something moves: fewer points, or more
const LEAST = 100_000;      // points that are drawn however slow it is
const STILL = 250;          // ms without motion, then all points that are wanted
const KEPT_FRAMES = 200;

export interface Frame { seconds: number; moving: boolean; }

export class Painter {
  readonly camera = new PerspectiveCamera();
  readonly points = new Stage();
  readonly over = new Stage();
  /** ms, of the last frames that came one upon the other. */
  frames: number[] = [];
  private readonly renderer: WebGLRenderer;
  private readonly dome = new EyeDome();
  private inMotion = 1_000_000;
  private moved = -Infinity;
  private drawn = 0;
  private waiting = false;

  /** `before` is called with each frame and says whether something moves on; then another frame follows. */
  constructor(private readonly canvas: HTMLCanvasElement, private readonly before: (frame: Frame) => boolean) {
    ColorManagement.enabled = false;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: 'high-performance' });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.autoClear = false;
  }

  get width(): number { return this.canvas.clientWidth; }
  get height(): number { return this.canvas.clientHeight; }

  /** Something moves: until it is still, frames have to be quick. */
  motion(): void {
    this.moved = performance.now();
    this.draw();
  }

  get isStill(): boolean {
    return performance.now() - this.moved > STILL;
  }

  /** What is on the screen is what is to be seen. */
  get isIdle(): boolean {
    return this.isStill && !this.waiting;
  }

  draw(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame((now) => {
      this.waiting = false;
      const seconds = (now - this.drawn) / 1000;
      const goesOn = this.before({ seconds: Math.min(seconds, 0.5), moving: !this.isStill });
      if (seconds < 1) this.time(1000 * seconds);
      this.drawn = now;
      if (goesOn) this.motion();
      else if (!this.isStill) setTimeout(() => this.draw(), STILL + 10);
    });
  }

  budget(most: number): number {
    return this.isStill ? most : Math.min(most, this.inMotion);
  }

  paint(cloud: Cloud | null, shading: boolean): void {
    const colours = theme();
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(this.width, this.height, false);
    this.renderer.setClearColor(colours.background, 1);
    this.renderer.clear();
    if (cloud) {
      if (shading) this.dome.render(this.renderer, this.points, this.camera, colours.background);
      else this.renderer.render(this.points, this.camera);
    }
    this.renderer.clearDepth();
    this.renderer.render(this.over, this.camera);
  }

  private time(ms: number): void {
    this.frames.push(ms);
    if (this.frames.length > KEPT_FRAMES) this.frames.shift();
    if (this.isStill) return;
    if (ms > SLOW) this.inMotion = Math.max(LEAST, 0.8 * this.inMotion);
    else if (ms < FAST) this.inMotion = Math.min(20_000_000, 1.1 * this.inMotion);
  }
}
