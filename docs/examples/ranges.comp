// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// One thread computes the ranges of its strided points and writes them. A group does nothing
// together. ranges[] is written.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;
layout(set = 0, binding = 0, scalar) readonly buffer Cloud {
  vec4 cloud[];
};
layout(set = 0, binding = 1, scalar) writeonly buffer Ranges {
  float ranges[];
};
layout(push_constant, scalar) uniform Push {
  uint count;
};

void main() {
  for (uint i = gl_GlobalInvocationID.x; i < count; i += gl_NumWorkGroups.x * kLocalSize) {
    ranges[i] = length(cloud[i].xyz);
  }
}
