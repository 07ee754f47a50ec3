// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "adit/slam/odometry/motion_model.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {

/// How well sweeps fit their submap when all is well: what a place that was found by a search is
/// measured by. (A search always ends somewhere; in a wrong place fewer points match.)
class UsualFit {
 public:
  /// An alignment from a trusted prediction that was used.
  void add(const RegistrationResult& alignment);
  /// With a new submap: nothing is usual any more.
  void forget() { *this = {}; }

  /// Why an alignment from an untrusted prediction is not to be believed, for people; none where
  /// it is (docs/theory/odometry.md, section 3).
  std::optional<std::string> doubt(const RegistrationResult& alignment,
                                   const Prediction& prediction) const;

 private:
  int alignments_ = 0;
  double overlap_ = 0.0;
  double rms_ = 0.0;  ///< m
};

}  // namespace adit
