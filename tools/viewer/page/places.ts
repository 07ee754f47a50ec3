// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a place of the map is on the Earth: the server is asked, whose coordinates are those of exports. And the place
// under the mouse.
import type { Vector3 } from 'three';
import { element } from './elements';
import type { Place, PlaceOnEarth } from './protocol';

const RESTS = 90;           // ms without a move, then the place under the mouse is looked for

type Row = [string, string];

/** For people; degrees to about a millimetre. */
export function worldRows(world: PlaceOnEarth): Row[] {
  const rows: Row[] = [['lat, lon', `${world.latitude.toFixed(8)}, ${world.longitude.toFixed(8)}`],
    ['height', `${world.altitude.toFixed(3)} m (ellipsoid)`]];
  if (world.utm) {
    const { zone, easting, northing } = world.utm;
    rows.push([`UTM ${zone}`, `${easting.toFixed(3)}, ${northing.toFixed(3)} m`]);
  }
  return rows;
}

export class Places {
  private readonly asked = new Map<string, (world: PlaceOnEarth) => void>();

  constructor(private readonly send: (message: object) => void) {}

  ask(p: Vector3, then: (world: PlaceOnEarth) => void): void {
    const place = p.toArray();
    this.asked.set(place.join(), then);
    this.send({ place });
  }

  take(answer: Place): void {
    const key = answer.p.join(), then = this.asked.get(key);
    this.asked.delete(key);
    if (answer.world) then?.(answer.world);
  }

  /** What was asked for will not come. */
  forget(): void {
    this.asked.clear();
  }
}

export class UnderMouse {
  private timer = 0;
  private place = '';

  /** `find` gives what is under the mouse, map frame; `onEarth` asks for its world, where the map has one. */
  constructor(canvas: HTMLCanvasElement, private readonly find: (x: number, y: number) => Vector3 | null,
              private readonly onEarth: (p: Vector3, then: (world: PlaceOnEarth) => void) => void) {
    canvas.addEventListener('pointermove', (event) => {
      clearTimeout(this.timer);
      if (event.pointerType !== 'mouse' || event.buttons !== 0) this.show(null);
      else this.timer = setTimeout(() => this.show(this.find(event.offsetX, event.offsetY)), RESTS);
    });
    for (const away of ['pointerleave', 'pointerdown', 'wheel'] as const) {
      canvas.addEventListener(away, () => {
        clearTimeout(this.timer);
        this.show(null);
      }, { passive: true });
    }
  }

  private show(p: Vector3 | null): void {
    const place = p ? p.toArray().map((v) => v.toFixed(3)).join(', ') : '';
    if (place === this.place) return;
    this.place = place;
    this.write(p ? [['x, y, z', `${place} m`]] : []);
    if (p) this.onEarth(p, (world) => { if (this.place === place) this.write([['x, y, z', `${place} m`], ...worldRows(world)]); });
  }

  private write(rows: Row[]): void {
    const under = element('under');
    under.hidden = rows.length === 0;
    under.replaceChildren(...rows.flatMap(([name, value]) => {
      const term = document.createElement('dt'), told = document.createElement('dd');
      term.textContent = name;
      told.textContent = value;
      return [term, told];
    }));
  }
}
