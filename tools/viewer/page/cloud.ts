// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The cloud: asks for tiles that are to be seen, holds those that came, and forgets what was not seen for longest.
import { Group, Matrix4, Quaternion, Vector2, Vector3, type PerspectiveCamera, type Points } from 'three';
import { CloudMaterial } from './cloud_material';
import { Octree } from './octree';
import { POINT, POSE, type Poses, type Scene, type TilePoints } from './protocol';
import { extentOf, nearestPoint, pointsOf, STEPS, type Extent, type FoundPoint, type ShownCloud } from './shown_cloud';
import { Spacing } from './spacing';

const MOST_ASKED = 24;      // tiles on their way at a time
const KEPT = 2;             // times the budget stays in memory

interface Held { points: Points; values: Uint16Array; count: number; spacing: Spacing; seen: number; }

export class Cloud implements ShownCloud {
  readonly group = new Group();
  readonly look = new CloudMaterial();
  readonly octree: Octree;
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
  /** Comes with the root's tile. */
  extent: Extent | null = null;

  constructor(private readonly scene: Scene, private readonly ask: (tiles: number[]) => void) {
    this.octree = new Octree(scene);
    this.origin = new Vector3(...scene.cube.low).addScalar(scene.cube.edge / 2);
    const keyframes = scene.tiled_poses.length / POSE;
    this.look.set('keyframeScale', keyframes > scene.keyframes_told ? keyframes / scene.keyframes_told : 1);
  }

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

  take(tile: TilePoints): boolean {
    this.asked.delete(tile.number);
    const place = this.octree.tiles[tile.number];
    if (!place || this.held.has(tile.number)) return false;
    const { edge, low } = place;
    const spacing = this.spacingOf(tile);
    const points = pointsOf(tile, this.look,
        new Matrix4().makeScale(edge / STEPS, edge / STEPS, edge / STEPS).setPosition(low), spacing.codes);
    points.visible = false;
    this.group.add(points);
    this.held.set(tile.number, { points, values: tile.values, count: tile.count, spacing, seen: this.clock });
    this.heldPoints += tile.count;
    if (tile.number === 0) this.findExtent(tile);
    return tile.number === 0;
  }

  askAgain(): void {
    this.asked.clear();
  }

  correct(poses: Poses): void {
    this.rows = corrections(this.scene.tiled_poses, poses, this.origin);
    this.look.setCorrections(this.rows);
  }

  showOnly(keyframes: number[]): void {
    const scale = this.look.get<number>('keyframeScale');
    const told = (keyframe: number | undefined): number => (keyframe === undefined ? -1 : Math.floor(keyframe / scale + 1e-6));
    this.look.set('only', told(keyframes[0]));
    this.look.set('other', told(keyframes[1]));
  }

  get heights(): [number, number] {
    const { x, y } = this.look.get<Vector2>('heights');
    return [x + this.origin.z, y + this.origin.z];
  }

  find(camera: PerspectiveCamera, width: number, height: number, x: number, y: number, within: number): FoundPoint | null {
    const parts = this.shown.map((number) => this.held.get(number)!)
        .map(({ points, values, count }) => ({ values, count, matrix: points.matrix }));
    const found = nearestPoint(parts, this.look, { camera, width, height, x, y, within },
        (p, told) => { if (this.rows) this.moved(p, told); });
    if (!found) return null;
    found.p.add(this.origin);
    return { ...found, keyframe: this.keyframeOf(found.keyframe) };
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
    const side = (k: number): Float64Array => Float64Array.from({ length: root.count },
        (_, i) => low.getComponent(k) + edge / STEPS * (root.values[POINT * i + k] + 0.5));
    this.extent = extentOf([side(0), side(1), side(2)], this.look);
  }

  /** Of a tile that comes, which those above it are told of. */
  private spacingOf(tile: TilePoints): Spacing {
    const { tiles } = this.octree;
    const above: Held[] = [];
    for (let number = tiles[tile.number].above; number >= 0; number = tiles[number].above) {
      const one = this.held.get(number);
      if (one) above.push(one);
    }
    const { low, edge } = tiles[tile.number];
    const spacing = new Spacing(tile, low, edge, above.map((one) => one.spacing));
    for (const one of above) {
      if (one.spacing.refine(spacing)) one.points.geometry.getAttribute('spacing').needsUpdate = true;
    }
    const refineBy = (number: number): void => tiles[number].children.forEach((child) => {
      const one = this.held.get(child);
      if (one) spacing.refine(one.spacing);
      refineBy(child);
    });
    refineBy(tile.number);
    return spacing;
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
