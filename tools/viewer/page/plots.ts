// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a run says of itself over time: small plots above the time line, which go with it.
import { element, labelled, plain } from './elements';
import { SERIES, theme } from './palette';
import type { PlotCurve, Plots as PlotsTold } from './protocol';

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
    const has = PLOTS.filter((name) => told?.curves.some((curve) => curve.name === name));
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
    this.canvas.hidden = height === 0;
    if (height === 0) return;
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
    const hex = SERIES[PLOTS.indexOf(curve.name as Plot) % SERIES.length];
    const range = rangeOf(curve);
    const scaled = (v: number): number => (curve.logarithmic ? Math.log10(Math.max(v, range.low)) : v);
    const low = scaled(range.low), high = scaled(range.high);
    const y = (v: number): number => top + WORDS + 2 + (HEIGHT - WORDS - 6) * (1 - (scaled(v) - low) / (high - low));
    const bins = curve.least.length;
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
      const x = (i + 0.5) / bins * width;
      if (i - before > GAP) context.moveTo(x, y(least));
      else context.lineTo(x, y(least));
      context.lineTo(x, y(most) - (most === least && i - before > GAP ? 1 : 0));
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
    context.fillStyle = align === 'left' && colours.dark ? colours.chosen : hex;
    context.fillText(told, x, y);
  }

  /** What is told of a time: one number, or the least and the most of it. */
  valueAt(curve: PlotCurve, seconds: number): string {
    const bins = curve.least.length;
    const at = Math.min(bins - 1, Math.floor(seconds / this.seconds * bins));
    const least = curve.least[at], most = curve.most[at];
    if (least === null || most === null) return plain(null, 0);
    const unit = curve.unit ? ` ${curve.unit}` : '';
    return text(least) === text(most) ? `${text(least)}${unit}` : `${text(least)} to ${text(most)}${unit}`;
  }

  curve(name: string): PlotCurve | null {
    return this.told?.curves.find((curve) => curve.name === name) ?? null;
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
