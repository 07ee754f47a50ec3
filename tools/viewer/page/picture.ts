// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is seen as a picture: the canvas, and below it a strip with the scale bar and what colours mean.
import { drawMarks, MARKS_HEIGHT, MARKS_WIDTH, type MarksShown } from './marks';
import { RAMP, theme } from './palette';

const ROW = 21, EDGE = 12, SWATCH = 11, RAMP_WIDTH = 90;  // px
const NARROW = 640;         // px: the legend stands below the scale bar
const FONT = '12px system-ui, "DejaVu Sans", sans-serif';

export interface Legend {
  title: string;
  ramp: { name: string; least: string; most: string } | null;
  swatches: [string, string][];  // name, colour
}

interface Item { width: number; draw: (x: number, y: number) => void; }

/** The canvas must have been painted in the same task: a browser keeps no picture of it for longer. */
export function composed(canvas: HTMLCanvasElement, marks: MarksShown, legend: Legend): HTMLCanvasElement {
  const colours = theme();
  const ratio = canvas.width / canvas.clientWidth, width = canvas.clientWidth, height = canvas.clientHeight;
  const picture = document.createElement('canvas');
  const context = picture.getContext('2d')!;
  context.font = FONT;
  const narrow = width < NARROW;
  const left = narrow ? EDGE : MARKS_WIDTH;
  const placed = rows(items(context, legend), left, width - EDGE);
  const top = height + (narrow ? MARKS_HEIGHT : EDGE);
  const lowest = top + ROW * (1 + Math.max(...placed.map((item) => item.row)));
  picture.width = canvas.width;
  picture.height = Math.round(ratio * Math.max(height + MARKS_HEIGHT, lowest + EDGE / 2));
  context.fillStyle = colours.background;
  context.fillRect(0, 0, picture.width, picture.height);
  context.drawImage(canvas, 0, 0);
  context.scale(ratio, ratio);
  context.font = FONT;
  context.fillStyle = colours.odometry;
  context.fillRect(0, height, width, 1);
  drawMarks(context, marks, 0, height);
  for (const { item, x, row } of placed) {
    context.fillStyle = colours.chosen;
    context.textAlign = 'left';
    item.draw(x, top + ROW * row + 12);
  }
  return picture;
}

export function save(picture: HTMLCanvasElement, name: string): void {
  picture.toBlob((blob) => {
    if (!blob) return;
    const link = document.createElement('a');
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  }, 'image/png');
}

function items(context: CanvasRenderingContext2D, { title, ramp, swatches }: Legend): Item[] {
  const wide = (text: string): number => context.measureText(text).width;
  const made: Item[] = [{ width: wide(title), draw: (x, y) => context.fillText(title, x, y) }];
  if (ramp) {
    const before = `${ramp.name} ${ramp.least}`, first = wide(before) + 6;
    made.push({ width: first + RAMP_WIDTH + 6 + wide(ramp.most), draw: (x, y) => {
      context.fillText(before, x, y);
      context.fillText(ramp.most, x + first + RAMP_WIDTH + 6, y);
      const shades = context.createLinearGradient(x + first, 0, x + first + RAMP_WIDTH, 0);
      RAMP.forEach((hex, i) => shades.addColorStop(i / (RAMP.length - 1), hex));
      context.fillStyle = shades;
      context.fillRect(x + first, y - 10, RAMP_WIDTH, SWATCH);
    } });
  }
  for (const [name, hex] of swatches) {
    made.push({ width: SWATCH + 5 + wide(name), draw: (x, y) => {
      context.fillText(name, x + SWATCH + 5, y);
      context.fillStyle = hex;
      context.fillRect(x, y - 10, SWATCH, SWATCH);
    } });
  }
  return made;
}

function rows(all: Item[], left: number, right: number): { item: Item; x: number; row: number }[] {
  let x = left, row = 0;
  return all.map((item) => {
    if (x > left && x + item.width > right) {
      x = left;
      ++row;
    }
    const placed = { item, x, row };
    x += item.width + 18;
    return placed;
  });
}
