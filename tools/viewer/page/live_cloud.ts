// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The cloud of a run that goes on: points of keyframes, which stay and move with them, and those of the newest sweep. Each
// is asked for only when what was asked for before has come, so that a slow line gets fewer.
import { Group, Matrix4, Vector2, Vector3, type PerspectiveCamera, type Points } from 'three';
import { poseMatrix } from './cloud';
import { CloudMaterial, COLOURS } from './cloud_material';
import { POINT, type Live, type PlacedClouds, type Poses, type Scene, type TilePoints } from './protocol';
import { extentOf, nearestPoint, pointsOf, STEPS, type Extent, type FoundPoint, type ShownCloud } from './shown_cloud';

const MOST_ASKED = 24;      // keyframes on their way at a time
const SAMPLED = 40;         // of so many points one tells the extent
const MEASURED = 500;       // ms between two times
const SHUFFLE = 7919;       // a prime beyond the points of a keyframe

interface Held { points: Points; values: Uint16Array; count: number; time: number; }

interface Placed { matrix: Matrix4; time: number; }

export class LiveCloud implements ShownCloud {
  readonly group = new Group();
  readonly look = new CloudMaterial();
  readonly origin: Vector3;
  drawn = 0;
  missing = 0;
  extent: Extent | null = null;
  private readonly sweepLook = new CloudMaterial();
  private placed = new Map<number, Placed>();
  private readonly held = new Map<number, Held>();
  private readonly asked = new Set<number>();
  private sweep: Points | null = null;
  private awaited: { number: number; matrix: Matrix4 } | null = null;
  private heldPoints = 0;
  private newest: PlacedClouds | null = null;
  private isNewest = true;    // what is shown
  private until = Infinity;   // s
  private measured = -Infinity;

  constructor(scene: Scene, private readonly ask: (tiles: number[]) => void) {
    this.origin = new Vector3(...scene.cube.low).addScalar(scene.cube.edge / 2);
    this.sweepLook.set('colourBy', COLOURS.indexOf('keyframe'));  // one colour, for there is no other keyframe
  }

  /** How many keyframes have points here. */
  get keyframes(): number {
    return this.held.size;
  }

  follow(live: Live): void {
    if (live.clouds) {
      this.placed = this.matrices(live.clouds);
      for (const [number, one] of [...this.held]) {
        const placed = this.placed.get(number);
        if (placed) {
          one.points.matrix.copy(placed.matrix);
          one.points.matrixWorldNeedsUpdate = true;
        } else this.drop(number, one);
      }
    }
    this.newest = live.newest ?? this.newest;
    this.askForNewest();
    this.askForMore();
  }

  /** What there was at a time (s), of which only keyframes are known; null: all, with the newest sweep. `grow`: keyframes
      that came later are not shown. */
  showAt(now: number | null, grow: boolean): void {
    const comesBack = now === null && !this.isNewest;
    this.isNewest = now === null;
    this.until = now === null || !grow ? Infinity : now;
    if (!this.isNewest) this.clearSweep();
    if (comesBack) this.askForNewest();
    for (const one of this.held.values()) one.points.visible = one.time <= this.until;
  }

  update(_camera: PerspectiveCamera, _height: number, _apart: number, budget: number): boolean {
    const share = Math.min(1, budget / Math.max(1, this.heldPoints));
    this.drawn = this.sweep?.geometry.drawRange.count ?? 0;
    for (const one of this.held.values()) {
      const count = Math.ceil(share * one.count);
      one.points.geometry.setDrawRange(0, count);
      if (one.points.visible) this.drawn += count;
    }
    this.missing = [...this.placed.keys()].filter((number) => !this.held.has(number)).length;
    for (const name of ['size', 'closeSize', 'mostSize', 'boxMiddle', 'boxHalf', 'boxTurn']) this.sweepLook.set(name, this.look.get(name));
    return true;
  }

  take(tile: TilePoints): boolean {
    if (tile.number === this.awaited?.number) {
      const { matrix } = this.awaited;
      this.awaited = null;
      if (tile.count === 0 || !this.isNewest) return false;
      this.clearSweep();
      this.sweep = pointsOf(tile, this.sweepLook, matrix);
      this.group.add(this.sweep);
      return false;
    }
    this.asked.delete(tile.number);
    const placed = this.placed.get(tile.number);
    if (placed && !this.held.has(tile.number)) {
      const shuffled = { ...tile, values: shuffle(tile) };
      const points = pointsOf(shuffled, this.look, placed.matrix);
      points.visible = placed.time <= this.until;
      this.group.add(points);
      this.held.set(tile.number, { points, values: shuffled.values, count: tile.count, time: placed.time });
      this.heldPoints += tile.count;
    }
    this.askForMore();
    return this.measure();
  }

  askAgain(): void {
    this.asked.clear();
    this.awaited = null;
  }

  correct(_poses: Poses): void {}  // the server says where points of keyframes are

  showOnly(_keyframes: number[]): void {}  // which keyframe a point is of is told once the run has ended

  get heights(): [number, number] {
    const { x, y } = this.look.get<Vector2>('heights');
    return [x + this.origin.z, y + this.origin.z];
  }

  find(camera: PerspectiveCamera, width: number, height: number, x: number, y: number, within: number): FoundPoint | null {
    const parts = [...this.held.values()].filter(({ points }) => points.visible).map(({ points, values, count }) => ({ values, count, matrix: points.matrix }));
    const found = nearestPoint(parts, this.look, { camera, width, height, x, y, within }, () => {});
    found?.p.add(this.origin);
    return found;
  }

  dispose(): void {
    for (const one of this.held.values()) one.points.geometry.dispose();
    this.clearSweep();
    this.look.material.dispose();
    this.sweepLook.material.dispose();
    this.group.clear();
  }

  private askForNewest(): void {
    if (!this.newest || this.awaited || !this.isNewest) return;
    const [[number, { matrix }]] = this.matrices(this.newest);
    this.awaited = { number, matrix };
    this.ask([number]);
  }

  private askForMore(): void {
    const next: number[] = [];
    for (const number of this.placed.keys()) {
      if (this.asked.size + next.length >= MOST_ASKED) break;
      if (!this.held.has(number) && !this.asked.has(number)) next.push(number);
    }
    if (next.length === 0) return;
    next.forEach((number) => this.asked.add(number));
    this.ask(next);
  }

  /** From places in the cubes about their sensors to the origin's axes. */
  private matrices({ number, edge, time, pose }: PlacedClouds): Map<number, Placed> {
    return new Map(number.map((one, i) => {
      const half = -edge[i] / 2, step = edge[i] / STEPS;
      const fromCube = new Matrix4().makeScale(step, step, step).setPosition(half, half, half);
      const toOrigin = new Matrix4().makeTranslation(this.origin.clone().negate());
      return [one, { matrix: toOrigin.multiply(poseMatrix(pose, i)).multiply(fromCube), time: time[i] }] as const;
    }));
  }

  private measure(): boolean {
    const now = performance.now();
    if (this.asked.size > 0 && now - this.measured < MEASURED) return false;
    this.measured = now;
    const places: Vector3[] = [];
    for (const { values, count, points } of this.held.values()) {
      for (let i = 0; i < POINT * count; i += POINT * SAMPLED) {
        places.push(new Vector3(values[i], values[i + 1], values[i + 2]).applyMatrix4(points.matrix));
      }
    }
    if (places.length === 0) return false;
    this.extent = extentOf([Float64Array.from(places, (p) => p.x), Float64Array.from(places, (p) => p.y),
      Float64Array.from(places, (p) => p.z)], this.look);
    return true;
  }

  private drop(number: number, one: Held): void {
    this.group.remove(one.points);
    one.points.geometry.dispose();
    this.held.delete(number);
    this.heldPoints -= one.count;
  }

  private clearSweep(): void {
    if (!this.sweep) return;
    this.group.remove(this.sweep);
    this.sweep.geometry.dispose();
    this.sweep = null;
  }
}

/** So that the first points of a keyframe are spread over all of it: while something moves, only those are drawn. */
function shuffle({ values, count }: TilePoints): Uint16Array {
  const shuffled = new Uint16Array(POINT * count);
  for (let i = 0; i < count; ++i) {
    const at = POINT * ((i * SHUFFLE) % count);
    shuffled.set(values.subarray(at, at + POINT), POINT * i);
  }
  return shuffled;
}
