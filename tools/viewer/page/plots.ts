// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a run says of itself over time: small plots above the time line, which go with it.
import { element, labelled, plain } from './elements';
import { theme } from './palette';
import type { Live, PlotCurve, Plots as PlotsTold } from './protocol';

export const PLOTS = ['overlap', 'sigma', 'rms', 'NIS'] as const;
export type Plot = (typeof PLOTS)[number];

const HEIGHT = 40;          // px, of a plot, and of its words above the curve
const WORDS = 13;
const STRIP = 6;            // px, of stretches that the run does not vouch for
const GAP = 3;              // times without a value that a curve goes on over
const FONT = '11px system-ui, "DejaVu Sans", sans-serif';

interface Range { low: number; high: number; }

export class Plots {
  private told: PlotsTold | null = null;
  private seconds = 0;
  private begin = 0;          // s, of the curves' first time
  private step = 0;           // s, of each of their times
  private now: number | null = null;
  private readonly canvas = element<HTMLCanvasElement>('plots');
  private readonly boxes = new Map<Plot, HTMLInputElement>();

  /** `go` is called with the time that is pointed at, `changed` with the plots that are wanted. */
  constructor(private shown: Plot[], private readonly go: (seconds: number) => void,
              private readonly changed: (shown: Plot[]) => void) {
    const point = (event: PointerEvent): void => {
      if ((event.buttons & 1) !== 0) this.go(event.offsetX / this.canvas.clientWidth * this.seconds);
    };
    this.canvas.addEventListener('pointerdown', (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      point(event);
    });
    this.canvas.addEventListener('pointermove', (event) => {
      point(event);
      this.canvas.title = this.stretchesAt(event.offsetX / this.canvas.clientWidth * this.seconds);
    });
    addEventListener('resize', () => this.draw());
  }

  set(told: PlotsTold | null, seconds: number): void {
    this.told = told;
    this.seconds = seconds;
    this.begin = 0;
    this.step = seconds / Math.max(1, told?.curves[0]?.least.length ?? 0);
    this.offer();
  }

  /** Of a run that goes on, what has come since. */
  grow({ seconds, plots, stretches }: Live): void {
    if (!this.told) return;
    this.seconds = seconds;
    if (stretches) this.told.stretches = stretches;
    if (plots) {
      this.begin = plots.begin;
      this.step = plots.step;
      this.told.curves.forEach((curve, i) => {
        curve.least.splice(plots.from, Infinity, ...plots.least[i]);
        curve.most.splice(plots.from, Infinity, ...plots.most[i]);
      });
    }
    const has = PLOTS.filter((name) => this.curve(name));
    if (has.length !== this.boxes.size) this.offer();
    else this.draw();
  }

  private offer(): void {
    const has = PLOTS.filter((name) => this.curve(name));
    this.boxes.clear();
    element('plotted').hidden = has.length === 0;
    element('plotted').replaceChildren('plots ', ...has.map((name) => {
      const { label, box } = labelled('checkbox', name);
      const curve = this.curve(name)!;
      label.title = curve.title;
      box.id = `plot-${name}`;
      box.addEventListener('change', () => {
        this.shown = PLOTS.filter((one) => (one === name ? box.checked : this.shown.includes(one)));
        this.changed(this.shown);
        this.draw();
      });
      this.boxes.set(name, box);
      return label;
    }));
    this.show(this.shown);
  }

  show(shown: Plot[]): void {
    this.shown = shown;
    for (const [name, box] of this.boxes) box.checked = shown.includes(name);
    this.draw();
  }

  at(now: number | null): void {
    if (now === this.now) return;
    this.now = now;
    this.draw();
  }

  draw(): void {
    const curves = this.shown.map((name) => this.curve(name)).filter((curve) => curve !== null);
    const stretches = this.told?.stretches ?? [];
    const height = HEIGHT * curves.length + (stretches.length > 0 ? STRIP : 0);
    this.canvas.hidden = height === 0 || !(this.seconds > 0);
    if (this.canvas.hidden) return;
    this.canvas.style.height = `${height}px`;
    const width = this.canvas.clientWidth, ratio = Math.min(devicePixelRatio, 2);
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const context = this.canvas.getContext('2d')!;
    context.scale(ratio, ratio);
    context.font = FONT;
    const colours = theme();
    const x = (seconds: number): number => seconds / this.seconds * width;
    for (const { state, begin, end } of stretches) {
      context.fillStyle = state === 'lost' ? colours.verdicts.rejected : colours.verdicts.waiting;
      const wide = Math.max(2, x(end) - x(begin));
      context.fillRect(x(begin), 0, wide, STRIP);
      context.globalAlpha = 0.18;
      context.fillRect(x(begin), 0, wide, height);
      context.globalAlpha = 1;
    }
    curves.forEach((curve, i) => this.drawCurve(context, curve, height - HEIGHT * (curves.length - i), width));
    if (this.now === null) return;
    context.fillStyle = colours.chosen;
    context.fillRect(Math.min(width - 1, x(this.now)), 0, 1, height);
  }

  private drawCurve(context: CanvasRenderingContext2D, curve: PlotCurve, top: number, width: number): void {
    const colours = theme();
    const hex = colours.plots[PLOTS.indexOf(curve.name as Plot)];
    const range = rangeOf(curve);
    const scaled = (v: number): number => (curve.logarithmic ? Math.log10(Math.max(v, range.low)) : v);
    const low = scaled(range.low), high = scaled(range.high);
    const y = (v: number): number => top + WORDS + 2 + (HEIGHT - WORDS - 6) * (1 - (scaled(v) - low) / (high - low));
    const x = (bin: number): number => Math.min(width, Math.max(0, (this.begin + (bin + 0.5) * this.step) / this.seconds * width));
    context.fillStyle = colours.odometry;
    context.globalAlpha = 0.25;
    context.fillRect(0, top + HEIGHT - 1, width, 1);
    context.globalAlpha = 1;
    context.strokeStyle = hex;
    context.lineWidth = 1.2;
    context.beginPath();
    let before = -Infinity;
    curve.least.forEach((least, i) => {
      const most = curve.most[i];
      if (least === null || most === null) return;
      if (i - before > GAP) context.moveTo(x(i), y(least));
      else context.lineTo(x(i), y(least));
      context.lineTo(x(i), y(most) - (most === least && i - before > GAP ? 1 : 0));
      before = i;
    });
    context.stroke();
    const told = this.now === null ? '' : ` ${this.valueAt(curve, this.now)}`;
    this.write(context, `${curve.name}${told}`, 1, top + 11, 'left', hex);
    const unit = curve.unit ? ` ${curve.unit}` : '';
    this.write(context, `${text(range.low)} … ${text(range.high)}${unit}`, width - 1, top + 11, 'right', colours.odometry);
  }

  private write(context: CanvasRenderingContext2D, told: string, x: number, y: number, align: CanvasTextAlign, hex: string): void {
    const colours = theme();
    context.textAlign = align;
    context.lineJoin = 'round';
    context.strokeStyle = colours.background;
    context.lineWidth = 3;
    context.strokeText(told, x, y);
    context.fillStyle = hex;
    context.fillText(told, x, y);
  }

  /** What is told of a time: one number, or the least and the most of it. */
  valueAt(curve: PlotCurve, seconds: number): string {
    const at = Math.min(curve.least.length - 1, Math.max(0, Math.floor((seconds - this.begin) / this.step)));
    const least = curve.least[at] ?? null, most = curve.most[at] ?? null;
    if (least === null || most === null) return plain(null, 0);
    const unit = curve.unit ? ` ${curve.unit}` : '';
    return text(least) === text(most) ? `${text(least)}${unit}` : `${text(least)} to ${text(most)}${unit}`;
  }

  /** Where something is known of it. */
  curve(name: string): PlotCurve | null {
    return this.told?.curves.find((curve) => curve.name === name && curve.least.some((value) => value !== null)) ?? null;
  }

  private stretchesAt(seconds: number): string {
    return (this.told?.stretches ?? []).filter(({ begin, end }) => begin <= seconds && seconds <= end)
        .map(({ text: why }) => why).join('\n');
  }
}

const text = (value: number): string => String(Number(value.toPrecision(3)));

/** Never without an extent. */
function rangeOf(curve: PlotCurve): Range {
  const usable = (v: number | null): v is number => v !== null && (!curve.logarithmic || v > 0);
  const low = curve.least.filter(usable).reduce((a, b) => Math.min(a, b), Infinity);
  const high = curve.most.filter(usable).reduce((a, b) => Math.max(a, b), -Infinity);
  if (!(low <= high)) return { low: 1, high: 10 };
  return { low, high: high > low ? high : low + (Math.abs(low) || 1) };
}
