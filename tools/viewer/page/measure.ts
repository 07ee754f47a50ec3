// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The distance between two points of the cloud.
import { BufferGeometry, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial, type Vector3 } from 'three';
import type { Facts } from './facts';
import { colour, theme } from './palette';

export class Measure {
  readonly group = new Group();
  ends: Vector3[] = [];      // map frame

  /** Another end, map frame; the third begins anew. */
  add(p: Vector3, origin: Vector3): Facts {
    this.ends = this.ends.length === 2 ? [p] : [...this.ends, p];
    this.draw(origin);
    if (this.ends.length < 2) return { title: 'measure', rows: [['from', text(p)], ['to', 'click a second point']] };
    const [a, b] = this.ends;
    const flat = Math.hypot(b.x - a.x, b.y - a.y);
    return { title: `${a.distanceTo(b).toFixed(3)} m`, rows: [['from', text(a)], ['to', text(b)],
      ['horizontally', `${flat.toFixed(3)} m`], ['height', `${(b.z - a.z).toFixed(3)} m`]] };
  }

  clear(): void {
    this.ends = [];
    this.group.clear();
  }

  private draw(origin: Vector3): void {
    this.group.clear();
    const geometry = new BufferGeometry().setFromPoints(this.ends.map((p) => p.clone().sub(origin)));
    const line = new LineBasicMaterial({ depthTest: false });
    const dot = new PointsMaterial({ size: 8, sizeAttenuation: false, depthTest: false });
    for (const material of [line, dot]) material.color.copy(colour(theme().chosen));
    for (const one of [new LineSegments(geometry, line), new Points(geometry, dot)]) {
      one.frustumCulled = false;
      this.group.add(one);
    }
  }
}

const text = (p: Vector3): string => [p.x, p.y, p.z].map((v) => v.toFixed(3)).join(', ');
