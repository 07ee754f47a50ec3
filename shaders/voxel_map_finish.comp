// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Turns the sums of a voxel map into what alignments read: the Gaussian of each voxel's points, its
// flat directions widened (Magnusson 2009, section 6.2.1), or the plane that its surfaces agree on.
// One thread takes slots strided over all threads.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/constraint.glsl"
#include "adit/shaders/include/hash.glsl"
#include "adit/shaders/include/jacobi.glsl"
#include "adit/shaders/include/texels.glsl"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;
layout(constant_id = 3) const uint kMakes = kGaussians;

layout(set = 0, binding = 0, scalar) readonly buffer Sums { uvec4 sums[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Voxels { uvec4 voxels[]; };
layout(set = 0, binding = 2) uniform utextureBuffer sums_texels;
layout(push_constant, scalar) uniform Push { VoxelMapFinishPush push; };

const float kPlanar = 0.9;  // times the mean normal outer product's trace: the largest eigenvalue

Sym3 widened(Sym3 covariance) {
  vec4 pairs[3];
  eigen(covariance, pairs);
  const float least = max(push.least_ratio * pairs[2].w, push.least_squared);
  const float a = max(pairs[0].w, least);
  const float b = max(pairs[1].w, least);
  const float c = max(pairs[2].w, least);
  const vec3 u = pairs[0].xyz;
  const vec3 v = pairs[1].xyz;
  const vec3 w = pairs[2].xyz;
  return Sym3(
      a * u.x * u.x + b * v.x * v.x + c * w.x * w.x, a * u.x * u.y + b * v.x * v.y + c * w.x * w.y,
      a * u.x * u.z + b * v.x * v.z + c * w.x * w.z, a * u.y * u.y + b * v.y * v.y + c * w.y * w.y,
      a * u.y * u.z + b * v.y * v.z + c * w.y * w.z, a * u.z * u.z + b * v.z * v.z + c * w.z * w.z);
}

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint slot = gl_GlobalInvocationID.x; slot < push.slots; slot += threads) {
    const uvec4 head = FETCH(sums, 3 * slot);
    const uvec4 middle = FETCH(sums, 3 * slot + 1);
    const uvec4 tail = FETCH(sums, 3 * slot + 2);
    const uint count = kMakes == kGaussians ? head.y : head.y & kCountMask;
    const float per_point = 1.0 / float(max(count, 1u));
    const vec3 mean = vec3(head.zw, middle.x) * (per_point / 65536.0);
    const uint key = head.x - 1u;
    const vec3 corner =
        vec3(ivec3(key >> 21, (key >> 10) & 2047u, key & 1023u) - ivec3(1024, 1024, 512));
    bool valid = head.x != kFree && count >= push.min_points;
    Sym3 form;
    uint faces = 0u;
    if (kMakes == kGaussians) {
      // Sums of products of offsets in units of the edge; sample covariance, n - 1.
      const float scale = per_point / 65536.0;
      const float area = push.cell * push.cell * float(count) / float(max(count, 2u) - 1u);
      form = widened(Sym3(area * (float(middle.y) * scale - mean.x * mean.x),
                          area * (float(middle.z) * scale - mean.x * mean.y),
                          area * (float(middle.w) * scale - mean.x * mean.z),
                          area * (float(tail.x) * scale - mean.y * mean.y),
                          area * (float(tail.y) * scale - mean.y * mean.z),
                          area * (float(tail.z) * scale - mean.z * mean.z)));
    } else {
      vec4 pairs[3];
      eigen(mean_constraint(head, middle, tail), pairs);
      const vec3 n = pairs[2].xyz;
      valid = valid && pairs[2].w > kPlanar * max(pairs[0].w + pairs[1].w + pairs[2].w, 0.5);
      faces = packHalf2x16(faces_of(head, tail));
      form = Sym3(n.x * n.x, n.x * n.y, n.x * n.z, n.y * n.y, n.y * n.z, n.z * n.z);
    }
    const uvec3 where = floatBitsToUint((corner + mean) * push.cell);
    voxels[3 * slot] = uvec4(head.x, valid ? count : 0u, where.xy);
    voxels[3 * slot + 1] = uvec4(where.z, floatBitsToUint(vec3(form.xx, form.xy, form.xz)));
    voxels[3 * slot + 2] = uvec4(floatBitsToUint(vec3(form.yy, form.yz, form.zz)), faces);
  }
}
