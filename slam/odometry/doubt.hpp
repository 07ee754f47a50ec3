// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "adit/slam/odometry/motion_model.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {

/// The alignment is within so many standard deviations of the prediction.
bool is_within(const RegistrationResult& alignment, const Prediction& prediction, double sigmas);

/// How well sweeps fit their submap when all is well: what each alignment is measured by. (An
/// alignment always ends somewhere; in a wrong place fewer points match.)
class UsualFit {
 public:
  /// An alignment from a trusted prediction that was used.
  void add(const RegistrationResult& alignment);
  /// With a new submap: nothing is usual any more.
  void forget() { *this = {}; }

  /// An alignment from a trusted prediction alone fits worse than usual, or failed: the place is
  /// to be searched for.
  bool falls_short(const RegistrationResult& alignment) const;

  /// Why an alignment that a search found or confirmed is not to be believed, for people; none
  /// where it is (docs/theory/odometry.md, section 3).
  std::optional<std::string> doubt(const RegistrationResult& alignment,
                                   const Prediction& prediction) const;

 private:
  int alignments_ = 0;
  double overlap_ = 0.0;
  double rms_ = 0.0;  ///< m
};

}  // namespace adit
