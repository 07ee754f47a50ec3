// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the view asks of a cloud, be it whole (cloud.ts) or of a run that goes on (live_cloud.ts), and what both are made
// of.
import { BufferAttribute, BufferGeometry, Group, InterleavedBuffer, InterleavedBufferAttribute, Matrix4, Points, Sphere, Vector2, Vector3,
  type PerspectiveCamera } from 'three';
import type { CloudMaterial } from './cloud_material';
import { POINT, type Poses, type TilePoints } from './protocol';

export const STEPS = 65536;        // of a place, in the edge of its cube
const FLATTEST = 0.5;              // m, of the heights that colours are spread over

/** In a point's last number. */
const MOVES = 256, NO_INTENSITY = 512;

/** A point that was found, in the map's frame. */
export interface FoundPoint { p: Vector3; moment: number; keyframe: number; intensity: number | null; moving: boolean; }

/** Of most points, about the origin: m, and the heading (rad) in which they reach farthest, with how far along it, across
    it and up. */
export interface Extent { middle: Vector3; size: number; heading: number; reach: Vector3; }

export interface ShownCloud {
  readonly group: Group;
  readonly look: CloudMaterial;
  /** In the map's frame, m, of the origin that everything is drawn from. */
  readonly origin: Vector3;
  drawn: number;
  missing: number;
  extent: Extent | null;
  /** Lowest and highest of most points, m in the map's frame. */
  readonly heights: [number, number];
  /** Shows what is to be seen from there; returns whether anything on the screen is another. */
  update(camera: PerspectiveCamera, height: number, apart: number, budget: number): boolean;
  /** Returns whether the extent is another. */
  take(tile: TilePoints): boolean;
  /** What was asked for will not come: the line was lost. */
  askAgain(): void;
  /** Keyframes are elsewhere than when their points were tiled. */
  correct(poses: Poses): void;
  /** The points of one keyframe alone, by its position, or those of two in two colours; none: of all. */
  showOnly(keyframes: number[]): void;
  /** The point nearest to the eye among those within some pixels of a place on the screen. */
  find(camera: PerspectiveCamera, width: number, height: number, x: number, y: number, within: number): FoundPoint | null;
  dispose(): void;
}

/** Points of a message, drawn with that look; `matrix` takes their places to the origin's axes. `spacing` tells of each
    how far apart it is from its neighbours (spacing.ts). */
export function pointsOf(tile: TilePoints, look: CloudMaterial, matrix: Matrix4, spacing = new Uint8Array(tile.count)): Points {
  const buffer = new InterleavedBuffer(tile.values, POINT);
  const geometry = new BufferGeometry();
  geometry.setAttribute('place', new InterleavedBufferAttribute(buffer, 3, 0));
  geometry.setAttribute('facts', new InterleavedBufferAttribute(buffer, 3, 3));
  geometry.setAttribute('spacing', new BufferAttribute(spacing, 1));
  if (tile.colours) geometry.setAttribute('own', new BufferAttribute(tile.colours, 3, true));
  geometry.setDrawRange(0, tile.count);
  geometry.boundingSphere = new Sphere(new Vector3(), Infinity);
  const points = new Points(geometry, look.material);
  points.frustumCulled = false;
  points.matrixAutoUpdate = false;
  points.matrix.copy(matrix);
  return points;
}

export interface Part { values: Uint16Array; count: number; matrix: Matrix4; }
export interface Aim { camera: PerspectiveCamera; width: number; height: number; x: number; y: number; within: number; }

/** About the origin. `moved` takes a point from where its keyframe was to where that is now. */
export function nearestPoint(parts: Iterable<Part>, look: CloudMaterial, aim: Aim,
                             moved: (p: Vector3, keyframe: number) => void): FoundPoint | null {
  const { camera, width, height, x, y, within } = aim;
  const e = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
  const until = look.get<number>('until'), hideMoving = look.get<boolean>('hideMoving');
  const only = look.get<number>('only'), other = look.get<number>('other');
  const p = new Vector3();
  let best: FoundPoint | null = null, least = Infinity;
  for (const { values, count, matrix } of parts) {
    for (let i = 0; i < POINT * count; i += POINT) {
      if (values[i + 3] > until || (hideMoving && (values[i + 5] & MOVES) !== 0) || (only >= 0 && values[i + 4] !== only && values[i + 4] !== other)) continue;
      p.set(values[i] + 0.5, values[i + 1] + 0.5, values[i + 2] + 0.5).applyMatrix4(matrix);
      moved(p, values[i + 4]);
      const w = e[3] * p.x + e[7] * p.y + e[11] * p.z + e[15];
      if (w <= camera.near || w > least) continue;
      const dx = (0.5 + 0.5 * (e[0] * p.x + e[4] * p.y + e[8] * p.z + e[12]) / w) * width - x;
      const dy = (0.5 - 0.5 * (e[1] * p.x + e[5] * p.y + e[9] * p.z + e[13]) / w) * height - y;
      if (dx * dx + dy * dy > within * within) continue;
      if (!look.inBox(p)) continue;
      // The nearest to the eye, and of those on one surface the nearest to the finger.
      const rank = w * (1 + 0.3 * (dx * dx + dy * dy) / (within * within));
      if (rank < least) {
        least = rank;
        best = { p: p.clone(), moment: values[i + 3], keyframe: values[i + 4],
          intensity: (values[i + 5] & NO_INTENSITY) !== 0 ? null : values[i + 5] & 255, moving: (values[i + 5] & MOVES) !== 0 };
      }
    }
  }
  return best;
}

/** Of points whose x, y and z are listed apart; the look gets the heights. */
export function extentOf([xs, ys, zs]: [Float64Array, Float64Array, Float64Array], look: CloudMaterial): Extent {
  const heading = headingOf(xs, ys);
  const c = Math.cos(heading), s = Math.sin(heading);
  const along = mostOf(xs.map((x, i) => c * x + s * ys[i])), across = mostOf(xs.map((x, i) => c * ys[i] - s * x));
  const [lowest, highest] = mostOf(zs);
  look.get<Vector2>('heights').set(lowest, Math.max(highest, lowest + FLATTEST));
  const u = 0.5 * (along[0] + along[1]), v = 0.5 * (across[0] + across[1]);
  const reach = new Vector3(along[1] - along[0], across[1] - across[0], highest - lowest);
  return { middle: new Vector3(c * u - s * v, s * u + c * v, 0.5 * (lowest + highest)), size: reach.length(), heading, reach };
}

function mostOf(all: Float64Array): [number, number] {
  const sorted = all.slice().sort();
  return [sorted[Math.floor(0.02 * sorted.length)] ?? 0, sorted[Math.floor(0.98 * (sorted.length - 1))] ?? 1];
}

/** Of the longer axis of their spread. */
function headingOf(xs: Float64Array, ys: Float64Array): number {
  const mean = (all: Float64Array): number => all.reduce((sum, one) => sum + one, 0) / Math.max(1, all.length);
  const mx = mean(xs), my = mean(ys);
  let xx = 0, xy = 0, yy = 0;
  for (let i = 0; i < xs.length; ++i) {
    xx += (xs[i] - mx) ** 2;
    xy += (xs[i] - mx) * (ys[i] - my);
    yy += (ys[i] - my) ** 2;
  }
  return 0.5 * Math.atan2(2 * xy, xx - yy);
}
