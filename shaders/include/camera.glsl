// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Points of the optical frame to pixels (shared/coloring.h). The includer has declared
// lens_radii[kLensSteps + 1].
#ifndef ADIT_CAMERA_GLSL
#define ADIT_CAMERA_GLSL

struct Pixel {
  vec2 at;
  bool seen;  // the lens looks there; at may still lie outside of the image
};

Pixel pixel_of(ViewCamera camera, vec3 p) {
  const float aside = length(p.xy);
  const float u = aside / (aside + length(p) + p.z);
  if (!(u < camera.widest)) {
    return Pixel(vec2(0.0), false);
  }
  const float place = u / camera.widest * float(kLensSteps);
  const uint step = min(uint(place), kLensSteps - 1);
  const float radius = mix(lens_radii[step], lens_radii[step + 1], place - float(step));
  vec2 seen = aside > 0.0 ? p.xy * (radius / aside) : vec2(0.0);
  if (camera.p1 != 0.0 || camera.p2 != 0.0) {
    const vec2 ray = p.xy / p.z;
    const float r2 = dot(ray, ray);
    seen += vec2(2.0 * camera.p1 * ray.x * ray.y + camera.p2 * (r2 + 2.0 * ray.x * ray.x),
                 camera.p1 * (r2 + 2.0 * ray.y * ray.y) + 2.0 * camera.p2 * ray.x * ray.y);
  }
  return Pixel(vec2(camera.fx, camera.fy) * seen + vec2(camera.cx, camera.cy), true);
}

#endif
