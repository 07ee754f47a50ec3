// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How far apart points are where they lie, so that they are drawn as large as the gaps between them: a wall is a wall,
// whether its points are 2 cm apart or 20.
import type { Vector3 } from 'three';
import { POINT, type TilePoints } from './protocol';

const MOST_CELLS = 32;      // of a tile's edge
const FEWEST_CELLS = 4;
const IN_CELL = 12;         // points, on a surface that goes through the whole tile
const LEAST = 4;            // points of a cell that tell how far apart they are; fewer are no surface,
const SPARSE = 0.4;         // m, nor are points so far apart
const STEPS = 65536;        // of a place, in the edge of its tile

/** A distance as a byte, as the shader has it back: 2^(code / 16 - 10) m, from a millimetre on. */
export const METRES = 'exp2(spacing / 16.0 - 10.0)';
const codeOf = (metres: number): number => Math.max(1, Math.min(255, Math.round(16 * (Math.log2(metres) + 10))));

/** Of the points of a tile among all that are drawn with it. */
export class Spacing {
  /** Of each point; 0: it lies alone, and stays small. */
  readonly codes: Uint8Array<ArrayBuffer>;
  private readonly side: number;      // cells along the tile's edge
  private readonly cells: Uint8Array;

  constructor(private readonly tile: TilePoints, private readonly low: Vector3, private readonly edge: number, above: Spacing[]) {
    const places: number[] = [];
    for (const one of [this, ...above]) one.eachIn(this, (_, x, y, z) => places.push(x, y, z));
    const side = this.side = Math.max(FEWEST_CELLS, Math.min(MOST_CELLS, Math.round(Math.sqrt(places.length / 3 / IN_CELL))));
    const numbers = new Uint32Array(side ** 3);
    for (let i = 0; i < places.length; i += 3) ++numbers[this.cell(places[i], places[i + 1], places[i + 2])];
    this.cells = Uint8Array.from(numbers, (number) => {
      const apart = edge / side / Math.sqrt(number);
      return number < LEAST || apart > SPARSE ? 0 : codeOf(apart);
    });
    this.codes = Uint8Array.from({ length: tile.count },
        (_, i) => this.cells[this.cell(places[3 * i], places[3 * i + 1], places[3 * i + 2])]);
    const known = this.codes.filter((code) => code > 0).sort();
    const most = known[known.length >> 1] ?? 0;
    this.codes.forEach((code, i) => { this.codes[i] = Math.min(code, most); });
  }

  /** Points of a tile below this one lie between this one's. Returns whether that changes anything. */
  refine(below: Spacing): boolean {
    let changes = false;
    this.eachIn(below, (i, x, y, z) => {
      const code = below.cells[below.cell(x, y, z)];
      if (code >= this.codes[i]) return;
      this.codes[i] = code;
      changes = true;
    });
    return changes;
  }

  /** This tile's points in the cube of one, with their shares of its edge. */
  private eachIn(one: Spacing, take: (i: number, x: number, y: number, z: number) => void): void {
    const { values, count } = this.tile;
    const scale = this.edge / STEPS / one.edge;
    const shift = this.low.clone().sub(one.low).divideScalar(one.edge);
    for (let i = 0, at = 0; i < count; ++i, at += POINT) {
      const x = scale * values[at] + shift.x, y = scale * values[at + 1] + shift.y, z = scale * values[at + 2] + shift.z;
      if (x >= 0 && y >= 0 && z >= 0 && x < 1 && y < 1 && z < 1) take(i, x, y, z);
    }
  }

  private cell(x: number, y: number, z: number): number {
    const { side } = this;
    return (Math.floor(side * z) * side + Math.floor(side * y)) * side + Math.floor(side * x);
  }
}
