// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The colours of all of adit's pages (tools/drawing/svg.hpp), told apart with any kind of colour vision.
import { Color, DataTexture, LinearFilter, RGBAFormat } from 'three';

/** From low to high. */
export const RAMP = ['#3b3f8f', '#3a5ba0', '#3778a8', '#3794a6', '#45ae94', '#6fc378', '#a5d05a', '#dcd64a'];

/** Of a sensor: x, y, z. */
export const AXES = ['#d62f2f', '#2a9d3a', '#3b6fe0'];

/** Keyframes side by side. */
export const SERIES = ['#0072b2', '#d55e00', '#009e73', '#b0508c', '#3392cc', '#7a5200'];

export interface Theme {
  dark: boolean;
  background: string;
  trajectory: string;
  odometry: string;
  keyframe: string;
  chosen: string;
  truth: string;
  plots: string[];
  verdicts: Record<string, string>;
}

const LIGHT: Theme = {
  dark: false, background: '#ffffff', trajectory: '#d55e00', odometry: '#555555', keyframe: '#b0508c', chosen: '#000000', truth: '#0072b2',
  plots: SERIES,
  verdicts: { accepted: '#009e73', used: '#009e73', rejected: '#a4262c', outlier: '#a4262c', frozen: '#a4262c',
    revoked: '#8a8f96', thinned: '#8a8f96', apart: '#8a8f96', waiting: '#e6a700' },
};
const DARK: Theme = {
  dark: true, background: '#15181c', trajectory: '#ff8a3d', odometry: '#b4bac2', keyframe: '#dd8abf', chosen: '#ffffff', truth: '#4ba6ee',
  plots: ['#4ba6ee', '#ff8a3d', '#35c496', '#dd8abf'],
  verdicts: { accepted: '#35c496', used: '#35c496', rejected: '#e5636a', outlier: '#e5636a', frozen: '#e5636a',
    revoked: '#8a9099', thinned: '#8a9099', apart: '#8a9099', waiting: '#f5c542' },
};

export const prefersDark = matchMedia('(prefers-color-scheme: dark)');
export const theme = (): Theme => (prefersDark.matches ? DARK : LIGHT);

const bytesOf = (hex: string): number[] => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));

/** The ramp as a texture; colours are drawn as they are, without a colour space. */
export function rampTexture(): DataTexture {
  const texture = new DataTexture(new Uint8Array(RAMP.flatMap((hex) => [...bytesOf(hex), 255])), RAMP.length, 1, RGBAFormat);
  texture.magFilter = texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

export function colour(hex: string): Color {
  const [r, g, b] = bytesOf(hex);
  return new Color().setRGB(r / 255, g / 255, b / 255);
}
