// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Draws what map_page() embeds as `data`: a cloud and a trajectory, with WebGL 2 and nothing else.
// Drag turns, shift-drag or the right button shifts, the wheel or two fingers zoom, a click on the
// trajectory tells of that sweep.
'use strict';
const data = JSON.parse(document.getElementById('data').textContent);
const canvas = document.getElementById('view');
const told = document.getElementById('told');
const gl = canvas.getContext('webgl2', { antialias: true });
const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
const places = new Uint16Array(bytes(data.points.places).buffer);
const sweepOf = new Uint16Array(bytes(data.points.sweeps).buffer);
const intensity = bytes(data.points.intensity);
const count = sweepOf.length;
const poses = data.poses;
// From low to high: blue over green to yellow, told apart with any kind of colour vision.
const ramp = ['3b3f8f', '3a5ba0', '3778a8', '3794a6', '45ae94', '6fc378', 'a5d05a', 'dcd64a']
    .map((hex) => [0, 2, 4].map((at) => parseInt(hex.substr(at, 2), 16)));
// None of them is in the ramp.
const stateColours = { tracking: [213, 94, 0], initializing: [120, 120, 120],
                       coasting: [204, 51, 153], restarted: [120, 120, 120] };

function rampColour(share) {
  const at = Math.min(Math.max(share, 0), 1) * (ramp.length - 1);
  const low = Math.min(Math.floor(at), ramp.length - 2);
  return [0, 1, 2].map((k) => ramp[low][k] + (at - low) * (ramp[low + 1][k] - ramp[low][k]));
}

// --- vectors and matrices, column by column ---------------------------------------------------

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const sum = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// --- what is looked at ------------------------------------------------------------------------

const low = data.points.low, step = data.points.step;
const position = (i) => [0, 1, 2].map((k) => low[k] + step * places[3 * i + k]);
function bounds() {
  const all = poses.map((pose) => pose.p);
  for (let i = 0; i < count; i += Math.ceil(count / 20000) || 1) all.push(position(i));
  if (all.length === 0) all.push([0, 0, 0]);
  const quantile = (k, share) => {
    const values = all.map((p) => p[k]).sort((a, b) => a - b);
    return values[Math.floor(share * (values.length - 1))];
  };
  return [0, 1, 2].map((k) => [quantile(k, 0.01), quantile(k, 0.99)]);
}
const box = bounds();
const size = Math.max(5, Math.hypot(...box.map(([a, b]) => b - a)));
const initial = () => ({ target: box.map(([a, b]) => 0.5 * (a + b)), distance: 0.9 * size,
                         yaw: -0.6, pitch: 0.9 });
let eye = initial();

function camera() {
  const flat = Math.cos(eye.pitch);
  const back = [flat * Math.cos(eye.yaw), flat * Math.sin(eye.yaw), Math.sin(eye.pitch)];
  const right = [-Math.sin(eye.yaw), Math.cos(eye.yaw), 0];
  const up = cross(back, right);
  const from = sum(eye.target, times(back, eye.distance));
  const f = 1.8, near = eye.distance / 200, far = eye.distance + 4 * size;
  const aspect = canvas.width / canvas.height;
  const view = (axis) => [...axis, -dot(axis, from)];
  const rows = [view(right).map((v) => v * f / Math.max(aspect, 1)),
                view(up).map((v) => v * f * Math.min(aspect, 1)),
                view(back).map((v, k) => v * (far + near) / (near - far) + (k === 3 ? 2 * far * near / (near - far) : 0)),
                view(back).map((v) => -v)];
  const matrix = new Float32Array(16);
  rows.forEach((row, r) => row.forEach((v, c) => { matrix[4 * c + r] = v; }));
  return { matrix, right, up, from };
}

function onScreen(matrix, p) {
  const at = (r) => matrix[r] * p[0] + matrix[4 + r] * p[1] + matrix[8 + r] * p[2] + matrix[12 + r];
  const w = at(3);
  return w > 0 ? [(0.5 + 0.5 * at(0) / w) * canvas.clientWidth, (0.5 - 0.5 * at(1) / w) * canvas.clientHeight] : null;
}

// --- drawing ----------------------------------------------------------------------------------

function program(vertex, fragment) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, '#version 300 es\nprecision highp float;\n' + text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  return made;
}

function attribute(array, location, width, type, normalized) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
  gl.enableVertexAttribArray(location);
  gl.vertexAttribPointer(location, width, type, normalized, 0, 0);
  return buffer;
}

let shown, cloud, colours, path;
function prepare() {
  shown = program(`
    layout(location = 0) in vec3 place; layout(location = 1) in vec3 colour;
    uniform mat4 view; uniform vec3 low; uniform float step; uniform float size; out vec3 c;
    void main() { c = colour; gl_Position = view * vec4(low + step * place, 1.0); gl_PointSize = size; }`,
    'in vec3 c; out vec4 o; void main() { o = vec4(c, 1.0); }');
  cloud = gl.createVertexArray();
  gl.bindVertexArray(cloud);
  attribute(places, 0, 3, gl.UNSIGNED_SHORT, false);
  colours = attribute(new Uint8Array(3 * count), 1, 3, gl.UNSIGNED_BYTE, true);
  path = gl.createVertexArray();
  gl.bindVertexArray(path);
  attribute(new Float32Array(poses.flatMap((pose) => pose.p)), 0, 3, gl.FLOAT, false);
  attribute(new Uint8Array(poses.flatMap((pose) => stateColours[pose.state] || [128, 128, 128])), 1, 3, gl.UNSIGNED_BYTE, true);
}

function colourBy(kind) {
  const values = new Float32Array(count);
  for (let i = 0; i < count; ++i) {
    values[i] = kind === 'height' ? places[3 * i + 2]
        : kind === 'intensity' ? intensity[i]
        : kind === 'time' ? sweepOf[i]
        : (poses[sweepOf[i]] || { sigma: 0 }).sigma || 0;
  }
  const sorted = Float32Array.from(values).sort();
  const from = sorted[Math.floor(0.02 * count)] || 0, to = sorted[Math.floor(0.98 * (count - 1))] || 1;
  const bytesOf = new Uint8Array(3 * count);
  for (let i = 0; i < count; ++i) bytesOf.set(rampColour((values[i] - from) / Math.max(to - from, 1e-9)), 3 * i);
  gl.bindBuffer(gl.ARRAY_BUFFER, colours);
  gl.bufferData(gl.ARRAY_BUFFER, bytesOf, gl.STATIC_DRAW);
  const timeOf = (i) => (poses[Math.round(i)] || { time: 0 }).time;
  const [least, most, unit] = kind === 'height' ? [low[2] + step * from, low[2] + step * to, 'm']
      : kind === 'time' ? [timeOf(from), timeOf(to), 's']
      : kind === 'uncertainty' ? [from, to, 'm (1 sigma)'] : [from, to, 'of 255'];
  document.getElementById('scale').hidden = count === 0;
  document.getElementById('least').textContent = least.toPrecision(3);
  document.getElementById('ramp').style.background =
      `linear-gradient(to right, ${ramp.map((colour) => `rgb(${colour})`).join(', ')})`;
  document.getElementById('most').textContent = `${most.toPrecision(3)} ${unit}`;
  draw();
}

let waiting = false;
function draw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    const dense = window.devicePixelRatio || 1;
    canvas.width = canvas.clientWidth * dense;
    canvas.height = canvas.clientHeight * dense;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...(matchMedia('(prefers-color-scheme: dark)').matches ? [0.08, 0.09, 0.11] : [1, 1, 1]), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.useProgram(shown);
    const at = (name) => gl.getUniformLocation(shown, name);
    gl.uniformMatrix4fv(at('view'), false, camera().matrix);
    gl.uniform3fv(at('low'), low);
    gl.uniform1f(at('step'), step);
    gl.uniform1f(at('size'), dense * Number(document.getElementById('size').value));
    if (document.getElementById('points').checked) {
      gl.bindVertexArray(cloud);
      gl.drawArrays(gl.POINTS, 0, count);
    }
    gl.disable(gl.DEPTH_TEST);
    gl.uniform3fv(at('low'), [0, 0, 0]);
    gl.uniform1f(at('step'), 1);
    gl.uniform1f(at('size'), 4 * dense);
    gl.bindVertexArray(path);
    gl.drawArrays(gl.LINE_STRIP, 0, poses.length);
    gl.drawArrays(gl.POINTS, 0, poses.length);
  });
}

// --- hands ------------------------------------------------------------------------------------

const fingers = new Map();
let moved = 0;
function turn(dx, dy) {
  eye.yaw -= 0.006 * dx;
  eye.pitch = Math.min(1.57, Math.max(-1.57, eye.pitch + 0.006 * dy));
}
function shift(dx, dy) {
  const { right, up } = camera();
  const metres = eye.distance / canvas.clientHeight;
  eye.target = sum(eye.target, sum(times(right, -dx * metres), times(up, dy * metres)));
}
function zoom(factor) { eye.distance = Math.min(10 * size, Math.max(0.01 * size, eye.distance * factor)); }
function tell(x, y) {
  const { matrix } = camera();
  let best = null, least = 14;
  for (const pose of poses) {
    const s = onScreen(matrix, pose.p);
    const off = s ? Math.hypot(s[0] - x, s[1] - y) : Infinity;
    if (off < least) { least = off; best = pose; }
  }
  told.hidden = !best;
  if (best) told.replaceChildren(...Object.entries(data.columns).flatMap(([key, name]) => {
    const term = document.createElement('dt'), value = document.createElement('dd');
    term.textContent = name;
    value.textContent = key === 'p' ? best.p.map((v) => v.toFixed(2)).join(', ') : best[key] ?? '';
    return [term, value];
  }));
}
canvas.addEventListener('pointerdown', (event) => {
  canvas.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
  moved = 0;
});
canvas.addEventListener('pointermove', (event) => {
  const before = fingers.get(event.pointerId);
  if (!before) return;
  const now = [event.offsetX, event.offsetY];
  const dx = now[0] - before[0], dy = now[1] - before[1];
  moved += Math.abs(dx) + Math.abs(dy);
  if (fingers.size === 2) {
    const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
    const apart = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
    zoom(apart(before) / Math.max(apart(now), 1));
    shift(0.5 * dx, 0.5 * dy);
  } else if (event.shiftKey || event.buttons === 2) shift(dx, dy);
  else turn(dx, dy);
  fingers.set(event.pointerId, now);
  draw();
});
for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (event) => {
  if (end === 'pointerup' && moved < 5) tell(event.offsetX, event.offsetY);
  fingers.delete(event.pointerId);
});
canvas.addEventListener('contextmenu', (event) => event.preventDefault());
canvas.addEventListener('wheel', (event) => { event.preventDefault(); zoom(Math.exp(0.001 * event.deltaY)); draw(); }, { passive: false });
document.getElementById('colour').addEventListener('change', (event) => colourBy(event.target.value));
for (const name of ['size', 'points']) document.getElementById(name).addEventListener('input', draw);
document.getElementById('above').addEventListener('click', () => { eye = { ...initial(), pitch: 1.57, yaw: -1.5708 }; draw(); });
document.getElementById('reset').addEventListener('click', () => { eye = initial(); draw(); });
addEventListener('resize', draw);
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);

for (const state of new Set(poses.map((pose) => pose.state))) {
  const entry = document.createElement('span');
  entry.textContent = `\u25a0 ${state} `;
  entry.style.color = `rgb(${stateColours[state] || [128, 128, 128]})`;
  document.getElementById('states').append(entry);
}
if (gl) {
  prepare();
  colourBy('height');
} else {
  document.getElementById('problem').textContent =
      'This browser has no WebGL 2, which the view needs. map.ply opens in any viewer of point clouds.';
}
