// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the kernels that measure a device's limits share with the host.
#ifndef ADIT_SHADERS_SHARED_LIMIT_PROBES_H
#define ADIT_SHADERS_SHARED_LIMIT_PROBES_H
#include "adit/shaders/shared/prelude.h"
#ifdef __cplusplus
namespace adit::gpu {
#endif

// limit_multiply_add.comp: independent chains of an invocation, and multiply-adds of each a round.
const uint kChains = 8;
const uint kChainSteps = 16;
// limit_gather.comp: uvec4 of a record.
const uint kRecordQuads = 4;

struct LimitCopyPush {
  uint count;  // uvec4
};

struct LimitMultiplyAddPush {
  uint rounds;
  float factor;
  float addend;
};

struct LimitGatherPush {
  uint count;  // records to read
  uint mask;   // records of the table - 1
};

struct LimitScatterPush {
  uint count;  // additions
  uint mask;   // words of the table - 1
};

#ifdef __cplusplus
}  // namespace adit::gpu
#endif
#endif
