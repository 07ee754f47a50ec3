// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The table of sensors: how many of their measurements count, and what share each has in the estimate.
import { element, many } from './elements';
import type { Source } from './protocol';

const NAMES: Record<string, string> = { lidar: 'lidar', imu: 'IMU', velocity: 'wheels, radar or other odometry',
  doppler: 'Doppler', start: 'known at the start', odometry: 'odometry', loops: 'loops', gnss: 'GNSS',
  headings: 'headings', verticals: 'gravity, ground' };
const PARTS: Record<string, string> = { along: 'ahead', across: 'aside', up: 'up', rotation: 'turns', level: 'level',
  height: 'height', yaw: 'yaw' };
const LEAST = 0.005;  // of a share: it rounds to 1 %

const cell = (kind: 'td' | 'th', text: string): HTMLElement => {
  const one = document.createElement(kind);
  one.textContent = text;
  return one;
};

function row(kind: 'td' | 'th', texts: string[], title = ''): HTMLTableRowElement {
  const one = document.createElement('tr');
  one.append(...texts.map((text) => cell(kind, text)));
  one.title = title;
  return one;
}

function rowsOf(estimate: Source['estimate'], sources: Source[]): HTMLTableRowElement[] {
  const chosen = sources.filter((source) => source.estimate === estimate);
  if (chosen.length === 0) return [];
  const parts = Object.keys(chosen.find(({ shares }) => shares !== null)?.shares ?? {});
  const share = (value: number | undefined): string =>
    value === undefined ? '' : value < LEAST ? '–' : `${Math.round(100 * value)} %`;
  return [row('th', [estimate, 'used', 'refused', ...parts.map((part) => PARTS[part] ?? part)],
    'Share of what each source says about a part of the estimate'), ...chosen.map((source) => row('td', [
    [NAMES[source.name] ?? source.name, source.topic].filter((text) => text).join(' '),
    source.unit === '' ? '' : many(source.used), source.refused > 0 ? many(source.refused) : '',
    ...parts.map((part) => share(source.shares?.[part]))], source.remark ?? ''))];
}

let shown = '';

/** Where they have changed; the table is hidden where there are none. */
export function showSources(sources: Source[]): void {
  const text = JSON.stringify(sources);
  if (text === shown) return;
  shown = text;
  element('sources').hidden = sources.length === 0;
  element('worth').replaceChildren(...rowsOf('motion', sources), ...rowsOf('map', sources));
}
