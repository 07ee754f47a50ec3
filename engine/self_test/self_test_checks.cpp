// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/self_test/self_test_checks.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/core.h>

namespace adit::engine {
namespace {

using Vector = std::array<double, 3>;

constexpr double kCentroidTolerance = 2e-5;  // m; float32 at 5 m and 1/65536 of a cell: 4e-6
constexpr double kNormalTolerance =
    1.7e-3;                               // for unit vectors: 0.1 degrees; the packing takes 0.005
constexpr double kMassTolerance = 1e-4;   // m; 1/65536 of a voxel and float32: 1e-5
constexpr double kTraceTolerance = 1e-4;  // per point; entries are rounded down to 1/32768
constexpr double kPositionTolerance = 5e-4;  // m; see check_alignment
constexpr double kRotationTolerance = 2e-4;  // rad
constexpr double kPositionToleranceNdt = 5e-3;
constexpr double kRotationToleranceNdt = 2e-3;
constexpr double kMatchedFractionNdt = 0.5;
constexpr double kMatchedFraction =
    0.95;  // points at the border of a voxel may fall beside the map

std::string count(uint64_t n) {
  return std::to_string(n);
}

std::string number(double value) {
  return fmt::format("{:.3g}", value);
}

double distance(const Vector& a, const Vector& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

// A comparison that a NaN fails.
bool within(double value, double limit) {
  return value <= limit;
}

// The larger, or NaN if either is.
double worse(double a, double b) {
  return std::isnan(a) || a > b ? a : b;
}

Vector unpack_direction(uint32_t packed) {
  const auto entry = [](uint32_t bits) {
    return (static_cast<double>(bits & 0x7fffU) - 16383.0) / 16383.0;
  };
  double x = entry(packed >> 15U);
  double y = entry(packed);
  const double z = 1.0 - std::abs(x) - std::abs(y);
  if (z < 0.0) {
    const double folded = std::copysign(1.0 - std::abs(y), x);
    y = std::copysign(1.0 - std::abs(x), y);
    x = folded;
  }
  const double length = std::hypot(x, y, z);
  return {x / length, y / length, z / length};
}

Vector apply(const gpu::mat3x4& pose, const Vector& p) {
  Vector result{};
  for (size_t i = 0; i < 3; ++i) {
    const gpu::vec4& row = pose.rows[i];
    result[i] = static_cast<double>(row.x) * p[0] + static_cast<double>(row.y) * p[1] +
                static_cast<double>(row.z) * p[2] + static_cast<double>(row.w);
  }
  return result;
}

uint64_t planes_of(const KnownScene& scene) {
  return static_cast<uint64_t>(std::count_if(scene.cloud.begin(), scene.cloud.end(),
                                             [](const KnownPoint& point) { return point.plane; }));
}

bool is_empty(const gpu::GaussianCell& cell) {
  return (cell.count | cell.sum_x | cell.sum_y | cell.sum_z | cell.xx | cell.xy | cell.xz |
          cell.yy | cell.yz | cell.zz | cell.surfaces) == 0;
}

}  // namespace

SelfTestCase check_insert(const KnownScene& scene, const gpu::SweepCounters& counters) {
  return {"downsample_insert",
          counters.valid_points == scene.valid_points && counters.input_failures == 0,
          "expected " + count(scene.valid_points) + " valid of " + count(scene.raw.size()) +
              " points and none lost, found " + count(counters.valid_points) + " valid and " +
              count(counters.input_failures) + " lost"};
}

SelfTestCase check_count(const KnownScene& scene, const gpu::SweepCounters& counters) {
  return {"downsample_count", counters.cloud_points == scene.cloud.size(),
          "expected " + count(scene.cloud.size()) + " occupied cells, found " +
              count(counters.cloud_points)};
}

SelfTestCase check_emit(const KnownScene& scene, std::span<const gpu::vec4> cloud) {
  double worst = 0.0;
  uint64_t wrong_intensities = 0;
  for (size_t i = 0; i < scene.cloud.size(); ++i) {
    const Vector p{static_cast<double>(cloud[i].x), static_cast<double>(cloud[i].y),
                   static_cast<double>(cloud[i].z)};
    worst = worse(distance(p, scene.cloud[i].centroid), worst);
    wrong_intensities += static_cast<double>(cloud[i].w) == scene.cloud[i].intensity ? 0U : 1U;
  }
  return {"downsample_emit", within(worst, kCentroidTolerance) && wrong_intensities == 0,
          "expected centroids in order of the sweep within " + number(kCentroidTolerance) +
              " m, found them within " + number(worst) + " m; " + count(wrong_intensities) +
              " intensities wrong"};
}

SelfTestCase check_normals(const KnownScene& scene, std::span<const gpu::uvec4> surface_cloud,
                           const gpu::SweepCounters& counters) {
  double worst = 0.0;
  uint64_t wrong_classes = 0;
  for (size_t i = 0; i < scene.cloud.size(); ++i) {
    const KnownPoint& point = scene.cloud[i];
    const uint32_t packed = surface_cloud[i].w;
    if ((packed >> 30U) != (point.plane ? 1U : 0U)) {
      wrong_classes += 1;
    } else if (point.plane) {
      worst = worse(distance(unpack_direction(packed), point.normal), worst);
    }
  }
  return {"surface_normals",
          wrong_classes == 0 && within(worst, kNormalTolerance) && counters.surface_failures == 0,
          "expected " + count(planes_of(scene)) + " of " + count(scene.cloud.size()) +
              " points on planes, with unit normals within " + number(kNormalTolerance) +
              ", found " + count(wrong_classes) + " wrong classes and normals within " +
              number(worst) + "; " + count(counters.surface_failures) + " points lost"};
}

SelfTestCase check_voxel_map(const KnownScene& scene, const FoundVoxelMap& map) {
  uint64_t points = 0;
  uint64_t voxels = 0;
  double trace = 0.0;
  Vector mass{};
  for (const gpu::GaussianCell& cell : map.cells) {
    if (cell.key == gpu::kFree) {
      continue;
    }
    voxels += 1;
    points += points_of(cell);
    const double n = points_of(cell);
    const uint32_t biased = cell.key - 1U;
    const Vector corner{static_cast<double>(biased >> 21U) - 1024.0,
                        static_cast<double>((biased >> 10U) & 2047U) - 1024.0,
                        static_cast<double>(biased & 1023U) - 512.0};
    const Vector sum{static_cast<double>(cell.sum_x), static_cast<double>(cell.sum_y),
                     static_cast<double>(cell.sum_z)};
    for (size_t k = 0; k < 3; ++k) {
      mass[k] += (corner[k] * n + (sum[k] + 0.5 * n) / 65536.0) * map.voxel_size;
    }
    trace += (static_cast<double>(cell.xx) + static_cast<double>(cell.yy) +
              static_cast<double>(cell.zz)) /
                 32768.0 -
             3.0 * static_cast<double>(surfaces_of(cell));
  }
  Vector expected_mass{};
  const gpu::mat3x4 pose = known_pose();
  for (const KnownPoint& point : scene.cloud) {
    const Vector p = apply(pose, point.centroid);
    for (size_t k = 0; k < 3; ++k) {
      expected_mass[k] += p[k];
    }
  }
  const auto n = static_cast<double>(scene.cloud.size());
  const double mass_error = distance(mass, expected_mass) / n;
  const double trace_error = std::abs(trace - static_cast<double>(planes_of(scene))) / n;
  const auto remains = static_cast<uint64_t>(
      std::count_if(map.emptied.begin(), map.emptied.end(),
                    [](const gpu::GaussianCell& cell) { return !is_empty(cell); }));
  const bool passed = points == scene.cloud.size() && voxels == map.counters.used_slots &&
                      map.counters.failures == 0 && map.counters.out_of_range == 0 &&
                      within(mass_error, kMassTolerance) && within(trace_error, kTraceTolerance) &&
                      remains == 0;
  return {"voxel_map_add", passed,
          "expected " + count(scene.cloud.size()) + " points, none lost, centre of mass within " +
              number(kMassTolerance) + " m and an empty map after their removal, found " +
              count(points) + " in " + count(voxels) + " voxels (" +
              count(map.counters.used_slots) + " counted), " +
              count(map.counters.failures + uint64_t{map.counters.out_of_range}) +
              " lost, centre of mass within " + number(mass_error) + " m, constraints within " +
              number(trace_error) + ", " + count(remains) + " voxels left"};
}

// Three planes at right angles: each Gaussian of enough points is flat, its widened covariance
// symmetric and positive, and its mean one of the map's.
SelfTestCase check_finished_map(const KnownScene& scene,
                                std::span<const gpu::GaussianCell> finished) {
  uint64_t gaussians = 0;
  uint64_t points = 0;
  uint64_t flat = 0;
  for (const gpu::GaussianCell& cell : finished) {
    if (cell.key == gpu::kFree || cell.count == 0) {
      continue;
    }
    gaussians += 1;
    points += cell.count;
    const auto number_of = [](uint32_t bits) {
      return static_cast<double>(std::bit_cast<float>(bits));
    };
    const double xx = number_of(cell.xx);
    const double xy = number_of(cell.xy);
    const double xz = number_of(cell.xz);
    const double yy = number_of(cell.yy);
    const double yz = number_of(cell.yz);
    const double zz = number_of(cell.zz);
    const double trace = xx + yy + zz;
    const double determinant =
        xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    // A plane's: (1, a, least) of the largest with the least at 0.01.
    flat += determinant > 0.0 && determinant < 0.02 * trace * trace * trace && trace > 0.0 &&
                    trace < 1.0
                ? 1U
                : 0U;
  }
  const bool passed = gaussians > 20 && points <= scene.cloud.size() && flat == gaussians;
  return {"voxel_map_finish", passed,
          "expected more than 20 flat Gaussians of at most " + count(scene.cloud.size()) +
              " points, found " + count(gaussians) + " of " + count(points) + " points, " +
              count(flat) + " of them flat"};
}

// At the known pose every point is matched with its own voxel. The gradient vanishes there but for
// voxels that hold points of more than one class, which move the optimum by less than 0.1 mm; NDT
// leaves out voxels of few points.
SelfTestCase check_alignment(const KnownScene& scene, std::string_view method,
                             const FoundAlignment& found) {
  const gpu::RegistrationState& state = found.state;
  const gpu::RegistrationProgress& progress = found.progress;
  const gpu::mat3x4 expected = known_pose();
  double rotation = 0.0;
  for (size_t i = 0; i < 3; ++i) {
    const gpu::vec4& a = state.pose.rows[i];
    const gpu::vec4& b = expected.rows[i];
    for (const auto& [x, y] : {std::pair{a.x, b.x}, std::pair{a.y, b.y}, std::pair{a.z, b.z}}) {
      rotation += std::pow(static_cast<double>(x) - static_cast<double>(y), 2);
    }
  }
  rotation = std::sqrt(0.5 * rotation);  // |A - B| = sqrt(2) * the angle between, to first order
  const double position = distance(apply(state.pose, {}), apply(expected, {}));
  const auto matched = static_cast<double>(state.system[gpu::kInliersAt]);
  const auto n = static_cast<double>(scene.cloud.size());
  const bool ndt = method == "ndt";
  const double least = (ndt ? kMatchedFractionNdt : kMatchedFraction) * n;
  const double position_tolerance = ndt ? kPositionToleranceNdt : kPositionTolerance;
  const double rotation_tolerance = ndt ? kRotationToleranceNdt : kRotationTolerance;
  const bool passed =
      progress.phase == gpu::kPhaseDone && progress.converged == 1 && progress.failed == 0 &&
      found.header.iterate.groups_x == 0 && within(position, position_tolerance) &&
      within(rotation, rotation_tolerance) && within(least, matched) && matched <= n;
  return {ndt ? "registration_linearize (NDT)" : "registration_linearize", passed,
          "expected a known pose within " + number(1e3 * position_tolerance) + " mm and " +
              number(1e3 * rotation_tolerance) + " mrad with at least " + number(least) +
              " matches, found it within " + number(1e3 * position) + " mm and " +
              number(1e3 * rotation) + " mrad with " + number(matched) + " matches after " +
              count(progress.iterations) + " iterations, " +
              (progress.failed != 0 ? "failed"
                                    : (progress.converged != 0 ? "converged" : "not converged"))};
}

// Three planes at right angles hold every direction.
SelfTestCase check_directions(const FoundAlignment& found) {
  uint64_t held = 0;
  double least = found.state.support[0].x;
  for (size_t k = 0; k < 6; ++k) {
    held += found.state.share[k] == 1.0F ? 1U : 0U;
    least = std::min(least, static_cast<double>(found.state.support[k].x));
  }
  return {"registration_localize", held == 6 && found.state.constrained == 0,
          "expected 6 directions held, found " + count(held) + ", the weakest by a support of " +
              number(least)};
}

}  // namespace adit::engine
