// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A loop that somebody proposes, by two clicks: on the keyframe where it leads from, and on that where it leads to.
import { notice } from './elements';
import type { Act } from './facts';

export class Proposal {
  private from: number | null = null;  // id of a keyframe

  constructor(private readonly propose: (from: number, to: number) => void, private readonly changed: () => void) {}

  /** What a keyframe offers. */
  act(id: number): Act {
    const { from } = this;
    if (from === null) return { text: 'propose a loop', run: () => this.set(id, `Click the keyframe that a loop from ${id} leads to.`) };
    if (from === id) return { text: 'no loop', run: () => this.set(null, '') };
    return { text: `loop with ${from}`, run: () => {
      this.set(null, 'The loop is being verified …');
      this.propose(from, id);
    } };
  }

  private set(from: number | null, text: string): void {
    this.from = from;
    notice(text);
    this.changed();
  }
}
