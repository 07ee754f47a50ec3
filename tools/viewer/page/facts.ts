// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is told of what was clicked.
import { Vector3 } from 'three';
import { clock, element, metres, plain } from './elements';
import type { Found } from './graph_layer';
import { POSE, type Graph, type Loop, type Scene } from './protocol';
import type { FoundPoint } from './shown_cloud';

/** `pressed`: of one that is on or off. */
export interface Act { text: string; run: () => void; pressed?: boolean; }
export interface Facts { title: string; rows: [string, string][]; acts?: Act[]; }

const xyz = (p: { x: number; y: number; z: number }): string => [p.x, p.y, p.z].map((v) => v.toFixed(3)).join(', ');

export function showFacts(facts: Facts | null): void {
  element('told').hidden = facts === null;
  if (!facts) return;
  element('what').textContent = facts.title;
  element('facts').replaceChildren();
  addRows(facts.rows);
  element('acts').replaceChildren(...(facts.acts ?? []).flatMap(({ text, run, pressed }) => {
    const button = document.createElement('button');
    button.id = `act-${text.replaceAll(' ', '-')}`;
    button.textContent = text;
    button.onclick = run;
    if (pressed !== undefined) button.setAttribute('aria-pressed', String(pressed));
    return [button, ' '];
  }));
}

/** To what is told; buttons stay as they are, and where they are, for one of them may be being pressed. */
export function addRows(rows: [string, string][]): void {
  element('facts').append(...rows.flatMap(([name, value]) => {
    const term = document.createElement('dt'), told = document.createElement('dd');
    term.textContent = name;
    told.textContent = value;
    return [term, told];
  }));
}

/** In the map's frame; null: it is at two places. */
export function placeOf(found: Found, graph: Graph): Vector3 | null {
  if (found.kind === 'fix') return new Vector3(...found.fix.p);
  return found.kind === 'keyframe' ? new Vector3(...graph.keyframes.pose.slice(POSE * found.at, POSE * found.at + 3)) : null;
}

export type Change = (what: 'revoke' | 'restore', loop: Loop) => void;

export function factsOf(found: Found, graph: Graph, scene: Scene, change: Change): Facts {
  if (found.kind === 'keyframe') return keyframeFacts(found.at, graph, scene);
  if (found.kind === 'fix') {
    const { fix } = found;
    const [x, y, z] = fix.p;
    return { title: `GNSS fix: ${fix.verdict}`, rows: [['time', clock(fix.time)], ['x, y, z', xyz({ x, y, z })],
      ['1 sigma', metres(fix.sigma)], ['chi squared', plain(fix.chi2, 2)]] };
  }
  const { loop } = found;
  const name = (at: number): string => (at >= 0 ? String(graph.keyframes.id[at]) : 'none');
  const reason = loop.reason === '' || loop.reason === 'none' ? '–'
      : `${loop.reason.replaceAll('_', ' ')} (${plain(loop.figure, 3)})`;
  const facts: Facts = { title: `loop ${loop.id}: ${loop.verdict}`, rows: [
    ['keyframes', `${name(loop.from)} and ${name(loop.to)}`],
    ['reason', reason], ['found by', loop.found_by], ['overlap', plain(loop.overlap, 2)], ['rms', metres(loop.rms)],
    ['correction', `${metres(loop.correction)}, ${plain(loop.turn === null ? null : loop.turn * 180 / Math.PI, 1)}°`],
    ['seen through', plain(loop.through, 3)], ['chi squared', plain(loop.chi2, 2)]] };
  if (scene.editable && loop.verdict === 'accepted') facts.acts = [{ text: 'revoke', run: () => change('revoke', loop) }];
  if (scene.editable && loop.verdict === 'revoked') facts.acts = [{ text: 'restore', run: () => change('restore', loop) }];
  return facts;
}

function keyframeFacts(at: number, graph: Graph, scene: Scene): Facts {
  const { id, session, time, pose, covariance } = graph.keyframes;
  const [x, y, z] = pose.slice(POSE * at, POSE * at + 3);
  const c = covariance.slice(6 * at, 6 * at + 6);
  const [sx, sy, sz] = [c[0], c[3], c[5]].map((v) => Math.sqrt(Math.max(0, v)));
  const edges = graph.edges.filter(([from, to]) => from === at || to === at);
  const loops = graph.loops.filter((loop) => (loop.from === at || loop.to === at) && loop.verdict !== 'rejected');
  const off = graph.truth?.error[at];
  const weak = weakDirections(scene, at);
  return { title: `keyframe ${id[at]}`, rows: [['session', String(session[at])], ['time', clock(time[at])],
    ['x, y, z', xyz({ x, y, z })], ['1 sigma', [sx, sy, sz].map((s) => s.toFixed(3)).join(', ') + ' m'],
    ...(off === undefined ? [] : [['off the truth', metres(off)] as [string, string]]),
    ...(weak ? [['weakly held', weak] as [string, string]] : []), ['edges', String(edges.length)], ['loops', loops.map((loop) => `${loop.id} (${loop.verdict})`).join(', ') || 'none']] };
}

/** Of the keyframe's sweeps. */
function weakDirections(scene: Scene, at: number): string {
  const { sweep, none } = scene.weak;
  const of = sweep.map((_, i) => i).filter((i) => scene.sweeps.keyframe[sweep[i]] === at);
  if (of.length === 0) return '';
  const sweeps = new Set(of.map((i) => sweep[i])).size;
  return `${sweeps} ${sweeps === 1 ? 'sweep' : 'sweeps'}${of.some((i) => none[i]) ? ', not held at all by some' : ''}`;
}

export function pointFacts(point: FoundPoint, graph: Graph | null, scene: Scene): Facts {
  const rows: [string, string][] = [['x, y, z', xyz(point.p) + ' m']];
  if (graph && graph.keyframes.id.length > 0 && !scene.live) {
    rows.push(['keyframe', String(graph.keyframes.id[point.keyframe] ?? '–')]);
  }
  if (scene.seconds > 0) rows.push(['time', clock(point.moment / 65535 * scene.seconds)]);
  if (scene.intensity) rows.push(['intensity', point.intensity === null ? '–' : `${point.intensity} of 255`]);
  if (point.moving) rows.push(['seen through', 'other sweeps see through it: it has moved']);
  return { title: 'point', rows };
}
