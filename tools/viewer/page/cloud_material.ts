// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How points are drawn: where their keyframe is now, by which of their facts they are coloured, and which are hidden.
import { DataTexture, FloatType, GLSL3, RawShaderMaterial, RedFormat, RGBAFormat, Vector2, Vector3 } from 'three';
import { colour, rampTexture, SERIES } from './palette';
import { METRES } from './spacing';

export const COLOURS = ['height', 'intensity', 'time', 'keyframe', 'session', 'moving', 'sigma', 'error', 'camera'] as const;
export type ColourBy = (typeof COLOURS)[number];

const CLOSE = 0.012;        // m: points near to the eye are drawn as large as this for each pixel of their size
const GAP = 0.85;           // of how far points are apart, for each pixel of their size: at 2 they cover nine tenths
const MOST_SIZE = 10;       // pixels, for each pixel of their size
const DISC = '5.0';         // pixels: larger points are round

const VERTEX = `
precision highp float;
precision highp int;
precision highp sampler2D;
in vec3 place;
in vec3 facts;
in float spacing;
in vec3 own;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
uniform sampler2D corrections;
uniform bool corrected;
uniform float keyframeScale;
uniform sampler2D sessions;
uniform sampler2D ramp;
uniform int colourBy;
uniform vec2 heights;
uniform vec3 series[${SERIES.length}];
uniform float size, closeSize, gapSize, mostSize;
uniform vec3 boxMiddle, boxHalf;
uniform vec2 boxTurn;
uniform float until;
uniform bool hideMoving;
uniform float only, other;
uniform sampler2D values;
out vec3 shade;
flat out float pixels;

int position(float keyframe) {
  return int(keyframe * keyframeScale + 0.5);
}

vec3 moved(vec3 p, float keyframe) {
  int at = 3 * position(keyframe);
  int width = textureSize(corrections, 0).x;
  vec4 q = vec4(p, 1.0);
  vec3 result;
  for (int row = 0; row < 3; ++row) {
    result[row] = dot(texelFetch(corrections, ivec2((at + row) % width, (at + row) / width), 0), q);
  }
  return result;
}

float ofKeyframe(sampler2D numbers, float keyframe) {
  int at = position(keyframe), width = textureSize(numbers, 0).x;
  return texelFetch(numbers, ivec2(at % width, at / width), 0).r;
}

bool outside(vec3 p) {
  vec3 q = p - boxMiddle;
  q.xy = vec2(dot(boxTurn, q.xy), boxTurn.x * q.y - boxTurn.y * q.x);
  return any(greaterThan(abs(q), boxHalf));
}

void main() {
  vec3 p = (modelMatrix * vec4(place + 0.5, 1.0)).xyz;
  if (corrected) p = moved(p, facts.y);
  gl_Position = projectionMatrix * viewMatrix * vec4(p, 1.0);
  gl_PointSize = clamp(max(closeSize, gapSize * ${METRES}) / gl_Position.w, size, mostSize);
  pixels = gl_PointSize;
  float intensity = mod(facts.z, 256.0);
  float flags = floor(facts.z / 256.0);
  bool moving = mod(flags, 2.0) > 0.5;
  bool hidden = only >= 0.0 && facts.y != only && facts.y != other;
  if (outside(p) || facts.x > until || (hideMoving && moving) || hidden) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  }
  if (other >= 0.0) {
    shade = series[facts.y == other ? 1 : 0];
  } else if (colourBy == 3) {
    shade = series[int(mod(facts.y, ${SERIES.length}.0))];
  } else if (colourBy == 4) {
    shade = series[int(255.0 * ofKeyframe(sessions, facts.y) + 0.5)];
  } else if (colourBy == 5) {
    shade = series[moving ? 1 : 0];
  } else if (colourBy == 8) {
    shade = own == vec3(0.0) ? vec3(0.6) : own;  // no camera saw it
  } else {
    float share = colourBy == 0 ? (p.z - heights.x) / (heights.y - heights.x)
        : colourBy == 1 ? intensity / 255.0 : colourBy == 2 ? facts.x / 65535.0 : ofKeyframe(values, facts.y) * (255.0 / 254.0);
    shade = texture(ramp, vec2((0.5 + ${(7).toFixed(1)} * clamp(share, 0.0, 1.0)) / 8.0, 0.5)).rgb;
    if ((colourBy > 5 && share > 1.0) || (colourBy == 1 && flags > 1.5)) shade = vec3(0.6);  // not known
  }
}`;

const FRAGMENT = `
precision highp float;
in vec3 shade;
flat in float pixels;
uniform bool sizeAsAlpha;
out vec4 drawn;
void main() {
  if (pixels > ${DISC} && length(gl_PointCoord - 0.5) > 0.5) discard;
  drawn = vec4(shade, sizeAsAlpha ? pixels / 255.0 : 1.0);
}`;

const FAR = 1e9;

/** Of all clouds: eye-dome lighting comes after, and is told how large points are, in pixels, by 255 as alpha. */
export const sizeAsAlpha = { value: false };

/** Turned by `turn` about its vertical axis, rad; m. */
export interface Box { middle: Vector3; half: Vector3; turn: number; }

export class CloudMaterial {
  readonly material = new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT,
    uniforms: {
      corrections: { value: noCorrections() }, corrected: { value: false }, keyframeScale: { value: 1 },
      sessions: { value: indices(new Uint8Array(1)) }, ramp: { value: rampTexture() }, colourBy: { value: 0 }, heights: { value: new Vector2(0, 1) },
      series: { value: SERIES.map((hex) => { const c = colour(hex); return new Vector3(c.r, c.g, c.b); }) },
      size: { value: 2 }, closeSize: { value: 0 }, gapSize: { value: 0 }, sizeAsAlpha, mostSize: { value: 24 },
      boxMiddle: { value: new Vector3() }, boxHalf: { value: new Vector3().setScalar(FAR) }, boxTurn: { value: new Vector2(1, 0) },
      until: { value: 65536 }, hideMoving: { value: false }, only: { value: -1 }, other: { value: -1 },
      values: { value: indices(new Uint8Array(1)) },
    },
  });

  set(name: string, value: unknown): void {
    this.material.uniforms[name].value = value;
  }

  /** `size` in pixels, `ratio` of the screen's to them, `scale` pixels of a metre at a distance of a metre. */
  setSize(size: number, ratio: number, scale: number): void {
    this.set('size', size * ratio);
    this.set('closeSize', CLOSE * size * scale);
    this.set('gapSize', GAP * size * scale);
    this.set('mostSize', Math.max(1, MOST_SIZE * size) * ratio);
  }

  get<T>(name: string): T {
    return this.material.uniforms[name].value as T;
  }

  /** About the origin; null: everything is in it. */
  setBox(box: Box | null): void {
    this.get<Vector3>('boxMiddle').copy(box?.middle ?? new Vector3());
    this.get<Vector3>('boxHalf').copy(box?.half ?? new Vector3().setScalar(FAR));
    this.get<Vector2>('boxTurn').set(Math.cos(box?.turn ?? 0), Math.sin(box?.turn ?? 0));
  }

  inBox(p: Vector3): boolean {
    const middle = this.get<Vector3>('boxMiddle'), half = this.get<Vector3>('boxHalf'), turn = this.get<Vector2>('boxTurn');
    const x = p.x - middle.x, y = p.y - middle.y;
    return Math.abs(turn.x * x + turn.y * y) <= half.x && Math.abs(turn.x * y - turn.y * x) <= half.y
        && Math.abs(p.z - middle.z) <= half.z;
  }

  /** The number of each keyframe's session. */
  setSessions(numbers: number[]): void {
    this.get<DataTexture>('sessions').dispose();
    this.set('sessions', indices(Uint8Array.from(numbers, (number) => number % SERIES.length)));
  }

  /** Something of each keyframe, from 0 to 1; null: not known. */
  setValues(shares: (number | null)[]): void {
    this.get<DataTexture>('values').dispose();
    this.set('values', indices(Uint8Array.from(shares, (share) => (share === null ? 255 : Math.round(254 * share)))));
  }

  /** Three rows of a 3x4 matrix for each keyframe: from where its points were tiled to where it is now. */
  setCorrections(rows: Float32Array | null): void {
    this.set('corrected', rows !== null);
    if (!rows) return;
    const texels = rows.length / 4;
    const width = Math.min(texels, 2048);
    const height = Math.max(1, Math.ceil(texels / width));
    const padded = new Float32Array(4 * width * height);
    padded.set(rows);
    this.get<DataTexture>('corrections').dispose();
    const texture = new DataTexture(padded, width, height, RGBAFormat, FloatType);
    texture.needsUpdate = true;
    this.set('corrections', texture);
  }
}

/** A number a texel, row by row. */
function indices(numbers: Uint8Array): DataTexture {
  const width = Math.min(Math.max(1, numbers.length), 2048), height = Math.max(1, Math.ceil(numbers.length / width));
  const padded = new Uint8Array(width * height);
  padded.set(numbers);
  const texture = new DataTexture(padded, width, height, RedFormat);
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

function noCorrections(): DataTexture {
  const texture = new DataTexture(new Float32Array(4), 1, 1, RGBAFormat, FloatType);
  texture.needsUpdate = true;
  return texture;
}
