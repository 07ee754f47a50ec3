// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Dividing a sequence into consecutive parts, one a thread.
#ifndef ADIT_PARTS_GLSL
#define ADIT_PARTS_GLSL

struct Part {
  uint begin, end;  // items
  uint group;       // which group of parts, in order
  uint index;       // which part, in order
};

uint part_length(uint count, uint local_size) {
  const uint threads = gl_NumWorkGroups.x * local_size;
  return (count + threads - 1u) / threads;
}

// Consecutive threads of a group take consecutive parts. Groups are shuffled: software devices hand
// contiguous ranges of groups to their workers, and a sweep is dense at its start (the low beams)
// and thin at its end. The number of groups is a power of two.
Part part_of_thread(uint count, uint local_size) {
  const uint group = (gl_WorkGroupID.x * 5u) & (gl_NumWorkGroups.x - 1u);
  const uint index = group * local_size + gl_LocalInvocationIndex;
  const uint length = part_length(count, local_size);
  const uint begin = min(index * length, count);
  return Part(begin, min(begin + length, count), group, index);
}

#endif
