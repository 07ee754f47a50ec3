// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the server says: tools/viewer/view_data.cpp, view_graph.cpp and live_scene.cpp are the other side.

/** Poses one after the other: x, y, z (m) and the quaternion x, y, z, w. */
export type Poses = number[];
export const POSE = 7;

export interface Cube { low: [number, number, number]; edge: number; cells: number; }

/** Over equal times from second 0 to the last; null: nothing is known. */
export interface PlotCurve {
  name: string;
  title: string;
  unit: string;
  logarithmic: boolean;
  least: (number | null)[];
  most: (number | null)[];
}

export interface Plots {
  curves: PlotCurve[];
  stretches: { state: string; begin: number; end: number; text: string }[];  // s; "doubtful" or "lost"
}

/** A source of measurements, and what it was worth: "sources" of summary.json. */
export interface Source {
  name: string;
  topic: string | null;
  estimate: 'motion' | 'map';
  unit: string;
  used: number;
  refused: number;
  left_out: number;
  remark: string | null;
  innovation_squared_per_degree: number | null;
  shares: Record<string, number> | null;  // of the information about each part, 1 over all sources of the estimate
}

export interface Scene {
  type: 'scene';
  live?: boolean;            // of a run that goes on: what there is comes with Live
  program: string;
  title: string;
  editable: boolean;
  intensity: boolean;        // points have one
  colors?: boolean;          // points have the colours of cameras; none: they have not
  start_ns: string;          // UNIX time or the recording's own, of second 0
  seconds: number;
  points: number;
  keyframes_told: number;    // numbers that points name their keyframe by
  cube: Cube;
  tiles: { parent: number[]; octant: number[]; points: number[] };
  tiled_poses: Poses;        // of keyframes, when their points came into tiles
  sweeps: { time: number[]; keyframe: number[]; pose: Poses };  // in keyframe axes; keyframe -1: in the map's
  map: string;               // its path as the program was given it; empty: a cloud
  plots: Plots | null;       // of a run's folder, or of a run that goes on: then values come with Live
  /** Directions that sweeps are not held in, in the map's frame: numbers of sweeps, and x, y, z of each. */
  weak: { sweep: number[]; axis: number[]; none: boolean[] };
  sources: Source[];         // of a run's folder; of a run that goes on they come with Live
}

export interface Loop {
  id: number;
  from: number;              // position among keyframes, -1: none
  to: number;
  verdict: 'waiting' | 'accepted' | 'rejected' | 'revoked';
  reason: string;
  figure: number | null;
  overlap: number | null;
  rms: number | null;        // m
  correction: number | null; // m
  turn: number | null;       // rad
  through: number | null;
  found_by: string;
  chi2: number | null;
  pose: Poses;               // of the later keyframe in the earlier one, as verified or as guessed before; none: []
}

export interface Fix {
  keyframe: number;
  time: number;
  p: [number, number, number];
  verdict: string;
  sigma: number | null;      // m
  chi2: number | null;
}

export interface Graph {
  type: 'graph';
  keyframes: { id: number[]; session: number[]; time: number[]; pose: Poses; odometry: Poses; covariance: number[] };
  edges: [number, number, string, string][];  // from, to, kind, status
  loops: Loop[];
  fixes: Fix[];
  /** Where the keyframes really were: how far each is off, m, once the truth lies on the map as it fits best, and the true way. */
  truth: { error: (number | null)[]; path: number[] } | null;
  /** True north at the map's origin, in the map's axes; null where the map has no place on the Earth. */
  world: { north: number[]; coordinates: string } | null;
}

/** Points that are asked for by number: a cube about a sensor each, when it was there (s), and its pose in the map. */
export interface PlacedClouds { number: number[]; edge: number[]; time: number[]; pose: Poses; }

/** Values of the scene's curves, in their order, in times of `step` seconds from `begin` on: what comes from the time
    numbered `from` on is another. */
export interface PlotBins { begin: number; step: number; from: number; least: (number | null)[][]; most: (number | null)[][]; }

/** What has changed in a run that goes on. */
export interface Live {
  type: 'live';
  doing: string;
  intensity: boolean;        // points have one
  seconds: number;           // in the recording
  progress: { sweeps: number; of: number; failed: number; verdict: string };
  sources: Source[];         // so far
  from: number;              // the trajectory's sweeps from this one on are those of `sweeps`
  sweeps: Scene['sweeps'];
  newest?: PlacedClouds;     // the newest sweep, none before the first
  clouds?: PlacedClouds;     // of keyframes, all that there are; none: as before
  plots?: PlotBins;          // none: as before
  stretches?: Plots['stretches'];
}

export interface PlaceOnEarth {
  latitude: number;          // degrees
  longitude: number;
  altitude: number;          // m above the ellipsoid
  utm: { zone: string; easting: number; northing: number } | null;  // m
}

/** The answer to { place: [x, y, z] }, in the map's frame. */
export interface Place { type: 'place'; p: number[]; world: PlaceOnEarth | null; }

export interface Told { type: 'told'; problem: boolean; text: string; }

/** Places and facts of a tile's points, six numbers of 16 bits each: x, y, z, moment, keyframe, and
    intensity with 256 added for what has moved, and 512 where no intensity is known. Then red, green and blue of each
    point, where the cloud has colours; black: no camera saw it. */
export interface TilePoints { number: number; count: number; values: Uint16Array; colours: Uint8Array | null; }
export const POINT = 6;

export function tilePoints(message: ArrayBuffer): TilePoints {
  const [number, count] = new Uint32Array(message, 0, 2);
  const end = 8 + 2 * POINT * count;
  return { number, count, values: new Uint16Array(message, 8, POINT * count),
    colours: message.byteLength > end ? new Uint8Array(message, end, 3 * count) : null };
}
