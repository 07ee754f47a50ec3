// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Estimates the surface at each point of the down-sampled cloud from the second moments of the
// surface cell it lies in. One thread takes points strided over all threads. Written: the point
// with its packed surface (normal towards the sensor, or direction, and class) in place of the
// intensity.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/surface.glsl"
#include "adit/shaders/include/sym3.glsl"
#include "adit/shaders/include/texels.glsl"
#include "adit/shaders/shared/preprocess.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Cloud { uvec4 cloud[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Surfaces {
  uvec4 surfaces[];
};  // GaussianCell: 3 each
layout(set = 0, binding = 2, scalar) writeonly buffer Output { uvec4 surface_cloud[]; };
layout(set = 0, binding = 3, scalar) buffer Counters { SweepCounters counters; };
layout(set = 0, binding = 4) uniform utextureBuffer cloud_texels;
layout(set = 0, binding = 5) uniform utextureBuffer surfaces_texels;
layout(push_constant, scalar) uniform Push { SurfacePush push; };

const float kMinPoints = 5.0;
// Neighbours whose second eigenvalue is this much smaller than the first lie on a line.
const float kLineRatio = 0.02;
// A line across the beams (steep in the sensor's frame) is a pole or an edge; one along them is
// what a single beam leaves on a surface, and says nothing of its normal.
const float kSteep = 0.7;

uint classify(Sym3 covariance, vec3 p) {
  const float scale = 1.0 / max(covariance.xx + covariance.yy + covariance.zz, 1e-30);
  const Sym3 unit = Sym3(covariance.xx * scale, covariance.xy * scale, covariance.xz * scale,
                         covariance.yy * scale, covariance.yz * scale, covariance.zz * scale);
  const vec3 values = eigenvalues(unit);
  const bool line = values.y < kLineRatio * values.z;
  const vec3 v = eigenvector(unit, line ? values.z : values.x);
  const bool useful = dot(v, v) > 0.5 && (!line || abs(v.z) > kSteep);
  return pack_surface(useful ? (dot(v, p) > 0.0 ? -v : v) : vec3(0.0, 0.0, 1.0),
                      useful ? (line ? kLine : kPlane) : kIsotropic);
}

void main() {
  const uint count = counters.cloud_points;
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    const vec3 p = uintBitsToFloat(FETCH(cloud, i).xyz);
    const uint key = surface_cell(p, push.inverse_surface_cell, push.level_factor).key;
    uint slot = mix32(key) & push.surface_mask;
    uint probes = 0;
    uvec4 head = FETCH(surfaces, 3 * slot);
    while (head.x != key && head.x != kFree && probes < kMaxProbes) {
      slot = (slot + 1) & push.surface_mask;
      head = FETCH(surfaces, 3 * slot);
      probes += 1;
    }
    uint packed = pack_surface(vec3(0.0, 0.0, 1.0), kIsotropic);
    if (head.x != key) {
      atomicAdd(counters.surface_failures, 1);
    } else {
      const uvec4 middle = FETCH(surfaces, 3 * slot + 1);
      const uvec4 tail = FETCH(surfaces, 3 * slot + 2);
      const float n = float(head.y);
      const float scale = 1.0 / (n * 65536.0);
      const vec3 mean = vec3(head.zw, middle.x) * scale;
      const Sym3 covariance =
          Sym3(float(middle.y) * scale - mean.x * mean.x, float(middle.z) * scale - mean.x * mean.y,
               float(middle.w) * scale - mean.x * mean.z, float(tail.x) * scale - mean.y * mean.y,
               float(tail.y) * scale - mean.y * mean.z, float(tail.z) * scale - mean.z * mean.z);
      if (n >= kMinPoints) {
        packed = classify(covariance, p);
      }
    }
    surface_cloud[i] = uvec4(floatBitsToUint(p), packed);
  }
}
