// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The surface that the sums of a surface cell tell of.
#ifndef ADIT_SURFACE_ESTIMATE_GLSL
#define ADIT_SURFACE_ESTIMATE_GLSL
#include "adit/shaders/include/surface.glsl"
#include "adit/shaders/include/sym3.glsl"

const float kMinPoints = 5.0;
// Neighbours whose second eigenvalue is this much smaller than the first lie on a line.
const float kLineRatio = 0.02;
// A line across the beams (steep in the sensor's frame) is a pole or an edge; one along them is
// what a single beam leaves on a surface, and says nothing of its normal.
const float kSteep = 0.7;
// Planes at less than ten degrees from the ray are seen edge-on.
const float kEdgeOn = 0.174;
// A plane through several cells is this thin, the smallest eigenvalue over the second: they may lie
// around a corner.
const float kThin = 0.02;
// And it is seen this obliquely, the cosine between its normal and the ray: what faces the sensor
// would have filled a cell. In a corridor, corners of a column and a row of points face it.
const float kOblique = 0.5;
// A plane that runs along the ray, and across which the points are spread less than this, in
// squares of the gap between beams, was seen by one beam: it is the plane of the scan.
const float kOneBeam = 0.01;

bool is_of_one_beam(Sym3 covariance, vec3 normal, vec3 ray, float gap) {
  const vec3 across = dot(ray, ray) * normal - dot(normal, ray) * ray;
  const float squared = dot(across, across);
  return across.z * across.z > kSteep * kSteep * squared &&
         dot(across, mul(covariance, across)) < kOneBeam * gap * squared;
}

uint no_surface() { return pack_surface(vec3(0.0, 0.0, 1.0), kIsotropic); }

// `ray` leads from the sensor to the point: normals are turned against it. `gap`: the square of the
// gap between neighbouring beams there, in cells. Several cells together (`wide`) show thin,
// oblique planes alone.
uint classify(Sym3 covariance, vec3 ray, float gap, bool wide) {
  const float scale = 1.0 / max(covariance.xx + covariance.yy + covariance.zz, 1e-30);
  const Sym3 unit = Sym3(covariance.xx * scale, covariance.xy * scale, covariance.xz * scale,
                         covariance.yy * scale, covariance.yz * scale, covariance.zz * scale);
  const vec3 values = eigenvalues(unit);
  const bool line = values.y < kLineRatio * values.z;
  const vec3 v = eigenvector(unit, line ? values.z : values.x);
  const float along = dot(v, ray);
  const bool plain = values.x < kThin * values.y && abs(along) < kOblique * length(ray);
  const bool useful = dot(v, v) > 0.5 && (line   ? !wide && abs(v.z) > kSteep
                                          : wide ? plain
                                                 : !is_of_one_beam(unit, v, ray, gap * scale));
  const uint plane = abs(along) > kEdgeOn * length(ray) ? kPlane : kGrazing;
  return pack_surface(useful ? (along > 0.0 ? -v : v) : vec3(0.0, 0.0, 1.0),
                      useful ? (line ? kLine : plane) : kIsotropic);
}

// Over the points of one cell or several: their number, means of offsets and of their products,
// from the corner of one cell, in cells.
struct SurfaceMoments {
  float n;
  vec3 mean;
  Sym3 products;
};

SurfaceMoments no_moments() {
  return SurfaceMoments(0.0, vec3(0.0), Sym3(0.0, 0.0, 0.0, 0.0, 0.0, 0.0));
}

// The three uvec4 of a GaussianCell that lies `s` cells away from the corner.
SurfaceMoments moments_of(uvec4 head, uvec4 middle, uvec4 tail, vec3 s) {
  const float n = float(head.y);
  const float scale = 1.0 / (n * 65536.0);
  const vec3 a = vec3(head.zw, middle.x) * scale;
  return SurfaceMoments(n, a + s,
                        Sym3(float(middle.y) * scale + s.x * (2.0 * a.x + s.x),
                             float(middle.z) * scale + a.x * s.y + s.x * (a.y + s.y),
                             float(middle.w) * scale + a.x * s.z + s.x * (a.z + s.z),
                             float(tail.x) * scale + s.y * (2.0 * a.y + s.y),
                             float(tail.y) * scale + a.y * s.z + s.y * (a.z + s.z),
                             float(tail.z) * scale + s.z * (2.0 * a.z + s.z)));
}

SurfaceMoments together(SurfaceMoments a, SurfaceMoments b) {
  const float n = a.n + b.n;
  const float u = a.n / n;
  const float v = b.n / n;
  return SurfaceMoments(
      n, u * a.mean + v * b.mean,
      Sym3(u * a.products.xx + v * b.products.xx, u * a.products.xy + v * b.products.xy,
           u * a.products.xz + v * b.products.xz, u * a.products.yy + v * b.products.yy,
           u * a.products.yz + v * b.products.yz, u * a.products.zz + v * b.products.zz));
}

// As classify().
uint surface_of(SurfaceMoments m, vec3 ray, float gap, bool wide) {
  const Sym3 covariance =
      Sym3(m.products.xx - m.mean.x * m.mean.x, m.products.xy - m.mean.x * m.mean.y,
           m.products.xz - m.mean.x * m.mean.z, m.products.yy - m.mean.y * m.mean.y,
           m.products.yz - m.mean.y * m.mean.z, m.products.zz - m.mean.z * m.mean.z);
  return m.n >= kMinPoints ? classify(covariance, ray, gap, wide) : no_surface();
}

#endif
