// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The sensor's axes, where it is or was at the time that is shown.
import { Vector3, type Matrix4 } from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { poseMatrix } from './cloud';
import type { GraphLayer } from './graph_layer';
import { AXES, colour } from './palette';
import type { Live } from './protocol';

const LEAST = 0.5;          // m, of an axis
const SHARE = 0.04;         // of the eye's distance
const ABOVE = 100;          // all that is drawn over the cloud
const WIDTH = 3;            // px

export class Sensor extends LineSegments2 {
  constructor() {
    const geometry = new LineSegmentsGeometry();
    geometry.setPositions([0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1]);
    geometry.setColors(AXES.flatMap((hex) => [...colour(hex).toArray(), ...colour(hex).toArray()]));
    super(geometry, new LineMaterial({ linewidth: WIDTH, vertexColors: true, depthTest: false }));
    this.renderOrder = ABOVE;
    this.matrixAutoUpdate = false;
    this.frustumCulled = false;
  }

  /** Puts it there, `distance` from the eye; null: it is not shown. */
  place(pose: Matrix4 | null, distance: number): void {
    this.visible = pose !== null;
    if (!pose) return;
    const size = Math.max(LEAST, SHARE * distance);
    this.matrix.copy(pose).scale(new Vector3(size, size, size));
    this.matrixWorldNeedsUpdate = true;
  }
}

/** About the origin, at a time (s); of a run that goes on and no time, its newest. */
export function sensorPose(now: number | null, live: Live | null, layer: GraphLayer, origin: Vector3): Matrix4 | null {
  if (now !== null) return layer.poseAt(now);
  if (!live?.newest) return null;
  const pose = poseMatrix(live.newest.pose, 0);
  return pose.setPosition(pose.elements[12] - origin.x, pose.elements[13] - origin.y, pose.elements[14] - origin.z);
}
