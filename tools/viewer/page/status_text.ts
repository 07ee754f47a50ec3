// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How much is drawn, and what a run does that goes on.
import { many } from './elements';
import type { Live, Scene } from './protocol';
import type { ShownCloud } from './shown_cloud';

export function statusText(scene: Scene, { drawn, missing }: ShownCloud, live: Live | null): string {
  if (scene.live) return live ? `${runText(live)}; ${many(drawn)} points` : 'the run: starting';
  if (scene.points === 0) return 'no points';
  return `${many(drawn)} of ${many(scene.points)} points${missing > 0 ? `, ${missing} tiles to come` : ''}`;
}

function runText({ doing, progress }: Live): string {
  const { sweeps, of, failed, verdict } = progress;
  const counted = sweeps === 0 ? '' : `; ${sweeps} of ${of} sweeps${failed > 0 ? `, ${failed} failed` : ''}, ${verdict} so far`;
  return `the run: ${doing}${counted}`;
}
