// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The graph over the cloud: where the sensor was, keyframes, what ties them, and what GNSS says.
import { BufferGeometry, Color, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Matrix4, Points, PointsMaterial,
  Vector3, type Material, type PerspectiveCamera } from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { poseMatrix } from './cloud';
import { colour, theme } from './palette';
import { POSE, type Fix, type Graph, type Loop, type Scene } from './protocol';

export const LAYERS = ['trajectory', 'odometry', 'keyframes', 'edges', 'loops', 'rejected', 'ellipses', 'fixes', 'weak', 'truth'] as const;
export type Layer = (typeof LAYERS)[number];

/** From what lies lowest on the screen to what is above all. */
const ORDER: Layer[] = ['edges', 'truth', 'odometry', 'rejected', 'ellipses', 'weak', 'fixes', 'trajectory', 'loops', 'keyframes'];

export type Found = { kind: 'keyframe'; at: number } | { kind: 'loop'; loop: Loop } | { kind: 'fix'; fix: Fix };

const LONGEST_STEP = 5;     // m between sweeps that are drawn as one line
const SIGMAS = 3;
const ARCS = 24;
const ARM = 1;              // m, of a weak direction to both sides

export class GraphLayer {
  readonly group = new Group();
  readonly path: Vector3[] = [];          // of sweeps, about the origin
  readonly keyframes: Vector3[] = [];
  graph: Graph | null = null;
  private readonly layers = new Map<Layer, Group>(LAYERS.map((layer) => [layer, new Group()]));
  private readonly chosen = new Group();
  private sweepPoses: Matrix4[] = [];
  private stepTimes: number[] = [];       // s, of the ends of the trajectory's lines
  private until: number | null = null;    // s

  constructor(private readonly scene: Scene, private readonly origin: Vector3) {
    for (const layer of this.layers.values()) this.group.add(layer);
    this.group.add(this.chosen);
  }

  show(layer: Layer, visible: boolean): void {
    this.layers.get(layer)!.visible = visible;
  }

  shows(layer: Layer): boolean {
    return this.layers.get(layer)!.visible;
  }

  set(graph: Graph): void {
    this.graph = graph;
    this.keyframes.length = 0;
    for (let i = 0; i < graph.keyframes.id.length; ++i) this.keyframes.push(this.about(graph.keyframes.pose, i));
    this.sweepPoses = this.sweepsBy(graph.keyframes.pose);
    this.path.length = 0;
    for (const pose of this.sweepPoses) this.path.push(this.placeIn(pose));
    this.draw();
  }

  /** The trajectory from that sweep on is another. */
  follow(from: number): void {
    this.sweepPoses.length = this.path.length = Math.min(from, this.path.length);
    for (let i = this.path.length; i < this.scene.sweeps.time.length; ++i) {
      const pose = poseMatrix(this.scene.sweeps.pose, i);
      this.sweepPoses.push(pose);
      this.path.push(this.placeIn(pose));
    }
    this.drawTrajectory();
  }

  /** The trajectory of later times (s) is not shown; null: all of it is. */
  showUntil(time: number | null): void {
    if (time === this.until) return;
    this.until = time;
    this.cut();
  }

  private cut(): void {
    const { until, stepTimes } = this;
    const first = until === null ? -1 : stepTimes.findIndex((time) => time > until);
    for (const line of this.layers.get('trajectory')!.children as LineSegments2[]) {
      line.geometry.instanceCount = first < 0 ? stepTimes.length : first;
    }
  }

  private drawTrajectory(): void {
    this.stepTimes = stepsOf(this.path).map((i) => this.scene.sweeps.time[i]);
    const { background, trajectory } = theme();  // with an edge about it: points may have any colour
    this.fill('trajectory', wide(steps(this.path), background, 5), wide(steps(this.path), trajectory, 2.5));
    this.cut();
  }

  /** Draws all of it anew: the graph, or the colours, are others. */
  draw(): void {
    if (!this.graph) return;
    const { keyframes, edges, loops, fixes } = this.graph;
    const colours = theme();
    const odometry = this.sweepsBy(keyframes.odometry).map((pose) => this.placeIn(pose));
    this.drawTrajectory();
    this.fill('odometry', wide(steps(keyframes.id.length > 0 ? odometry : []), colours.odometry, 1.5));
    this.fill('keyframes', dots(this.keyframes, this.keyframes.map(() => colours.keyframe), 5));
    this.fill('edges', thin(edges.filter(([from, to, kind]) => kind === 'odometry' && from >= 0 && to >= 0)
        .flatMap(([from, to]) => [this.keyframes[from], this.keyframes[to]]), colours.odometry));
    this.fill('loops', ...this.loopLines(loops.filter((loop) => loop.verdict !== 'rejected'), 3));
    this.fill('rejected', ...this.loopLines(loops.filter((loop) => loop.verdict === 'rejected'), 1.5));
    const ellipses = this.keyframes.flatMap((p, i) => ellipsoid(p, keyframes.covariance.slice(6 * i, 6 * i + 6)));
    this.fill('ellipses', thin(ellipses, colours.keyframe));
    this.fill('weak', thin(this.weakArms(false), colours.verdicts.waiting), thin(this.weakArms(true), colours.verdicts.rejected));
    this.fill('truth', wide(steps(this.truePath()), colours.truth, 1.5));
    const verdicts = fixes.map((fix) => colours.verdicts[fix.verdict] ?? colours.odometry);
    this.fill('fixes', dots(fixes.map((fix) => this.placeOf(fix)), verdicts, 7));
  }

  /** What lies within some pixels of a place on the screen: a keyframe before a fix before a loop. */
  find(camera: PerspectiveCamera, width: number, height: number, x: number, y: number, within: number): Found | null {
    if (!this.graph) return null;
    const view = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    const onScreen = (p: Vector3): [number, number] | null => {
      const e = view.elements, w = e[3] * p.x + e[7] * p.y + e[11] * p.z + e[15];
      if (w <= camera.near) return null;
      const q = p.clone().applyMatrix4(view);
      return [(0.5 + 0.5 * q.x) * width, (0.5 - 0.5 * q.y) * height];
    };
    const off = (p: Vector3): number => {
      const s = onScreen(p);
      return s ? Math.hypot(s[0] - x, s[1] - y) : Infinity;
    };
    let best: Found | null = null, least = within;
    const consider = (found: Found, distance: number): void => {
      if (distance < least) { least = distance; best = found; }
    };
    const tells = this.shows('keyframes') || this.shows('trajectory');  // a click on the path, too, tells of a keyframe
    if (tells) this.keyframes.forEach((p, at) => consider({ kind: 'keyframe', at }, off(p)));
    if (this.shows('fixes')) this.graph.fixes.forEach((fix) => consider({ kind: 'fix', fix }, off(this.placeOf(fix)) + 1));
    if (best) return best;
    for (const loop of this.graph.loops) {
      if (!this.shows(loop.verdict === 'rejected' ? 'rejected' : 'loops') || loop.from < 0 || loop.to < 0) continue;
      const a = onScreen(this.keyframes[loop.from]), b = onScreen(this.keyframes[loop.to]);
      if (a && b) consider({ kind: 'loop', loop }, toSegment(x, y, a, b));
    }
    return best;
  }

  /** Marks a keyframe, or the two of a loop. */
  mark(found: Found | null): void {
    this.chosen.clear();
    if (!found || found.kind === 'fix') return;
    const at = found.kind === 'keyframe' ? [found.at] : [found.loop.from, found.loop.to];
    const places = at.filter((i) => i >= 0 && i < this.keyframes.length).map((i) => this.keyframes[i]);
    const made = dots(places, places.map(() => theme().chosen), 11);
    if (!made) return;
    made.renderOrder = ORDER.length;
    this.chosen.add(made);
  }

  /** The pose of the sensor at a time (s), about the origin. */
  poseAt(time: number): Matrix4 | null {
    const times = this.scene.sweeps.time;
    let best = -1;
    for (let i = 0; i < times.length && i < this.sweepPoses.length; ++i) {
      if (best < 0 || Math.abs(times[i] - time) < Math.abs(times[best] - time)) best = i;
    }
    if (best < 0) return null;
    const pose = this.sweepPoses[best].clone();
    return pose.setPosition(this.path[best]);
  }

  private about(poses: number[], i: number): Vector3 {
    return new Vector3(poses[POSE * i], poses[POSE * i + 1], poses[POSE * i + 2]).sub(this.origin);
  }

  private placeIn(pose: Matrix4): Vector3 {
    return new Vector3().setFromMatrixPosition(pose).sub(this.origin);
  }

  /** Of directions that nothing holds, or of those that are held weakly. */
  private weakArms(none: boolean): Vector3[] {
    const { weak } = this.scene;
    return weak.sweep.flatMap((sweep, i) => {
      const p = this.path[sweep];
      if (!p || weak.none[i] !== none) return [];
      const arm = new Vector3(...weak.axis.slice(3 * i, 3 * i + 3)).multiplyScalar(ARM);
      return [p.clone().sub(arm), p.clone().add(arm)];
    });
  }

  private truePath(): Vector3[] {
    const path = this.graph?.truth?.path ?? [];
    return Array.from({ length: path.length / 3 }, (_, i) => new Vector3(...path.slice(3 * i, 3 * i + 3)).sub(this.origin));
  }

  private placeOf(fix: Fix): Vector3 {
    return new Vector3(...fix.p).sub(this.origin);
  }

  private sweepsBy(keyframePoses: number[]): Matrix4[] {
    const { keyframe, pose } = this.scene.sweeps;
    const matrices: Matrix4[] = [];
    for (let i = 0; i < keyframePoses.length / POSE; ++i) matrices.push(poseMatrix(keyframePoses, i));
    return keyframe.map((at, i) => {
      const local = poseMatrix(pose, i);
      return at >= 0 && matrices[at] ? matrices[at].clone().multiply(local) : local;
    });
  }

  private loopLines(loops: Loop[], width: number): (LineSegments2 | null)[] {
    const byVerdict = new Map<string, Vector3[]>();
    for (const loop of loops) {
      if (loop.from < 0 || loop.to < 0) continue;
      const ends = byVerdict.get(loop.verdict) ?? [];
      ends.push(this.keyframes[loop.from], this.keyframes[loop.to]);
      byVerdict.set(loop.verdict, ends);
    }
    return [...byVerdict].map(([verdict, ends]) => wide(ends, theme().verdicts[verdict], width));
  }

  private fill(layer: Layer, ...made: (LineSegments | LineSegments2 | Points | null)[]): void {
    const group = this.layers.get(layer)!;
    const order = ORDER.indexOf(layer);
    for (const old of group.children as LineSegments[]) {
      old.geometry.dispose();
      (old.material as Material).dispose();
    }
    group.clear();
    for (const one of made) {
      if (!one) continue;
      one.renderOrder = order;
      group.add(one);
    }
  }
}

/** Positions that a line leads to from the one before. */
function stepsOf(path: Vector3[]): number[] {
  return path.map((_, i) => i).filter((i) => i > 0 && path[i].distanceTo(path[i - 1]) < LONGEST_STEP);
}

function steps(path: Vector3[]): Vector3[] {
  return stepsOf(path).flatMap((i) => [path[i - 1], path[i]]);
}

function wide(ends: Vector3[], hex: string, width: number): LineSegments2 | null {
  if (ends.length === 0) return null;
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(ends.flatMap((p) => [p.x, p.y, p.z]));
  const lines = new LineSegments2(geometry, new LineMaterial({ linewidth: width, depthTest: false }));
  (lines.material.uniforms.diffuse.value as Color).copy(colour(hex));
  lines.frustumCulled = false;
  return lines;
}

function thin(ends: Vector3[], hex: string): LineSegments | null {
  if (ends.length === 0) return null;
  const material = new LineBasicMaterial({ depthTest: false });
  material.color.copy(colour(hex));
  const lines = new LineSegments(new BufferGeometry().setFromPoints(ends), material);
  lines.frustumCulled = false;
  return lines;
}

function dots(places: Vector3[], hexes: string[], size: number): Points | null {
  if (places.length === 0) return null;
  const geometry = new BufferGeometry().setFromPoints(places);
  geometry.setAttribute('color', new Float32BufferAttribute(hexes.flatMap((hex) => colour(hex).toArray()), 3));
  const material = new PointsMaterial(
      { size, sizeAttenuation: false, vertexColors: true, depthTest: false, transparent: true });
  material.onBeforeCompile = (shader) => {  // round
    shader.fragmentShader = shader.fragmentShader.replace('void main() {',
        'void main() { if (length(gl_PointCoord - 0.5) > 0.5) discard;');
  };
  const points = new Points(geometry, material);
  points.frustumCulled = false;
  return points;
}

/** Three ellipses of the ellipsoid that the keyframe is in with three standard deviations. They are the circles of a sphere,
    moved by a root of the covariance: any root will do, that of Cholesky is at hand. */
function ellipsoid(centre: Vector3, covariance: number[]): Vector3[] {
  const [xx, xy, xz, yy, yz, zz] = covariance;
  if (!(xx > 0) || !(yy > 0)) return [];
  const a = Math.sqrt(xx), b = xy / a, c = xz / a, d = Math.sqrt(Math.max(0, yy - b * b));
  const e = d > 0 ? (yz - b * c) / d : 0, f = Math.sqrt(Math.max(0, zz - c * c - e * e));
  const axes = [new Vector3(a, b, c), new Vector3(0, d, e), new Vector3(0, 0, f)].map((axis) => axis.multiplyScalar(SIGMAS));
  const at = (i: number, j: number, k: number): Vector3 => {
    const t = 2 * Math.PI * k / ARCS;
    return centre.clone().addScaledVector(axes[i], Math.cos(t)).addScaledVector(axes[j], Math.sin(t));
  };
  return [[0, 1], [1, 2], [0, 2]].flatMap(([i, j]) => Array.from({ length: ARCS }, (_, k) => [at(i, j, k), at(i, j, k + 1)]).flat());
}

function toSegment(x: number, y: number, a: [number, number], b: [number, number]): number {
  const dx = b[0] - a[0], dy = b[1] - a[1];
  const t = Math.max(0, Math.min(1, ((x - a[0]) * dx + (y - a[1]) * dy) / Math.max(1e-9, dx * dx + dy * dy)));
  return Math.hypot(a[0] + t * dx - x, a[1] + t * dy - y);
}
