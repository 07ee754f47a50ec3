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

// `ray` leads from the sensor to the point: normals are turned against it.
uint classify(Sym3 covariance, vec3 ray) {
  const float scale = 1.0 / max(covariance.xx + covariance.yy + covariance.zz, 1e-30);
  const Sym3 unit = Sym3(covariance.xx * scale, covariance.xy * scale, covariance.xz * scale,
                         covariance.yy * scale, covariance.yz * scale, covariance.zz * scale);
  const vec3 values = eigenvalues(unit);
  const bool line = values.y < kLineRatio * values.z;
  const vec3 v = eigenvector(unit, line ? values.z : values.x);
  const bool useful = dot(v, v) > 0.5 && (!line || abs(v.z) > kSteep);
  const float along = dot(v, ray);
  const uint plane = abs(along) > kEdgeOn * length(ray) ? kPlane : kGrazing;
  return pack_surface(useful ? (along > 0.0 ? -v : v) : vec3(0.0, 0.0, 1.0),
                      useful ? (line ? kLine : plane) : kIsotropic);
}

uint no_surface() { return pack_surface(vec3(0.0, 0.0, 1.0), kIsotropic); }

// The three uvec4 of the cell's GaussianCell, and the ray to the point.
uint surface_of(uvec4 head, uvec4 middle, uvec4 tail, vec3 ray) {
  const float n = float(head.y);
  const float scale = 1.0 / (n * 65536.0);
  const vec3 mean = vec3(head.zw, middle.x) * scale;
  const Sym3 covariance =
      Sym3(float(middle.y) * scale - mean.x * mean.x, float(middle.z) * scale - mean.x * mean.y,
           float(middle.w) * scale - mean.x * mean.z, float(tail.x) * scale - mean.y * mean.y,
           float(tail.y) * scale - mean.y * mean.z, float(tail.z) * scale - mean.z * mean.z);
  return n >= kMinPoints ? classify(covariance, ray) : no_surface();
}

#endif
