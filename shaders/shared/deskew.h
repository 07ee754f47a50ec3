// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// De-skewing of one sweep: what the kernel and the host share.
#ifndef ADIT_SHADERS_SHARED_DESKEW_H
#define ADIT_SHADERS_SHARED_DESKEW_H
#include "adit/shaders/shared/prelude.h"
#ifdef __cplusplus
namespace adit::gpu {
#endif

// Where the sensor was at one time of the sweep, in its own frame at the sweep's start. Signs of
// neighbouring quaternions agree.
struct DeskewKnot {
  vec4 rotation;     // unit quaternion x y z w
  vec4 translation;  // m; w unused
};

struct DeskewPush {
  uint point_count;
  uint knots;         // at least 2, equally spaced in time
  float first_time;   // s after the sweep's stamp, of knot 0
  float per_second;   // knots a second
  float min_squared;  // c_min^2, m^2
  float max_squared;  // c_max^2, m^2
};

#ifdef __cplusplus
}  // namespace adit::gpu
#endif
#endif
