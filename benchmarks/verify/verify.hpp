// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Comparison of what a kernel wrote with what its twin computes, and the bounds. No GoogleTest
// here: benchmarks verify with it before they time.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "adit/benchmarks/reference/downsample.hpp"
#include "adit/benchmarks/reference/submap_merge.hpp"
#include "adit/benchmarks/reference/surfaces.hpp"
#include "adit/benchmarks/reference/vgicp.hpp"
#include "adit/benchmarks/reference/voxel_map.hpp"
#include "adit/shaders/shared/gaussian_cell.h"
#include "adit/shaders/shared/preprocess.h"
#include "adit/shaders/shared/registration.h"
#include "adit/shaders/shared/submap.h"

namespace adit::test {

struct Verdict {
  std::vector<std::string> problems;  ///< empty: within all bounds; at most a few of each kind
  std::map<std::string, double>
      worst;  ///< the largest errors and how many values were compared, for reports

  bool passed() const { return problems.empty(); }
  std::string text() const;  ///< problems and worst, one a line
};

/// Same cells in the same order, intensities exactly, numbers of points exactly, each coordinate of
/// a centroid within
///   r_input * 0.51 / 65536        offsets are rounded down to 1/65536 of a cell, plus half of that
///   + |coordinate| * 2.5e-7       four float32 roundings of a coordinate
///   + r_input * 1e-7.
Verdict verify_downsample(const engine::PreprocessSettings& settings, std::span<const Point> raw,
                          const gpu::SweepCounters& counters, std::span<const Point> cloud);

/// `expected` are the twin's. Each point within kDeskewError of it, no-returns exactly, intensities
/// as they were, bit for bit.
Verdict verify_deskew(std::span<const Point> raw, std::span<const Eigen::Vector3d> expected,
                      std::span<const Point> moved);
/// m. At 100 m float32 rounds by 4 um; the kernel's interpolation of 5 mrad between knots errs by
/// 5e-9 of the range.
inline constexpr double kDeskewError = 5e-5;

/// Given the device's own down-sampled cloud: positions bit for bit; class and direction as the
/// twin's. Sums of rounded products are within kCovarianceError (squares of the cell's edge) of the
/// covariance, which turns an eigenvector by no more than that over its eigenvalue's distance from
/// the next; the packing adds kPackingError. Classes may differ where the deciding number is within
/// these bounds of its threshold.
Verdict verify_surfaces(const engine::PreprocessSettings& settings, std::span<const Point> cloud,
                        std::span<const gpu::uvec4> surface_cloud);
/// The same for a cloud whose points were seen from several places.
Verdict verify_surfaces(const engine::PreprocessSettings& settings,
                        std::span<const reference::SeenPoint> cloud,
                        std::span<const gpu::uvec4> surface_cloud);
/// Planes whose smallest eigenvalue is more than kFlattest of the second are balls: their normals,
/// which the device finds by Newton steps that have not converged there, mean nothing and are not
/// compared.
inline constexpr double kFlattest = 0.75;
inline constexpr double kCovarianceError = 3e-5;
inline constexpr double kPackingError = 1.5e-4;  ///< rad

/// Same cells and counts, but for points so near a border that rounding of the moved point decides
/// (MergedClouds::border: kMovedPointError cells, twice over for a sum of rounded products of
/// metres far away; more where cells are finer than 0.25 m); means within 1/65536 of a cell,
/// rounded down, and that error; the nearest sweep where no other was as near, within
/// 2 / gpu::kRangeSteps m.
Verdict verify_merged(const reference::MergedClouds& expected,
                      std::span<const gpu::MergeCell> cells);

/// Same voxels and counts; per point, offsets within 1/65536 voxel and constraints within 1/32768,
/// both rounded down, besides float32 of the moved point (kMovedPointError voxels) and direction.
Verdict verify_voxel_map(const reference::VoxelMap& expected,
                         std::span<const gpu::GaussianCell> cells);
inline constexpr double kMovedPointError = 6e-5;

/// How far sums over the matches are from the twin's, as fractions of their natural scales: H(i, j)
/// of sqrt(H(i, i) H(j, j)), g(i) of sqrt(H(i, i) cost), cost and squared distance of themselves.
/// Matches exactly.
Verdict verify_system(const reference::System& expected, const gpu::RegistrationState& state,
                      double bound);

/// The system the device left, in the twin's form.
reference::System system_of(const gpu::RegistrationState& state);

}  // namespace adit::test
