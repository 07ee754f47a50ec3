// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
import { element } from './elements';
import { View } from './view';

try {
  const view = new View();
  // For tests and for who writes a script in the browser's console.
  Object.assign(window, { adit: view });
} catch (error) {
  element('status').textContent = `This browser cannot draw the map, which needs WebGL 2 (${error}). ` +
      'map.html, which a run leaves, and map.ply may do.';
}
