// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the kernels of an alignment bind, and how a point of the source finds its matches in the
// target's voxel map. Voxel tables are three uvec4 a slot: GaussianCell for kVgicp, what
// voxel_map_finish.comp makes of it for the other methods.
#ifndef ADIT_REGISTRATION_MATCH_GLSL
#define ADIT_REGISTRATION_MATCH_GLSL
#include "adit/shaders/include/constraint.glsl"
#include "adit/shaders/include/surface.glsl"
#include "adit/shaders/include/sym3.glsl"
#include "adit/shaders/include/texels.glsl"
#include "adit/shaders/shared/registration.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;
layout(constant_id = 3) const uint kMethod = kVgicp;
layout(constant_id = 4) const uint kNeighbours = 1;  // 1, 7 (faces) or 27
layout(constant_id = 5) const uint kRobust = kNoRobust;
layout(constant_id = 6) const bool kDropBackFaces = false;
// kSystemSize, or kGeometrySize: also the sums that tell what the matches hold.
layout(constant_id = 7) const uint kSums = kSystemSize;
const bool kGeometry = kSums == kGeometrySize;
// What a group takes before another one takes part: an alignment is launched for the most points
// that its source may have.
layout(constant_id = 8) const uint kLeastPoints = 1;

layout(set = 0, binding = 0, scalar) readonly buffer Cloud { uvec4 source[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Voxels { uvec4 voxels[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Jobs { RegistrationJob jobs[]; };
layout(set = 0, binding = 3, scalar) coherent buffer Progress {
  RegistrationHeader header;
  RegistrationProgress progress[];
};
layout(set = 0, binding = 4, scalar) coherent buffer States { RegistrationState states[]; };
layout(set = 0, binding = 5, scalar) coherent buffer Partials { float partials[]; };
layout(set = 0, binding = 6) uniform utextureBuffer source_texels;
layout(set = 0, binding = 7) uniform utextureBuffer voxels_texels;
layout(push_constant, scalar) uniform Push { RegistrationPush push; };

// A point of the source, turned into the target's axes.
struct SourcePoint {
  bool valid;
  vec3 ra;          // R a
  vec3 direction;   // its surface's
  vec2 weights;     // P = x I + y v v^T
  Sym3 covariance;  // kNdtToNdt: R C R^T, m^2
  bool plane;
  bool faces;  // a plane that is known to face along its direction
};

// A voxel that a point may match.
struct Voxel {
  bool found;
  vec3 mean;   // target frame, m
  Sym3 form;   // kVgicp: mean of P; kNdt, kNdtToNdt: covariance, m^2; kPointToPlane: n n^T
  vec2 faces;  // shares of its surfaces that face along kFacing, and against it
};

// What the matches of one point pull it with: sums over them.
struct Pull {
  uint matches;
  Sym3 omega;  // w Omega
  vec3 force;  // w Omega e
  float cost;
  float squared;  // squared distance along the normal, m^2
  float weight;   // w
  vec3 drift;     // w e
};

Sym3 turned(Sym3 c, mat3x4 pose) {  // R C R^T
  const vec3 x = mul(c, pose[0].xyz);
  const vec3 y = mul(c, pose[1].xyz);
  const vec3 z = mul(c, pose[2].xyz);
  return Sym3(dot(pose[0].xyz, x), dot(pose[0].xyz, y), dot(pose[0].xyz, z), dot(pose[1].xyz, y),
              dot(pose[1].xyz, z), dot(pose[2].xyz, z));
}

SourcePoint source_point(uint at, mat3x4 pose) {
  SourcePoint s;
  if (kMethod == kNdtToNdt) {
    const uvec4 head = FETCH(source, at);
    const uvec4 middle = FETCH(source, at + 1);
    const uvec4 tail = FETCH(source, at + 2);
    s.valid = head.y > 0;
    s.ra = vec4(uintBitsToFloat(head.zw), uintBitsToFloat(middle.x), 0.0) * pose;
    s.covariance =
        turned(Sym3(uintBitsToFloat(middle.y), uintBitsToFloat(middle.z), uintBitsToFloat(middle.w),
                    uintBitsToFloat(tail.x), uintBitsToFloat(tail.y), uintBitsToFloat(tail.z)),
               pose);
    s.direction = vec3(0.0, 0.0, 1.0);
    s.weights = vec2(0.0);
    s.plane = false;
    s.faces = false;
  } else {
    const uvec4 point = FETCH(source, at);
    s.valid = true;
    s.ra = vec4(uintBitsToFloat(point.xyz), 0.0) * pose;
    s.direction = vec4(unpack_direction(point.w), 0.0) * pose;
    s.weights = surface_weights(point.w);
    s.plane = is_plane(point.w >> 30);
    s.faces = (point.w >> 30) == kPlane;
  }
  return s;
}

uint groups_of(RegistrationJob job) {
  return clamp((job.source_count + kLeastPoints - 1) / kLeastPoints, 1u, job.groups);
}

ivec3 neighbour(uint n) {
  if (kNeighbours == 27) {
    return ivec3(n % 3, (n / 3) % 3, n / 9) - 1;
  }
  const int sign = (n & 1u) == 0u ? -1 : 1;
  const uint axis = n == 0u ? 3u : (n - 1u) >> 1;
  return ivec3(axis == 0u ? sign : 0, axis == 1u ? sign : 0, axis == 2u ? sign : 0);
}

Voxel find_voxel(vec3 corner, uint begin, uint mask, float cell) {
  const uint key = pack_voxel(ivec3(corner));
  uint slot = mix32(key) & mask;
  uint probes = 0;
  uvec4 head = FETCH(voxels, begin + 3 * slot);
  while (head.x != key && head.x != kFree && probes < kMaxProbes) {
    slot = (slot + 1) & mask;
    head = FETCH(voxels, begin + 3 * slot);
    probes += 1;
  }
  const uvec4 middle = FETCH(voxels, begin + 3 * slot + 1);
  const uvec4 tail = FETCH(voxels, begin + 3 * slot + 2);
  Voxel v;
  v.found = head.x == key && key != kFree && head.y > 0;
  if (kMethod == kVgicp) {
    const float per_point = v.found ? 1.0 / float(head.y & kCountMask) : 0.0;
    v.mean = (corner + vec3(head.zw, middle.x) * (per_point / 65536.0)) * cell;
    v.form = mean_constraint(head, middle, tail);
    v.faces = faces_of(head, tail);
  } else {
    v.mean = uintBitsToFloat(uvec3(head.zw, middle.x));
    v.form = Sym3(uintBitsToFloat(middle.y), uintBitsToFloat(middle.z), uintBitsToFloat(middle.w),
                  uintBitsToFloat(tail.x), uintBitsToFloat(tail.y), uintBitsToFloat(tail.z));
    v.faces = unpackHalf2x16(tail.w);
  }
  return v;
}

// Information of a match: the inverse of the sum of both covariances.
Sym3 information(Voxel voxel, SourcePoint s) {
  if (kMethod == kPointToPlane) {
    return voxel.form;
  }
  if (kMethod == kNdt) {
    return inverse(voxel.form);
  }
  if (kMethod == kNdtToNdt) {
    return inverse(add(voxel.form, s.covariance));
  }
  const float k = 1.0 - push.epsilon;
  const Sym3 target = voxel.form;
  const vec3 v = s.direction;
  const vec2 w = s.weights;
  const vec3 bv = w.y * v;
  return inverse(Sym3(2.0 - k * (target.xx + w.x + bv.x * v.x), -k * (target.xy + bv.x * v.y),
                      -k * (target.xz + bv.x * v.z), 2.0 - k * (target.yy + w.x + bv.y * v.y),
                      -k * (target.yz + bv.y * v.z), 2.0 - k * (target.zz + w.x + bv.z * v.z)));
}

float robust_weight(float squared) {
  const float u = squared / (push.robust_width * push.robust_width);
  if (kRobust == kHuber) {
    return min(1.0, inversesqrt(max(u, 1e-12)));
  }
  if (kRobust == kCauchy) {
    return 1.0 / (1.0 + u);
  }
  if (kRobust == kGemanMcClure) {
    return 1.0 / ((1.0 + u) * (1.0 + u));
  }
  return 1.0;
}

// What the robust kernel makes of a squared Mahalanobis distance: rho(d^2), with rho' the weight.
float robust_cost(float squared) {
  const float width2 = push.robust_width * push.robust_width;
  const float u = squared / width2;
  if (kRobust == kHuber) {
    return u <= 1.0 ? squared : width2 * (2.0 * sqrt(u) - 1.0);
  }
  if (kRobust == kCauchy) {
    return width2 * log(1.0 + u);
  }
  if (kRobust == kGemanMcClure) {
    return squared / (1.0 + u);
  }
  return squared;
}

// The score is flatter along the error than its quadratic: its second derivative is w (Omega - d2
// (Omega e) (Omega e)^T). Steps take that, but never less than a tenth of the quadratic's, so that
// the sum stays positive definite (as Triggs et al. 2000 correct robust kernels).
const float kMostLess = 0.9;

Sym3 less_along(Sym3 m, vec3 v, float by) {
  const vec3 bv = by * v;
  return Sym3(m.xx - bv.x * v.x, m.xy - bv.x * v.y, m.xz - bv.x * v.z, m.yy - bv.y * v.y,
              m.yz - bv.y * v.z, m.zz - bv.z * v.z);
}

void add_match(inout Pull pull, Voxel voxel, SourcePoint s, vec3 e, RegistrationJob job) {
  const Sym3 omega = information(voxel, s);
  const vec3 oe = mul(omega, e);
  const float squared = dot(e, oe);
  float weight = robust_weight(squared);
  float cost = robust_cost(squared);
  Sym3 curvature = omega;
  if (kMethod == kNdt || kMethod == kNdtToNdt) {
    const float likelihood = exp(-job.score_exponent * squared);
    weight *= job.score_weight * likelihood;
    cost = -0.5 * job.score_weight / job.score_exponent * likelihood;
    if (!kGeometry) {
      curvature = less_along(omega, oe, min(2.0 * job.score_exponent, kMostLess / squared));
    }
  }
  pull.matches += 1;
  pull.omega = add(pull.omega, scaled(curvature, weight));
  pull.force += weight * oe;
  pull.cost += cost;
  pull.squared +=
      kMethod == kVgicp ? dot(e, mul(voxel.form, e)) : squared / (omega.xx + omega.yy + omega.zz);
  pull.weight += weight;
  pull.drift += weight * e;
}

// The wall behind the wall: a surface that the target's sensor could only have seen from behind.
bool seen_from_behind(SourcePoint s, vec3 q, vec3 viewpoint) {
  const vec3 ray = q - viewpoint;
  return kDropBackFaces && s.plane && dot(ray, s.direction) > 0.174 * length(ray);
}

// The wall's other face, or a voxel that has both: its mean lies inside the wall.
const float kParallel = 0.8;    // squared cosine, of the voxel's normals with the point's
const float kOtherFace = 0.27;  // share of those that are clear; no small fraction

bool is_other_face(SourcePoint s, Voxel voxel) {
  const float facing = dot(s.direction, vec3(kFacingX, kFacingY, kFacingZ));
  const float clear = voxel.faces.x + voxel.faces.y;
  const float other = facing > 0.0 ? voxel.faces.y : voxel.faces.x;
  return s.faces && abs(facing) > kUnclearFacing && clear > 0.51 && other > kOtherFace * clear &&
         dot(s.direction, mul(voxel.form, s.direction)) > kParallel;
}

Pull pull_of(SourcePoint s, mat3x4 pose, RegistrationJob job, float max_squared) {
  Pull pull = Pull(0, Sym3(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), vec3(0.0), 0.0, 0.0, 0.0, vec3(0.0));
  const vec3 q = s.ra + vec3(pose[0].w, pose[1].w, pose[2].w);
  const vec3 corner = floor(q * job.inverse_cell);
  const bool usable = s.valid && !seen_from_behind(s, q, job.viewpoint);
  for (uint n = 0; n < kNeighbours; ++n) {
    const vec3 at = kNeighbours == 1 ? corner : corner + vec3(neighbour(n));
    const Voxel voxel = find_voxel(at, job.target_begin, job.table_mask, job.cell);
    const vec3 e = voxel.mean - q;
    if (usable && voxel.found && dot(e, e) <= max_squared && !is_other_face(s, voxel)) {
      add_match(pull, voxel, s, e, job);
    }
  }
  return pull;
}

#endif
