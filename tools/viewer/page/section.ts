// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A cross section: what lies within a plank along the line from one point to another, seen from its side.
import { Vector3 } from 'three';
import type { Eye } from './controls';

const THICK = 0.5;          // m
const BESIDE = 0.05;        // of the line, that the plank goes on beyond its ends

export interface Section {
  box: number[];            // as ViewState has it
  eye: Eye;                 // target in the map's frame
}

/** Null: the two lie above each other. `low` and `high`: the heights that there are, m. */
export function sectionAlong(a: Vector3, b: Vector3, low: number, high: number): Section | null {
  const length = Math.hypot(b.x - a.x, b.y - a.y);
  if (length < 0.01) return null;
  // A turn of at most a quarter names the same plank, whichever point came first.
  const heading = Math.atan2(b.y - a.y, b.x - a.x);
  const turn = heading - Math.PI * Math.round(heading / Math.PI);
  const middle = new Vector3(0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z));
  const half = new Vector3((0.5 + BESIDE) * length, 0.5 * THICK, 0);
  const box = [middle.x - half.x, middle.y - half.y, low, middle.x + half.x, middle.y + half.y, high, turn * 180 / Math.PI];
  return { box, eye: { target: middle, distance: 1.1 * length, yaw: turn - 0.5 * Math.PI, pitch: 0 } };
}
