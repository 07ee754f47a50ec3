// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which keyframes' points are shown, and where: all as the map has them, or a loop's later one laid over its earlier one.
import { Quaternion, Vector3, type Matrix4 } from 'three';
import { poseMatrix } from './cloud';
import type { ColourBy } from './cloud_material';
import { POSE, type Graph, type Loop, type Poses, type Scene } from './protocol';
import type { ShownCloud } from './shown_cloud';
import type { Overlay, ViewState } from './view_state';

/** The loop whose keyframes are laid over each other, if it is there. */
export function overlaidLoop(graph: Graph, state: ViewState): Loop | null {
  const loop = state.overlaid && graph.loops.find((one) => one.id === state.overlaid!.loop);
  return loop && loop.from >= 0 && loop.to >= 0 ? loop : null;
}

/** What points can be coloured by: the state's wish, or where that is not known by cameras, else by height. */
export function colourOf(state: ViewState, scene: Scene, graph: Graph | null): ColourBy {
  if (scene.live && state.colour !== 'intensity') return 'height';  // what else there is, the result knows
  const has = state.colour === 'intensity' ? scene.intensity : state.colour === 'error' ? !!graph?.truth
    : state.colour === 'sigma' ? !!graph?.keyframes.covariance.some((v) => v > 0) : state.colour === 'camera' ? !!scene.colors : true;
  return has && state.colour ? state.colour : scene.colors ? 'camera' : 'height';
}

export function showKeyframes(cloud: ShownCloud, graph: Graph, state: ViewState): void {
  const loop = overlaidLoop(graph, state);
  cloud.correct(loop ? overlaidPoses(graph, loop, state.overlaid!.by) : graph.keyframes.pose);
  const only = state.only === null ? -1 : graph.keyframes.id.indexOf(state.only);
  cloud.showOnly(loop ? [loop.from, loop.to] : only >= 0 ? [only] : []);
  const { values, most } = valuesOf(graph, state.colour);
  cloud.look.setValues(values.map((value) => (value === null ? null : value / most)));
}

/** What colours by error, else by sigma, are of: m, of each keyframe. */
export function valuesOf(graph: Graph, colour: ViewState['colour']): { values: (number | null)[]; most: number } {
  const c = graph.keyframes.covariance;
  const values = colour === 'error' ? graph.truth?.error ?? []
    : graph.keyframes.id.map((_, i) => (c[6 * i] === null ? null : Math.sqrt(Math.max(0, c[6 * i] + c[6 * i + 3] + c[6 * i + 5]))));
  return { values, most: values.reduce<number>((most, value) => Math.max(most, value ?? 0), 1e-3) };
}

/** Poses of keyframes as the map has them, but the loop's later one: it is to the earlier one as the odometry, the map or the
    loop says. */
function overlaidPoses(graph: Graph, loop: Loop, by: Overlay): Poses {
  const { pose, odometry } = graph.keyframes;
  if (by === 'map' || (by === 'loop' && loop.pose.length === 0)) return pose;
  const T_from_to = by === 'loop' ? poseMatrix(loop.pose, 0)
    : poseMatrix(odometry, loop.from).invert().multiply(poseMatrix(odometry, loop.to));
  const poses = [...pose];
  poses.splice(POSE * loop.to, POSE, ...partsOf(poseMatrix(pose, loop.from).multiply(T_from_to)));
  return poses;
}

function partsOf(matrix: Matrix4): number[] {
  const p = new Vector3(), q = new Quaternion();
  matrix.decompose(p, q, new Vector3());
  return [...p.toArray(), ...q.toArray()];
}
