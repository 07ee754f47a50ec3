// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The time that is shown: scrubbed by hand, or going on. That of a run that goes on is the newest until somebody asks for
// another one, which then stays.
import { clock, element, input, select } from './elements';

export class TimeLine {
  /** s; null until somebody has asked for a time. */
  now: number | null = null;
  playing = false;
  private seconds = 0;
  private live = false;

  constructor(private readonly changed: () => void) {
    input('time').addEventListener('input', () => this.go(Number(input('time').value)));
    element('play').addEventListener('click', () => this.toggle());
    element('live').addEventListener('click', () => this.goLive());
  }

  set(seconds: number, now: number | null): void {
    this.live = false;
    this.seconds = seconds;
    this.now = now === null ? null : Math.min(Math.max(0, now), seconds);
    document.querySelector('footer')!.hidden = !(seconds > 0);
    this.show();
  }

  /** Of a run that goes on; how far it is, grow() tells. */
  setLive(now: number | null): void {
    this.live = true;
    this.seconds = 0;
    this.now = now;
    document.querySelector('footer')!.hidden = true;
    this.show();
  }

  grow(seconds: number): void {
    this.seconds = seconds;
    document.querySelector('footer')!.hidden = !(seconds > 0);
    const toCome = this.now !== null && this.now > seconds;  // asked for by a link
    if (toCome) this.now = null;
    this.show();
    if (toCome) this.changed();
  }

  go(now: number): void {
    this.now = Math.min(Math.max(0, now), this.seconds);
    if (this.live && this.now >= this.seconds) this.now = null;
    this.show();
    this.changed();
  }

  /** The newest, as it comes. */
  goLive(): void {
    if (!this.live) return;
    this.now = null;
    this.playing = false;
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
    const now = (this.now ?? 0) + seconds * Number(select('speed').value);
    if (now >= this.seconds) this.playing = false;
    this.go(now);
    return true;
  }

  private show(): void {
    input('time').max = String(this.seconds);
    input('time').value = String(this.now ?? this.seconds);
    element('play').textContent = this.playing ? 'pause' : 'play';
    element('live').setAttribute('aria-pressed', String(this.now === null));
    const all = clock(this.seconds);
    element('now').textContent = this.live && this.now === null ? all : `${clock(this.now ?? this.seconds)} / ${all}`;
  }
}
