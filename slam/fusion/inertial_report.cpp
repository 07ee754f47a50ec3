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

bool starts_at_rest_since(Nanoseconds begin, const InertialReport& report) {
  const auto* started = report.event ? std::get_if<SensorStarted>(&report.event->cause) : nullptr;
  return started != nullptr && started->since <= begin &&
         std::holds_alternative<StartedAtRest>(started->how);
}

double gravity_sigma(const InertialReport& report) {
  return report.nav ? std::sqrt(std::max(
                          0.0, report.nav_covariance.diagonal().segment<2>(kGravityAt).maxCoeff()))
                    : std::numeric_limits<double>::infinity();
}

}  // namespace adit
