// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adit/tools/simulator/spline.hpp"

namespace adit::test {

/// Where the world's axes are, without an end.
inline SplineTrajectory at_rest() {
  return {1.0, std::vector<Eigen::Isometry3d>(4, Eigen::Isometry3d::Identity())};
}

}  // namespace adit::test
