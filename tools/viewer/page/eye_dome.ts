// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Eye-dome lighting: a point is darker the more its neighbours on the screen are nearer to the eye, which shows edges
// and surfaces without normals.
import { DepthTexture, FloatType, GLSL3, Mesh, NearestFilter, OrthographicCamera, PlaneGeometry, RawShaderMaterial, Scene,
  Vector2, WebGLRenderTarget, type PerspectiveCamera, type WebGLRenderer } from 'three';
import { sizeAsAlpha } from './cloud_material';
import { colour } from './palette';

const VERTEX = `
precision highp float;
in vec3 position;
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }`;

const FRAGMENT = `
precision highp float;
precision highp sampler2D;
uniform sampler2D shade, depth;
uniform vec2 nearFar;
uniform float strength, perPixel;
uniform vec3 background;
uniform int reach;
const float ROUGH = 1.0, DARKEST = 0.2;
out vec4 drawn;

float logDistance(float d) {
  return log2(nearFar.x * nearFar.y / (nearFar.y - d * (nearFar.y - nearFar.x)));
}

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  float d = texelFetch(depth, here, 0).x;
  if (d >= 1.0) {
    drawn = vec4(background, 1.0);
    return;
  }
  vec4 point = texelFetch(shade, here, 0);
  // Points of one surface that are drawn over one another are no edge.
  float mine = logDistance(d) - 1.4427 * ROUGH * perPixel * max(0.0, 255.0 * point.a - float(2 * reach));
  float sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 step = reach * (k == 0 ? ivec2(1, 0) : k == 1 ? ivec2(-1, 0) : k == 2 ? ivec2(0, 1) : ivec2(0, -1));
    float there = texelFetch(depth, clamp(here + step, ivec2(0), textureSize(depth, 0) - 1), 0).x;
    if (there < 1.0) sum += max(0.0, mine - logDistance(there));
  }
  float light = mix(DARKEST, 1.0, exp(-strength * 0.25 * sum));
  drawn = vec4(point.rgb * light, 1.0);
}`;

export class EyeDome {
  private readonly target: WebGLRenderTarget;
  private readonly material: RawShaderMaterial;
  private readonly screen = new Scene();
  private readonly flat = new OrthographicCamera();

  constructor() {
    this.target = new WebGLRenderTarget(1, 1, { minFilter: NearestFilter, magFilter: NearestFilter, samples: 0 });
    this.target.depthTexture = new DepthTexture(1, 1, FloatType);
    this.material = new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, depthTest: false, depthWrite: false,
      uniforms: { shade: { value: this.target.texture }, depth: { value: this.target.depthTexture },
        nearFar: { value: new Vector2() }, strength: { value: 60 }, perPixel: { value: 0 }, reach: { value: 1 },
        background: { value: colour('#ffffff') } },
    });
    const quad = new Mesh(new PlaneGeometry(2, 2), this.material);
    quad.frustumCulled = false;
    this.screen.add(quad);
  }

  /** Draws the scene's points with light and shade onto the whole canvas. */
  render(renderer: WebGLRenderer, scene: Scene, camera: PerspectiveCamera, background: string): void {
    const size = renderer.getDrawingBufferSize(new Vector2());
    if (this.target.width !== size.x || this.target.height !== size.y) this.target.setSize(size.x, size.y);
    renderer.setRenderTarget(this.target);
    renderer.clear();
    sizeAsAlpha.value = true;
    renderer.render(scene, camera);
    sizeAsAlpha.value = false;
    renderer.setRenderTarget(null);
    this.material.uniforms.perPixel.value = 2 * Math.tan(0.5 * camera.fov * Math.PI / 180) / size.y;
    this.material.uniforms.nearFar.value.set(camera.near, camera.far);
    this.material.uniforms.reach.value = Math.max(1, Math.round(renderer.getPixelRatio()));
    this.material.uniforms.background.value = colour(background);
    renderer.render(this.screen, this.flat);
  }
}
