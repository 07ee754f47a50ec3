// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "adit/engine/device_info.hpp"

namespace adit::engine {

/// How kernels that loop over their items are launched. Fixed for a device, so that the order of
/// sums is.
struct LaunchShape {
  uint32_t local_size = 0;  ///< invocations a group
  uint32_t groups = 0;      ///< a power of two
  uint32_t run =
      0;  ///< consecutive raw points one invocation looks at when down-sampling; 32 at most
  uint32_t least_items = 1;  ///< of reductions: what a group takes before another one takes part

  uint32_t threads() const { return local_size * groups; }
};

/// Software devices: few groups, since a group has a price and there are few cores. Others: enough
/// to fill a large GPU.
inline LaunchShape launch_shape(const DeviceInfo& device) {
  return device.gpu_shapes ? LaunchShape{.local_size = 128, .groups = 512, .run = 4}
                           : LaunchShape{.local_size = 64, .groups = 16, .run = 32};
}

/// The same for kernels whose last group goes on alone, at most `groups` of them. Software devices
/// run that part in every subgroup of every group, lanes off: one subgroup a group is the fewest.
/// On GPUs the last group adds up one row of every other. A reduction by itself is over soonest
/// where each thread has one item; where there are `many` at once the GPU is full anyway, and the
/// threads of fewer groups take several.
inline LaunchShape reduction_shape(const DeviceInfo& device, bool many) {
  LaunchShape shape = launch_shape(device);
  if (device.gpu_shapes) {
    shape.local_size = many ? 128 : 256;
    shape.groups = 256;
    shape.least_items = many ? 4 * shape.local_size : shape.local_size;
  } else {
    shape.local_size = std::clamp(device.subgroup_size, 8U, 64U);
  }
  return shape;
}

/// Groups of `local_size` invocations for so many items, each of which costs `rounds` rounds of a
/// kernel's loops, nested ones included. Lavapipe gives the loops of an invocation 65535 rounds in
/// all and then leaves them without a word (Mesa's LP_MAX_TGSI_LOOP_ITERATIONS); this takes half.
inline uint32_t least_groups(uint64_t items, uint64_t rounds, uint32_t local_size) {
  const uint64_t most = uint64_t{local_size} * 32768;
  return static_cast<uint32_t>((items * rounds + most - 1) / most);
}

}  // namespace adit::engine
