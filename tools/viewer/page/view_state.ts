// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a link to the view holds, after its '#': whoever opens it sees the same.
import { COLOURS, type ColourBy } from './cloud_material';
import { LAYERS, type Layer } from './graph_layer';
import { PLOTS, type Plot } from './plots';

/** Whose pose the later keyframe of a loop is shown with, to the earlier one. */
export const OVERLAYS = ['odometry', 'map', 'loop'] as const;
export type Overlay = (typeof OVERLAYS)[number];

/** The points of a loop's two keyframes alone. */
export interface Overlaid { loop: number; by: Overlay; }

export interface ViewState {
  /** x, y, z of what is looked at (map frame, m), distance (m), yaw, pitch (rad); null: the whole map. */
  eye: number[] | null;
  colour: ColourBy | null;  // null: those of cameras where there are some, else by height
  size: number;             // pixels
  shading: boolean;
  moving: boolean;
  layers: Layer[];
  /** x, y, z from, x, y, z to (map frame, m), and how far it is turned about its middle then (degrees, to the left). */
  box: number[] | null;
  time: number | null;      // s
  grow: boolean;
  plots: Plot[];
  only: number | null;      // id of the keyframe whose points are shown alone
  overlaid: Overlaid | null;
}

export const BEGIN: ViewState = { eye: null, colour: null, size: 2, shading: true, moving: true,
  layers: ['trajectory', 'loops', 'fixes'], box: null, time: null, grow: false, plots: ['overlap', 'sigma'], only: null, overlaid: null };

export function toHash(state: ViewState): string {
  const parts = new URLSearchParams();
  const list = (values: number[], digits: number): string => values.map((v) => Number(v.toFixed(digits))).join(',');
  if (state.eye) parts.set('eye', list(state.eye, 3));
  if (state.colour) parts.set('colour', state.colour);
  if (state.size !== BEGIN.size) parts.set('size', String(state.size));
  if (!state.shading) parts.set('shading', '0');
  if (!state.moving) parts.set('moving', '0');
  if (String([...state.layers].sort()) !== String([...BEGIN.layers].sort())) parts.set('layers', state.layers.join(','));
  if (state.box) parts.set('box', list(state.box, 2));
  if (state.time !== null) parts.set('time', state.time.toFixed(2));
  if (state.grow) parts.set('grow', '1');
  if (String(state.plots) !== String(BEGIN.plots)) parts.set('plots', state.plots.join(','));
  if (state.only !== null) parts.set('only', String(state.only));
  if (state.overlaid) parts.set('overlaid', `${state.overlaid.loop},${state.overlaid.by}`);
  return parts.toString().replaceAll('%2C', ',');
}

export function fromHash(hash: string): ViewState {
  const parts = new URLSearchParams(hash.replace(/^#/, ''));
  const list = (name: string, count: number): number[] | null => {
    const values = (parts.get(name) ?? '').split(',').map(Number);
    return values.length === count && values.every(Number.isFinite) && parts.get(name) ? values : null;
  };
  const number = (name: string): number | null => {
    const value = Number(parts.get(name));
    return parts.get(name) && Number.isFinite(value) ? value : null;
  };
  const layers = parts.get('layers'), plots = parts.get('plots');
  return {
    eye: list('eye', 6),
    colour: COLOURS.find((one) => one === parts.get('colour')) ?? BEGIN.colour,
    size: Math.min(8, Math.max(1, number('size') ?? BEGIN.size)),
    shading: parts.get('shading') !== '0',
    moving: parts.get('moving') !== '0',
    layers: layers === null ? [...BEGIN.layers] : LAYERS.filter((layer) => layers.split(',').includes(layer)),
    box: list('box', 7) ?? list('box', 6)?.concat(0) ?? null,
    time: number('time'),
    grow: parts.get('grow') === '1',
    only: number('only'),
    overlaid: overlaidIn(parts.get('overlaid') ?? ''),
    plots: plots === null ? [...BEGIN.plots] : PLOTS.filter((one) => plots.split(',').includes(one)),
  };
}

function overlaidIn(text: string): Overlaid | null {
  const [, loop, name] = /^(\d+),(\w+)$/.exec(text) ?? [];
  const by = OVERLAYS.find((one) => one === name);
  return by ? { loop: Number(loop), by } : null;
}
