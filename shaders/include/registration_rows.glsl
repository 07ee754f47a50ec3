// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Adding up the rows of partial sums that the groups of an alignment left: by all threads of the
// group that finished last, in an order that hangs on the group's size alone. A group of no more
// threads than a row has numbers adds the rows in their order.
#ifndef ADIT_REGISTRATION_ROWS_GLSL
#define ADIT_REGISTRATION_ROWS_GLSL
#extension GL_EXT_control_flow_attributes : require
#include "adit/shaders/include/registration_match.glsl"

// Threads side by side take the numbers of a row (kRowSize of them, padded to a power of two), the
// next ones those of the next row. kRowSize is defined by the kernel, a constant.
const uint kColumns = kRowSize <= 8 ? 8 : (kRowSize <= 32 ? 32 : 64);
const uint kRowParts = kLocalSize > kColumns ? kLocalSize / kColumns : 1;
shared float row_parts[kRowParts * kColumns];

// Each thread's part of the rows; a barrier must follow.
void add_row_parts(uint at, uint groups) {
  for (uint i = gl_LocalInvocationIndex; i < kRowParts * kColumns; i += kLocalSize) {
    const uint k = i % kColumns;
    float sum = 0.0;
    if (k < kRowSize) {
      for (uint g = i / kColumns; g < groups; g += kRowParts) {
        sum += partials[(at * push.group_stride + g) * kSystemStride + k];
      }
    }
    row_parts[i] = sum;
  }
}

// Number k of the sum of all rows, once the parts are there.
float row_sum(uint k) {
  float sum = row_parts[k];
  [[dont_unroll]] for (uint part = 1; part < kRowParts; ++part) {
    sum += row_parts[part * kColumns + k];
  }
  return sum;
}

#endif
