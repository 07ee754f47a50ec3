// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What engine_probe.comp, engine_texel_probe.comp and their callers share.
#ifndef ADIT_SHADERS_SHARED_ENGINE_PROBE_H
#define ADIT_SHADERS_SHARED_ENGINE_PROBE_H

#include "adit/shaders/shared/prelude.h"

#ifdef __cplusplus
namespace adit::gpu {
#endif

struct ProbePush {
  uint count;   // items
  uint offset;  // added to each
};

struct TexelProbePush {
  uint count;   // texels
  uint offset;  // added to each component
};

/// At the start of the output; the results follow.
struct ProbeSums {
  uint total;
  uint items;
};

#ifdef __cplusplus
}  // namespace adit::gpu
#endif

#endif
