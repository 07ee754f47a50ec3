// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The command that exports what is shown: tools/commands/command_export.cpp knows these options.
import type { Scene } from './protocol';
import type { ViewState } from './view_state';

/** For a POSIX shell. */
export function quoted(text: string): string {
  return /^[\w@%+=:,./-]+$/.test(text) && !text.startsWith('-') ? text : `'${text.replaceAll("'", "'\\''")}'`;
}

/** Seconds of a stamp, to the nanosecond. */
function stampAt(scene: Scene, seconds: number): string {
  const stamp = BigInt(scene.start_ns) + BigInt(Math.round(seconds * 1e6)) * 1000n;
  const whole = stamp / 1_000_000_000n, rest = stamp % 1_000_000_000n;
  return `${whole}.${String(rest).padStart(9, '0')}`;
}

/** Of a box that is turned about its middle. */
function corners([x0, y0, , x1, y1, , turn]: number[]): [number, number][] {
  const c = Math.cos(turn * Math.PI / 180), s = Math.sin(turn * Math.PI / 180);
  const x = 0.5 * (x0 + x1), y = 0.5 * (y0 + y1);
  return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(([u, v]) =>
      [x + c * (u - x) - s * (v - y), y + s * (u - x) + c * (v - y)]);
}

/** Of a map; `time` null: all of it. */
export function exportCommand(scene: Scene, state: ViewState, time: number | null): string {
  const parts = ['adit', 'export', quoted(scene.map), '--cloud', 'ply', '--frame', 'map'];
  let before = '';
  if (state.box && state.box[6] === 0) {
    const [x0, y0, , x1, y1] = state.box;
    parts.push(`--box=${[x0, y0, x1, y1].map((v) => v.toFixed(2)).join(',')}`);
  } else if (state.box) {
    before = `printf '%b' '${corners(state.box).map(([x, y]) => `${x.toFixed(2)} ${y.toFixed(2)}\\n`).join('')}' > box.txt && `;
    parts.push('--polygon', 'box.txt');
  }
  if (!state.moving) parts.push('--without-moving');
  if (state.grow && time !== null) parts.push('--until', stampAt(scene, time));
  return before + [...parts, '-o', 'cloud.ply'].join(' ');
}

/** Also where a page may not use the clipboard, which is anywhere but on the own machine: it copies what is selected. */
export async function copied(text: string, shown: Element): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    getSelection()?.selectAllChildren(shown);
    return document.execCommand('copy');
  }
}
