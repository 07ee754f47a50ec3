// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How far a camera's mounting and clock are off, by whether its views agree on what surfaces look
// like (docs/theory/coloring.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "adit/tools/coloring/view_pairs.hpp"

namespace adit {

/// A camera's error: a rotation about the axes of its optical frame, rad, and the time that images
/// were taken after their stamps, s.
using CameraError = Eigen::Vector4d;

/// How large errors are before anything is known, one standard deviation: what mountings and
/// triggers keep, a degree and 20 ms.
CameraError camera_error_prior();

/// What views show of surfaces, sorted by surface, if the camera's error were `error`.
/// `hidden_by`: the error that what hides surfaces is drawn with. `blur`: of the images, pixels.
using SightSurfaces = std::function<std::vector<Sighted>(const CameraError& error,
                                                         const CameraError& hidden_by, int blur)>;

struct CameraErrorEstimate {
  CameraError error = CameraError::Zero();
  /// Eight views at least, twice the numbers that are estimated, see surfaces that later ones see,
  /// and these have some texture. Otherwise the error stays zero.
  bool determined = false;
  /// Surfaces that were not used for the estimate: on how many of them views agree better with it,
  /// and on how many worse.
  std::size_t better = 0;
  std::size_t worse = 0;

  /// So many more are better than worse as chance brings about in one of a thousand cases: three
  /// standard deviations of a fair coin's throws.
  bool is_better() const;
};

/// By Gauss-Newton on the differences between far views of each surface, from blurred images to
/// sharp ones, with the prior. `step`: of numerical derivatives. One half of the surfaces, by their
/// keys, is used; the other half tests.
CameraErrorEstimate estimate_camera_error(const SightSurfaces& sight, const CameraError& step);

}  // namespace adit
