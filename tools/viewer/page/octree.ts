// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which tiles are to be seen, by how far apart their points are on the screen.
import { Box3, Frustum, Matrix4, Vector3, type PerspectiveCamera } from 'three';
import type { Scene } from './protocol';

/** Where a tile is, m from the cloud's origin (the middle of its cube). */
export interface TilePlace { low: Vector3; edge: number; points: number; above: number; children: number[]; }  // above: -1, of the root

export interface Wanted {
  tiles: number[];    // parents before their children, the most important first
  points: number;
  whole: boolean;     // nothing was left out for want of budget
}

export class Octree {
  readonly tiles: TilePlace[] = [];

  constructor(scene: Scene) {
    const { parent, octant, points } = scene.tiles;
    parent.forEach((above, number) => {
      const root = number === 0;
      const edge = root ? scene.cube.edge : this.tiles[above].edge / 2;
      const low = root ? new Vector3().setScalar(-edge / 2) : this.tiles[above].low.clone().add(
          new Vector3(octant[number] & 1, (octant[number] >> 1) & 1, octant[number] >> 2).multiplyScalar(edge));
      this.tiles.push({ low, edge, points: points[number], above: root ? -1 : above, children: [] });
      if (!root) this.tiles[above].children.push(number);
    });
    this.cells = scene.cube.cells;
  }

  private readonly cells: number;

  /** Tiles to draw: as fine as `apart` (pixels between points) asks for and no more than `budget` points. */
  wanted(camera: PerspectiveCamera, height: number, apart: number, budget: number): Wanted {
    const frustum = new Frustum().setFromProjectionMatrix(
        new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    const scale = height / (2 * Math.tan(0.5 * camera.fov * Math.PI / 180));
    const box = new Box3();
    const spacing = (number: number): number => {
      const { low, edge } = this.tiles[number];
      box.min.copy(low);
      box.max.copy(low).addScalar(edge);
      if (!frustum.intersectsBox(box)) return -1;
      return scale * edge / this.cells / Math.max(box.distanceToPoint(camera.position), camera.near);
    };
    const result: Wanted = { tiles: [], points: 0, whole: true };
    const queue = new LargestFirst();
    if (this.tiles.length > 0) queue.push(0, Infinity);
    for (let number = queue.pop(); number !== undefined; number = queue.pop()) {
      const tile = this.tiles[number];
      if (result.points + tile.points > budget && result.tiles.length > 0) {
        result.whole = false;
        break;
      }
      result.tiles.push(number);
      result.points += tile.points;
      if (spacing(number) < apart) continue;
      for (const child of tile.children) {
        const size = spacing(child);
        if (size >= 0) queue.push(child, size);
      }
    }
    return result;
  }
}

/** A heap of numbers. */
class LargestFirst {
  private readonly entries: [number, number][] = [];

  push(number: number, size: number): void {
    const entries = this.entries;
    let at = entries.length;
    entries.push([number, size]);
    for (let above = (at - 1) >> 1; at > 0 && entries[above][1] < size; above = (at - 1) >> 1) {
      [entries[at], entries[above]] = [entries[above], entries[at]];
      at = above;
    }
  }

  pop(): number | undefined {
    const entries = this.entries;
    const top = entries[0];
    const last = entries.pop();
    if (top === undefined || last === undefined) return undefined;
    if (entries.length > 0) {
      entries[0] = last;
      for (let at = 0;;) {
        let largest = at;
        for (const below of [2 * at + 1, 2 * at + 2]) {
          if (below < entries.length && entries[below][1] > entries[largest][1]) largest = below;
        }
        if (largest === at) break;
        [entries[at], entries[largest]] = [entries[largest], entries[at]];
        at = largest;
      }
    }
    return top[0];
  }
}
