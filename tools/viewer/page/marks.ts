// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How large what is looked at is, and which way it lies: a scale bar, and north or the axes of the map.
import { Vector3, type PerspectiveCamera } from 'three';
import { axesOf, type Eye } from './controls';
import { element } from './elements';
import { SERIES, theme } from './palette';

export const MARKS_WIDTH = 240, MARKS_HEIGHT = 64;  // px
const LONGEST = 130;        // px, of the bar
const RADIUS = 21;          // px, of the compass
const FONT = '12px system-ui, "DejaVu Sans", sans-serif';
const HALO = 3;             // px

export interface MarksShown {
  metres: number;           // of the bar, at the distance of what is looked at
  pixels: number;
  /** What the directions are on the screen, of unit vectors: to the right and up. */
  north: [number, number] | null;
  east: [number, number] | null;
  axes: [number, number][]; // x, y, z of the map
}

/** 1, 2 or 5 times a power of ten, and no more than `most`. */
export function roundLength(most: number): number {
  const power = 10 ** Math.floor(Math.log10(most));
  return power * (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1);
}

export function lengthText(metres: number): string {
  const [value, unit] = metres >= 1000 ? [metres / 1000, 'km'] : metres >= 1 ? [metres, 'm']
      : metres >= 0.01 ? [metres * 100, 'cm'] : [metres * 1000, 'mm'];
  return `${Number(value.toPrecision(3))} ${unit}`;
}

export function marksOf(eye: Eye, camera: PerspectiveCamera, height: number, north: number[] | null): MarksShown {
  const metresPerPixel = 2 * eye.distance * Math.tan(0.5 * camera.fov * Math.PI / 180) / Math.max(1, height);
  const metres = roundLength(LONGEST * metresPerPixel);
  const { right, up } = axesOf(eye);
  const seen = (v: Vector3): [number, number] => [v.dot(right), v.dot(up)];
  const n = north ? new Vector3(...north) : null;
  return { metres, pixels: metres / metresPerPixel, north: n && seen(n),
    east: n && seen(n.clone().cross(new Vector3(0, 0, 1)).normalize()),
    axes: [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)].map(seen) };
}

/** Into MARKS_WIDTH x MARKS_HEIGHT px whose upper left corner is there. */
export function drawMarks(context: CanvasRenderingContext2D, marks: MarksShown, left: number, top: number): void {
  const colours = theme();
  context.save();
  context.translate(left, top);
  context.font = FONT;
  context.lineJoin = 'round';
  const compass = (): void => {
    context.translate(32, 32);
    if (marks.north && marks.east) drawNorth(context, marks.north, marks.east);
    else drawAxes(context, marks.axes);
  };
  context.save();
  compass();
  context.restore();
  const text = lengthText(marks.metres);
  write(context, text, 70 + 0.5 * marks.pixels, 34, 'center');
  for (const [ink, width] of [[colours.background, 2 + HALO], [colours.chosen, 2]] as const) {
    context.strokeStyle = ink;
    context.lineWidth = width;
    context.beginPath();
    context.moveTo(70, 40);
    context.lineTo(70, 47);
    context.lineTo(70 + marks.pixels, 47);
    context.lineTo(70 + marks.pixels, 40);
    context.stroke();
  }
  context.restore();
}

/** A needle that lies on the ground. */
function drawNorth(context: CanvasRenderingContext2D, north: [number, number], east: [number, number]): void {
  const colours = theme();
  const at = (n: number, e: number): [number, number] =>
      [RADIUS * (n * north[0] + e * east[0]), -RADIUS * (n * north[1] + e * east[1])];
  const outline = (...points: [number, number][]): void => {
    context.beginPath();
    points.forEach((p, i) => { if (i === 0) context.moveTo(...p); else context.lineTo(...p); });
    context.closePath();
  };
  outline(...Array.from({ length: 48 }, (_, i) => at(Math.cos(i * Math.PI / 24), Math.sin(i * Math.PI / 24))));
  context.globalAlpha = 0.7;
  context.fillStyle = colours.background;
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = colours.odometry;
  context.lineWidth = 1;
  context.stroke();
  for (const [end, hex] of [[-0.9, colours.odometry], [0.9, colours.trajectory]] as const) {
    outline(at(end, 0), at(0, 0.24), at(0, -0.24));
    context.fillStyle = hex;
    context.fill();
    context.strokeStyle = hex;  // seen from its side it is a line
    context.stroke();
  }
  write(context, 'N', ...beyond(north), 'center');
}

function drawAxes(context: CanvasRenderingContext2D, axes: [number, number][]): void {
  const hexes = [SERIES[1], SERIES[2], SERIES[0]];
  const far = (i: number): number => Math.hypot(...axes[i]);
  for (const i of [0, 1, 2].sort((a, b) => far(a) - far(b))) {
    const [x, y] = axes[i];
    if (far(i) < 0.15) continue;  // it points at the eye
    context.strokeStyle = hexes[i];
    context.lineWidth = 2.5;
    context.beginPath();
    context.moveTo(0, 0);
    context.lineTo(0.85 * RADIUS * x, -0.85 * RADIUS * y);
    context.stroke();
    write(context, 'xyz'[i], ...beyond(axes[i]), 'center');
  }
}

/** Where the letter of a direction stands: the middle of its line of text. */
function beyond([x, y]: [number, number]): [number, number] {
  const length = Math.max(0.2, Math.hypot(x, y));
  const r = RADIUS * length + 7;
  return [r * x / length, -r * y / length + 4];
}

function write(context: CanvasRenderingContext2D, text: string, x: number, y: number, align: CanvasTextAlign): void {
  const colours = theme();
  context.textAlign = align;
  context.strokeStyle = colours.background;
  context.lineWidth = HALO;
  context.strokeText(text, x, y);
  context.fillStyle = colours.chosen;
  context.fillText(text, x, y);
}

export class Marks {
  shown: MarksShown | null = null;
  /** In the map's axes; null: the map has no place on the Earth. */
  north: number[] | null = null;
  private readonly canvas = element<HTMLCanvasElement>('marks');

  draw(eye: Eye, camera: PerspectiveCamera, height: number): void {
    const marks = marksOf(eye, camera, height, this.north);
    this.shown = marks;
    const ratio = Math.min(devicePixelRatio, 2);
    this.canvas.width = MARKS_WIDTH * ratio;
    this.canvas.height = MARKS_HEIGHT * ratio;
    const context = this.canvas.getContext('2d')!;
    context.scale(ratio, ratio);
    drawMarks(context, marks, 0, 0);
    const turned = marks.north ? Math.round(Math.atan2(...marks.north) * 180 / Math.PI) : 0;
    this.canvas.setAttribute('aria-label', `The bar is ${lengthText(marks.metres)} long` +
        (marks.north ? `; north is ${turned}° clockwise from up` : ''));
  }
}
