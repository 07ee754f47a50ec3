// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "adit/slam/core/types.hpp"
#include "adit/tools/containers/time_span.hpp"

namespace adit {

/// How much a gyroscope's rates change, second by second of the recorder's clock.
class RotationProfile {
 public:
  /// rad/s; what is not finite does not count.
  void add(Nanoseconds received, const Eigen::Vector3d& angular_velocity);

  /// The stretch of that length in which the rates change most; all where there is less. Nothing
  /// where nothing was added.
  std::optional<TimeSpan> liveliest(Nanoseconds length) const;

 private:
  struct Second {
    double samples = 0.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double squares = 0.0;
  };
  std::map<int64_t, Second> seconds_;  // by second
};

}  // namespace adit
