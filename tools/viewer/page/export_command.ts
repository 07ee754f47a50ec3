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

/** Of a map; `time` null: all of it. */
export function exportCommand(scene: Scene, state: ViewState, time: number | null): string {
  const parts = ['adit', 'export', quoted(scene.map), '--cloud', 'ply', '--frame', 'map'];
  if (state.box) {
    const [x0, y0, , x1, y1] = state.box;
    parts.push(`--box=${[x0, y0, x1, y1].map((v) => v.toFixed(2)).join(',')}`);
  }
  if (!state.moving) parts.push('--without-moving');
  if (state.grow && time !== null) parts.push('--until', stampAt(scene, time));
  return [...parts, '-o', 'cloud.ply'].join(' ');
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
