// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The cloud: asks for tiles that are to be seen, holds those that came, and forgets what was not seen for longest.
import { BufferGeometry, Group, InterleavedBuffer, InterleavedBufferAttribute, Matrix4, Points, Quaternion, Sphere, Vector2,
  Vector3, type PerspectiveCamera } from 'three';
import { CloudMaterial } from './cloud_material';
import { Octree } from './octree';
import { POINT, POSE, type Poses, type Scene, type TilePoints } from './protocol';

const MOST_ASKED = 24;      // tiles on their way at a time
const STEPS = 65536;        // of a place, in the edge of its tile
const KEPT = 2;             // times the budget stays in memory
const FLATTEST = 0.5;       // m, of the heights that colours are spread over

interface Held { points: Points; values: Uint16Array; count: number; seen: number; }

/** A point that was found, in the map's frame. */
export interface FoundPoint { p: Vector3; moment: number; keyframe: number; intensity: number; moving: boolean; }

export class Cloud {
  readonly group = new Group();
  readonly look = new CloudMaterial();
  readonly octree: Octree;
  /** In the map's frame, m, of the origin that everything is drawn from. */
  readonly origin: Vector3;
  drawn = 0;
  shown: number[] = [];
  missing = 0;
  whole = false;
  private readonly held = new Map<number, Held>();
  private readonly asked = new Set<number>();
  private heldPoints = 0;
  private clock = 0;
  private rows: Float32Array | null = null;
  /** Of most points, about the origin, m; with the root's tile. */
  extent: { middle: Vector3; size: number } | null = null;

  constructor(private readonly scene: Scene, private readonly ask: (tiles: number[]) => void) {
    this.octree = new Octree(scene);
    this.origin = new Vector3(...scene.cube.low).addScalar(scene.cube.edge / 2);
    const keyframes = scene.tiled_poses.length / POSE;
    this.look.set('keyframeScale', keyframes > scene.keyframes_told ? keyframes / scene.keyframes_told : 1);
  }

  /** Shows what is to be seen from there; returns whether anything on the screen is another. */
  update(camera: PerspectiveCamera, height: number, apart: number, budget: number): boolean {
    ++this.clock;
    const wanted = this.octree.wanted(camera, height, apart, budget);
    const before = this.shown;
    this.shown = wanted.tiles.filter((number) => this.held.has(number));
    this.whole = wanted.whole;
    this.drawn = 0;
    for (const one of this.held.values()) one.points.visible = false;
    for (const number of this.shown) {
      const one = this.held.get(number)!;
      one.points.visible = true;
      one.seen = this.clock;
      this.drawn += one.count;
    }
    const toCome = wanted.tiles.filter((number) => !this.held.has(number));
    this.missing = toCome.length;
    const next = toCome.filter((number) => !this.asked.has(number)).slice(0, MOST_ASKED - this.asked.size);
    if (next.length > 0) {
      next.forEach((number) => this.asked.add(number));
      this.ask(next);
    }
    this.forget(KEPT * budget);
    return before.length !== this.shown.length || before.some((number, i) => number !== this.shown[i]);
  }

  take(tile: TilePoints): void {
    this.asked.delete(tile.number);
    const place = this.octree.tiles[tile.number];
    if (!place || this.held.has(tile.number)) return;
    const buffer = new InterleavedBuffer(tile.values, POINT);
    const geometry = new BufferGeometry();
    geometry.setAttribute('place', new InterleavedBufferAttribute(buffer, 3, 0));
    geometry.setAttribute('facts', new InterleavedBufferAttribute(buffer, 3, 3));
    geometry.setDrawRange(0, tile.count);
    geometry.boundingSphere = new Sphere(new Vector3(), Infinity);
    const points = new Points(geometry, this.look.material);
    points.frustumCulled = false;
    points.matrixAutoUpdate = false;
    points.matrix.makeScale(place.edge / STEPS, place.edge / STEPS, place.edge / STEPS).setPosition(place.low);
    points.visible = false;
    this.group.add(points);
    this.held.set(tile.number, { points, values: tile.values, count: tile.count, seen: this.clock });
    this.heldPoints += tile.count;
    if (tile.number === 0) this.findExtent(tile);
  }

  /** What was asked for will not come: the line was lost. */
  askAgain(): void {
    this.asked.clear();
  }

  /** Keyframes are elsewhere than when their points were tiled. */
  correct(poses: Poses): void {
    this.rows = corrections(this.scene.tiled_poses, poses, this.origin);
    this.look.setCorrections(this.rows);
  }

  /** The points of one keyframe alone, by its position; below 0: of all. */
  showOnly(keyframe: number): void {
    this.look.set('only', keyframe < 0 ? -1 : Math.floor(keyframe / this.look.get<number>('keyframeScale') + 1e-6));
  }

  /** Lowest and highest of most points, m in the map's frame. */
  get heights(): [number, number] {
    const { x, y } = this.look.get<Vector2>('heights');
    return [x + this.origin.z, y + this.origin.z];
  }

  /** The point nearest to the eye among those within some pixels of a place on the screen. */
  find(camera: PerspectiveCamera, width: number, height: number, x: number, y: number, within: number): FoundPoint | null {
    const view = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const low = this.look.get<Vector3>('boxLow'), high = this.look.get<Vector3>('boxHigh');
    const until = this.look.get<number>('until'), hideMoving = this.look.get<boolean>('hideMoving');
    const only = this.look.get<number>('only');
    const p = new Vector3();
    let best: FoundPoint | null = null, least = Infinity;
    for (const number of this.shown) {
      const { values, count } = this.held.get(number)!;
      const { low: corner, edge } = this.octree.tiles[number];
      const step = edge / STEPS;
      for (let i = 0; i < POINT * count; i += POINT) {
        if (values[i + 3] > until || (hideMoving && values[i + 5] > 255) || (only >= 0 && values[i + 4] !== only)) continue;
        p.set(values[i] + 0.5, values[i + 1] + 0.5, values[i + 2] + 0.5).multiplyScalar(step).add(corner);
        if (this.rows) this.moved(p, values[i + 4]);
        const e = view.elements;
        const w = e[3] * p.x + e[7] * p.y + e[11] * p.z + e[15];
        if (w <= camera.near || w > least) continue;
        const dx = (0.5 + 0.5 * (e[0] * p.x + e[4] * p.y + e[8] * p.z + e[12]) / w) * width - x;
        const dy = (0.5 - 0.5 * (e[1] * p.x + e[5] * p.y + e[9] * p.z + e[13]) / w) * height - y;
        if (dx * dx + dy * dy > within * within) continue;
        if (p.x < low.x || p.y < low.y || p.z < low.z || p.x > high.x || p.y > high.y || p.z > high.z) continue;
        // The nearest to the eye, and of those on one surface the nearest to the finger.
        const rank = w * (1 + 0.3 * (dx * dx + dy * dy) / (within * within));
        if (rank < least) {
          least = rank;
          best = { p: p.clone(), moment: values[i + 3], keyframe: this.keyframeOf(values[i + 4]),
            intensity: values[i + 5] & 255, moving: values[i + 5] > 255 };
        }
      }
    }
    best?.p.add(this.origin);
    return best;
  }

  dispose(): void {
    for (const one of this.held.values()) one.points.geometry.dispose();
    this.look.material.dispose();
    this.group.clear();
  }

  private keyframeOf(told: number): number {
    return Math.round(told * this.look.get<number>('keyframeScale'));
  }

  private moved(p: Vector3, told: number): void {
    const at = 12 * this.keyframeOf(told), r = this.rows!;
    p.set(r[at] * p.x + r[at + 1] * p.y + r[at + 2] * p.z + r[at + 3],
        r[at + 4] * p.x + r[at + 5] * p.y + r[at + 6] * p.z + r[at + 7],
        r[at + 8] * p.x + r[at + 9] * p.y + r[at + 10] * p.z + r[at + 11]);
  }

  private findExtent(root: TilePoints): void {
    const { low, edge } = this.octree.tiles[0];
    const sides = [0, 1, 2].map((k) => {
      const all = new Float64Array(root.count);
      for (let i = 0; i < root.count; ++i) all[i] = low.getComponent(k) + edge / STEPS * (root.values[POINT * i + k] + 0.5);
      all.sort();
      return [all[Math.floor(0.02 * all.length)] ?? 0, all[Math.floor(0.98 * (all.length - 1))] ?? 1];
    });
    const [lowest, highest] = sides[2];
    this.look.get<Vector2>('heights').set(lowest, Math.max(highest, lowest + FLATTEST));
    this.extent = { middle: new Vector3(...sides.map(([a, b]) => 0.5 * (a + b))),
      size: Math.hypot(...sides.map(([a, b]) => b - a)) };
  }

  private forget(most: number): void {
    if (this.heldPoints <= most) return;
    const oldest = [...this.held].filter(([, one]) => one.seen < this.clock).sort((a, b) => a[1].seen - b[1].seen);
    for (const [number, one] of oldest) {
      if (this.heldPoints <= most) return;
      this.group.remove(one.points);
      one.points.geometry.dispose();
      this.held.delete(number);
      this.heldPoints -= one.count;
    }
  }
}

/** T_now * T_tiled^-1 of each keyframe about the origin, or null where none has moved. */
function corrections(tiled: Poses, now: Poses, origin: Vector3): Float32Array | null {
  if (tiled.length !== now.length || tiled.every((value, i) => value === now[i])) return null;
  const rows = new Float32Array(12 * tiled.length / POSE);
  const toOrigin = new Matrix4().makeTranslation(origin), fromOrigin = new Matrix4().makeTranslation(origin.clone().negate());
  for (let i = 0; i < tiled.length / POSE; ++i) {
    const moved = poseMatrix(now, i).multiply(poseMatrix(tiled, i).invert());
    const e = fromOrigin.clone().multiply(moved).multiply(toOrigin).elements;
    rows.set([e[0], e[4], e[8], e[12], e[1], e[5], e[9], e[13], e[2], e[6], e[10], e[14]], 12 * i);
  }
  return rows;
}

export function poseMatrix(poses: Poses, i: number): Matrix4 {
  const [x, y, z, qx, qy, qz, qw] = poses.slice(POSE * i, POSE * i + POSE);
  return new Matrix4().compose(new Vector3(x, y, z), new Quaternion(qx, qy, qz, qw).normalize(), new Vector3(1, 1, 1));
}
