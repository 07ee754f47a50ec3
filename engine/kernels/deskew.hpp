// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernel.hpp"
#include "adit/engine/kernels/launch.hpp"
#include "adit/engine/recorder.hpp"
#include "adit/shaders/shared/deskew.h"

namespace adit::engine {

/// Ranges as measured, m; times in s after the sweep's stamp.
struct DeskewSettings {
  double c_min = 0.0;
  double c_max = 0.0;
  double first_time = 0.0;  ///< time of the first knot
  double last_time = 0.0;   ///< time of the last knot, later than the first
};

/// Slices of one sweep. `raw` and `times` may be mapped memory: they are read once.
struct DeskewArguments {
  uint32_t point_count = 0;
  uint32_t knot_count = 0;  ///< at least 2
  Slice raw;                ///< in: vec4 (x, y, z, intensity) a point, each in the sensor's frame
  Slice times;              ///< in: float a point
  Slice knots;              ///< in: gpu::DeskewKnot
  Slice moved;              ///< out: vec4 a point, all in the sensor's frame at the sweep's start
};

/// Moves the points of a sweep to the pose of the sensor at its start. What was not measured within
/// c_min to c_max, or without a time, becomes (0, 0, 0), which is no return. Same input, same
/// bytes.
class Deskew {
 public:
  explicit Deskew(Context& context);

  /// One dispatch, none without points. Neither begins nor ends with a barrier.
  void record(Recorder& recorder, const DeskewSettings& settings,
              const DeskewArguments& arguments) const;

 private:
  LaunchShape shape_;
  bool texels_;  ///< points and knots are read as texels
  Kernel kernel_;
};

}  // namespace adit::engine
