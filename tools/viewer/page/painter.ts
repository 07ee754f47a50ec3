// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Draws when there is something to draw: points, with or without eye-dome lighting, and what lies over them. While
// something moves there are only so many points that a frame is soon done.
import { ColorManagement, LinearSRGBColorSpace, PerspectiveCamera, Scene as Stage, WebGLRenderer } from 'three';
import { EyeDome } from './eye_dome';
import { theme } from './palette';
import type { ShownCloud } from './shown_cloud';

const SLOW = 70, FAST = 28; // ms a frame while something moves: fewer points, or more
const LEAST = 60_000;       // points that are drawn however slow it is
const MOST = 20_000_000;
const STILL = 250;          // ms without motion, then all points that are wanted
const LATER = 1000;         // ms
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
  private inMotion = 500_000;
  private moved = -Infinity;
  private begun = 0;          // the last frame
  private requested = 0;
  private waiting = false;
  private painted = 0;        // points
  private later = 0;          // timer

  /** `before` is called with each frame and says whether something moves on; then another frame follows. */
  constructor(private readonly canvas: HTMLCanvasElement, private readonly before: (frame: Frame) => boolean) {
    ColorManagement.enabled = false;
    this.renderer = new WebGLRenderer({ canvas, antialias: !isSoftware(), powerPreference: 'high-performance' });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.autoClear = false;
  }

  get width(): number { return this.canvas.clientWidth; }
  get height(): number { return this.canvas.clientHeight; }

  /** Something moves: until it is still, frames have to be quick. */
  motion(): void {
    this.moved = Infinity;    // until that frame is drawn, however late
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
    this.requested = performance.now();
    requestAnimationFrame(() => {
      this.waiting = false;
      const now = performance.now();
      const moving = !this.isStill;
      // A browser that is busy with the frame before begins this one late.
      this.time(now - Math.max(this.begun, this.requested), moving);
      const goesOn = this.before({ seconds: Math.min((now - this.begun) / 1000, 0.5), moving });
      this.begun = now;
      if (goesOn) this.motion();
      else if (this.moved === Infinity) {  // once a motion: frames in between do not put its end off
        this.moved = performance.now();
        setTimeout(() => this.draw(), STILL + 10);
      }
    });
  }

  /** What has changed can wait. */
  drawLater(): void {
    this.later ||= setTimeout(() => {
      this.later = 0;
      this.draw();
    }, LATER);
  }

  budget(most: number): number {
    return this.isStill ? most : Math.min(most, this.inMotion);
  }

  paint(cloud: ShownCloud | null, shading: boolean): void {
    const colours = theme();
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(this.width, this.height, false);
    this.renderer.setClearColor(colours.background, 1);
    this.renderer.clear();
    if (cloud) {
      this.painted = cloud.drawn;
      // Where even few points are slow, there is light and shade at rest alone.
      const shades = shading && (this.isStill || this.inMotion > 2 * LEAST);
      if (shades) this.dome.render(this.renderer, this.points, this.camera, colours.background);
      else this.renderer.render(this.points, this.camera);
    }
    this.renderer.clearDepth();
    this.renderer.render(this.over, this.camera);
  }

  private time(ms: number, moving: boolean): void {
    this.frames.push(ms);
    if (this.frames.length > KEPT_FRAMES) this.frames.shift();
    if (!moving) return;
    if (ms > SLOW) this.inMotion = Math.max(LEAST, Math.min(this.inMotion, this.painted) * Math.max(0.4, SLOW / ms));
    else if (ms < FAST) this.inMotion = Math.min(MOST, 1.1 * this.inMotion);
  }
}

/** The browser draws without a graphics card: smooth edges would cost a third of the time. */
function isSoftware(): boolean {
  const gl = document.createElement('canvas').getContext('webgl2');
  const named = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = gl && named ? String(gl.getParameter(named.UNMASKED_RENDERER_WEBGL)) : '';
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}
