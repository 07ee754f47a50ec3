// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The box that points are shown in: six sides, in the map's frame, m, and how far it is turned about its middle, degrees.
import { Vector3 } from 'three';
import type { Box } from './cloud_material';
import { element, input } from './elements';
import type { Scene } from './protocol';
import type { ShownCloud } from './shown_cloud';

const NAMES = ['x from', 'y from', 'z from', 'x to', 'y to', 'z to', 'turned'];
const TURN = 6;
const STEEPEST = 90;       // degrees, of a turn

export class ClipBox {
  /** Null: everything is shown. */
  value: number[] | null = null;
  private readonly ranges: HTMLInputElement[] = [];
  private readonly outputs: HTMLOutputElement[] = [];

  constructor(private readonly changed: () => void) {
    NAMES.forEach((name, i) => {
      const label = document.createElement('span'), range = document.createElement('input');
      const output = document.createElement('output');
      label.textContent = name;
      range.type = 'range';
      range.step = 'any';
      range.id = `side${i}`;
      range.setAttribute('aria-label', name);
      range.addEventListener('input', () => this.take());
      element('sides').append(label, range, output);
      this.ranges.push(range);
      this.outputs.push(output);
    });
    input('boxed').addEventListener('change', () => {
      if (input('boxed').checked) element<HTMLDetailsElement>('box').open = true;
      this.take();
    });
  }

  /** The sides go no further than `whole`. */
  set(whole: number[], value: number[] | null): void {
    this.value = value;
    input('boxed').checked = value !== null;
    this.ranges.forEach((range, i) => {
      const now = (value ?? [...whole, 0])[i];  // of a box that is turned it may lie beyond what there is
      range.min = String(i === TURN ? -STEEPEST : Math.min(now, whole[i % 3]));
      range.max = String(i === TURN ? STEEPEST : Math.max(now, whole[i % 3 + 3]));
      range.value = String(now);
    });
    this.show();
  }

  private take(): void {
    this.value = input('boxed').checked ? this.ranges.map((range) => Number(range.value)) : null;
    this.show();
    this.changed();
  }

  private show(): void {
    this.outputs.forEach((output, i) => { output.textContent = `${Number(this.ranges[i].value).toFixed(1)}${i === TURN ? '°' : ' m'}`; });
  }
}

/** About the origin, of what ViewState has. */
export function boxOf([x0, y0, z0, x1, y1, z1, turn]: number[], origin: Vector3): Box {
  return { middle: new Vector3(0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * (z0 + z1)).sub(origin),
    half: new Vector3(0.5 * (x1 - x0), 0.5 * (y1 - y0), 0.5 * (z1 - z0)), turn: turn * Math.PI / 180 };
}

/** As far as there is something: from and to. The cube of a run that goes on is not known before its end: as far as there are
    points. */
export function boundsOf(scene: Scene, { extent, origin }: ShownCloud): number[] {
  const { low, edge } = scene.cube;
  if (!scene.live || !extent) return [...low, ...low.map((v) => v + edge)];
  const middle = extent.middle.clone().add(origin).toArray();
  return [...middle.map((v) => v - extent.size), ...middle.map((v) => v + extent.size)];
}
