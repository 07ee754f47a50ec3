// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The time that is shown: scrubbed by hand, or going on.
import { clock, element, input, select } from './elements';

export class TimeLine {
  /** s; null until somebody has asked for a time. */
  now: number | null = null;
  playing = false;
  private seconds = 0;

  constructor(private readonly changed: () => void) {
    input('time').addEventListener('input', () => this.go(Number(input('time').value)));
    element('play').addEventListener('click', () => this.toggle());
  }

  set(seconds: number, now: number | null): void {
    this.seconds = seconds;
    this.now = now === null ? null : Math.min(Math.max(0, now), seconds);
    input('time').max = String(seconds);
    document.querySelector('footer')!.hidden = !(seconds > 0);
    this.show();
  }

  /** Of a run that goes on there is no time to choose, but the one it has reached. */
  tell(now: number): void {
    document.querySelector('footer')!.hidden = false;
    element('now').textContent = clock(now);
  }

  go(now: number): void {
    this.now = Math.min(Math.max(0, now), this.seconds);
    this.show();
    this.changed();
  }

  toggle(): void {
    if (!(this.seconds > 0)) return;
    this.playing = !this.playing;
    if (this.playing && (this.now === null || this.now >= this.seconds)) this.now = 0;
    this.show();
    this.changed();
  }

  /** Time goes on by so many seconds of the clock on the wall. Returns whether it plays. */
  step(seconds: number): boolean {
    if (!this.playing) return false;
    this.now = Math.min(this.seconds, (this.now ?? 0) + seconds * Number(select('speed').value));
    if (this.now >= this.seconds) this.playing = false;
    this.show();
    this.changed();
    return true;
  }

  private show(): void {
    input('time').value = String(this.now ?? this.seconds);
    element('play').textContent = this.playing ? 'pause' : 'play';
    element('now').textContent = `${clock(this.now ?? this.seconds)} / ${clock(this.seconds)}`;
  }
}
