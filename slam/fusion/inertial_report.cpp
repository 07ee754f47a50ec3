// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/inertial_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {

std::string_view to_string(InertialState state) {
  switch (state) {
    case InertialState::absent:
      return "absent";
    case InertialState::starting:
      return "starting";
    case InertialState::fused:
      return "fused";
    case InertialState::lost:
      return "lost";
    case InertialState::refused:
      return "refused";
  }
  return "unknown";
}

double gravity_sigma(const InertialReport& report) {
  return report.nav ? std::sqrt(std::max(
                          0.0, report.nav_covariance.diagonal().segment<2>(kGravityAt).maxCoeff()))
                    : std::numeric_limits<double>::infinity();
}

}  // namespace adit
