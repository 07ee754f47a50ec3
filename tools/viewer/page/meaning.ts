// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What colours of points mean.
import { clock } from './elements';
import { SERIES } from './palette';
import { sessionKey } from './panel';
import type { Graph, Scene } from './protocol';
import type { ShownCloud } from './shown_cloud';
import { colourOf, overlaidLoop, valuesOf } from './shown_keyframes';
import type { ViewState } from './view_state';

/** `ramp`: from `least` to `most`; else colours by name. */
export interface Meaning { least: string; most: string; ramp: boolean; key: [string, string][]; }

export function meaningOf(state: ViewState, scene: Scene, cloud: ShownCloud, graph: Graph | null): Meaning {
  const named = (key: [string, string][]): Meaning => ({ least: '', most: '', ramp: false, key });
  const ramp = (least: string, most: string): Meaning => ({ least, most, ramp: true, key: [] });
  if (graph && !scene.live && overlaidLoop(graph, state)) return named([['earlier', SERIES[0]], ['later', SERIES[1]]]);
  const by = colourOf(state, scene, graph);
  switch (by) {
    case 'height': return ramp(cloud.heights[0].toFixed(1), `${cloud.heights[1].toFixed(1)} m`);
    case 'time': return ramp(clock(0), clock(scene.seconds));
    case 'intensity': return ramp('0', '255');
    case 'session': return named(graph ? sessionKey(graph) : []);
    case 'moving': return named([['stays', SERIES[0]], ['moves', SERIES[1]]]);
    case 'sigma':
    case 'error': return graph ? ramp('0', `${valuesOf(graph, by).most.toFixed(3)} m`) : named([]);
    case 'keyframe': return named([]);
    case 'camera': return named([['no camera saw it', '#999999']]);
  }
}
