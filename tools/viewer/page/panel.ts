// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The controls of the view, tied to its state.
import type { ColourBy } from './cloud_material';
import { element, input, labelled, select, swatch } from './elements';
import { LAYERS, type Layer } from './graph_layer';
import { RAMP, SERIES, theme } from './palette';
import type { Legend } from './picture';
import type { Graph, Scene } from './protocol';
import { colourOf } from './shown_keyframes';
import type { ViewState } from './view_state';

export interface Actions {
  changed(): void;
  reset(): void;
  above(): void;
  fly(): void;
  measure(): void;
  section(): void;
  play(): void;
  newest(): void;
  close(): void;
  picture(): void;
  export(): void;
}

const NAMES: Record<Layer, string> = { trajectory: 'trajectory', odometry: 'odometry', keyframes: 'keyframes',
  edges: 'constraints', loops: 'loops', rejected: 'rejected loops', ellipses: '3 sigma', fixes: 'GNSS', weak: 'weakly held', truth: 'truth' };

/** Each one once, in the order of keyframes. */
export function sessionsOf(graph: Graph): number[] {
  return [...new Set(graph.keyframes.session)];
}

/** Sessions that share a colour stand together. */
export function sessionKey(graph: Graph): [string, string][] {
  const sessions = sessionsOf(graph);
  return SERIES.slice(0, sessions.length).map((hex, i) =>
      [sessions.filter((_, at) => at % SERIES.length === i).join(', '), hex]);
}

export class Panel {
  private ramp: { least: string; most: string } | null = null;
  private key: [string, string][] = [];
  private readonly boxes = new Map<Layer, HTMLInputElement>();
  private offered = '';
  private colour: ColourBy = 'height';  // where the state has none

  constructor(private readonly state: ViewState, private readonly actions: Actions) {
    const on = (id: string, event: string, take: () => void): void =>
        element(id).addEventListener(event, () => { take(); actions.changed(); });
    on('colour', 'change', () => { state.colour = select('colour').value as ColourBy; });
    on('size', 'input', () => { state.size = Number(input('size').value); });
    on('shading', 'change', () => { state.shading = input('shading').checked; });
    on('moving', 'change', () => { state.moving = input('moving').checked; });
    on('grow', 'change', () => { state.grow = input('grow').checked; });
    select('budget').addEventListener('change', () => actions.changed());
    for (const name of ['reset', 'above', 'fly', 'measure', 'section', 'close', 'picture', 'export'] as const) {
      element(name).addEventListener('click', () => actions[name]());
    }
    addEventListener('keydown', (event) => this.pressedKey(event));
    if (innerWidth <= 640) element<HTMLDetailsElement>('panel').open = false;
    select('budget').value = innerWidth <= 640 || matchMedia('(pointer: coarse)').matches ? '1000000' : '3000000';
  }

  get budget(): number {
    return Number(select('budget').value);
  }

  /** What this scene can show is offered. */
  offer(scene: Scene, graph: Graph | null): void {
    element('title').textContent = scene.title;
    document.title = `${scene.title} – adit view`;
    element('program').textContent = `${scene.program}, with three.js (MIT licence).`;
    const has: Record<Layer, boolean> = {
      trajectory: scene.sweeps.time.length > 0,
      odometry: !!graph?.keyframes.id.length && !scene.live,
      keyframes: !!graph?.keyframes.id.length,
      edges: !!graph?.edges.length,
      loops: !!graph?.loops.some((loop) => loop.verdict !== 'rejected'),
      rejected: !!graph?.loops.some((loop) => loop.verdict === 'rejected'),
      ellipses: !!graph?.keyframes.covariance.some((v) => v > 0),
      fixes: !!graph?.fixes.length,
      weak: scene.weak.sweep.length > 0,
      truth: !!graph?.truth,
    };
    element('export').hidden = !scene.map;
    this.colour = colourOf(this.state, scene, graph);
    const options = [...select('colour').options];
    const intensity = options.find((one) => one.value === 'intensity')!;
    intensity.disabled = !scene.intensity;
    intensity.text = scene.intensity ? 'intensity' : 'intensity (has none)';
    options.find((one) => one.value === 'camera')!.disabled = !scene.colors;
    options.find((one) => one.value === 'time')!.disabled = !(scene.seconds > 0);
    const hasKeyframes = !!graph?.keyframes.id.length && !scene.live;
    for (const by of ['keyframe', 'moving']) options.find((one) => one.value === by)!.disabled = !hasKeyframes;
    options.find((one) => one.value === 'sigma')!.disabled = !hasKeyframes || !has.ellipses;
    options.find((one) => one.value === 'error')!.disabled = !hasKeyframes || !graph?.truth;
    options.find((one) => one.value === 'session')!.disabled = !hasKeyframes || sessionsOf(graph).length < 2;
    const offered = [theme().dark, ...LAYERS.filter((layer) => has[layer])].join();
    if (offered !== this.offered) this.offerLayers(has);  // else a box that is being clicked stays where it is
    this.offered = offered;
    this.show();
  }

  private offerLayers(has: Record<Layer, boolean>): void {
    this.boxes.clear();
    element('layers').replaceChildren(...LAYERS.filter((layer) => has[layer]).map((layer) => {
      const { label, box } = labelled('checkbox', NAMES[layer], this.markOf(layer));
      box.id = `layer-${layer}`;
      box.addEventListener('change', () => {
        this.state.layers = LAYERS.filter((one) => (one === layer ? box.checked : this.state.layers.includes(one)));
        this.actions.changed();
      });
      this.boxes.set(layer, box);
      return label;
    }));
  }

  /** The controls say what the state is. */
  show(): void {
    select('colour').value = this.state.colour ?? this.colour;
    input('size').value = String(this.state.size);
    input('shading').checked = this.state.shading;
    input('moving').checked = this.state.moving;
    input('grow').checked = this.state.grow;
    for (const [layer, box] of this.boxes) box.checked = this.state.layers.includes(layer);
  }

  /** What colours mean, of all that is shown. */
  legendOf(title: string): Legend {
    const shown = [...this.boxes].filter(([, box]) => box.checked);
    const key = this.key.map(([name, hex]): [string, string] => [this.state.colour === 'session' ? `session ${name}` : name, hex]);
    return { title, ramp: this.ramp && { name: this.state.colour ?? this.colour, ...this.ramp },
      swatches: [...key, ...shown.map(([layer]): [string, string] => [NAMES[layer], this.markOf(layer)])] };
  }

  /** `key`: what colours mean that are no ramp. */
  legend(least: string, most: string, ramp: boolean, key: [string, string][] = []): void {
    this.ramp = ramp ? { least, most } : null;
    this.key = key;
    element('key').replaceChildren(...key.flatMap(([name, hex]) => [swatch(hex), `${name} `]));
    element('scale').hidden = !ramp;
    element('least').textContent = least;
    element('most').textContent = most;
    element('ramp').style.background = `linear-gradient(to right, ${RAMP.join(', ')})`;
  }

  pressed(name: 'fly' | 'measure' | 'section', on: boolean): void {
    element(name).setAttribute('aria-pressed', String(on));
  }

  private markOf(layer: Layer): string {
    const { trajectory, odometry, keyframe, verdicts, truth } = theme();
    return { trajectory, odometry, keyframes: keyframe, edges: odometry, loops: verdicts.accepted, rejected: verdicts.rejected,
      ellipses: keyframe, fixes: verdicts.used, weak: verdicts.waiting, truth }[layer];
  }

  private pressedKey(event: KeyboardEvent): void {
    const at = event.target;
    const typing = at instanceof HTMLInputElement || at instanceof HTMLSelectElement;
    if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
    const run: Record<string, () => void> = { KeyR: () => this.actions.reset(), KeyT: () => this.actions.above(),
      KeyF: () => this.actions.fly(), KeyM: () => this.actions.measure(), KeyC: () => this.actions.section(),
      KeyP: () => this.actions.picture(), KeyX: () => this.actions.export(), KeyL: () => this.actions.newest(),
      Escape: () => this.actions.close() };
    if (event.code === 'Space' && !(at instanceof HTMLButtonElement)) {
      event.preventDefault();
      this.actions.play();
    } else run[event.code]?.();
  }
}
