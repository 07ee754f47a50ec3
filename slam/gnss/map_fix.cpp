// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/map_fix.hpp"

namespace adit {

PositionFix as_measured(const MapFix& fix, const WorldFrame& frame) {
  return {.node = fix.keyframe,
          .p_node = fix.p_keyframe_antenna,
          .p_world = frame.position_of(fix.place),
          .information = fix.information};
}

}  // namespace adit
