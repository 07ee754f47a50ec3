// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/verify/verify.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <sstream>

#include "adit/slam/core/units.hpp"

namespace adit::test {
namespace {

using reference::Surface;
using reference::SurfaceKind;
using reference::SurfacePoint;

// Directions that the bound leaves free (three equal eigenvalues) are not compared.
constexpr double kUselessBound = 0.3;  // rad

// Collects at most a few complaints of each kind.
class Complaints {
 public:
  explicit Complaints(Verdict& verdict) : verdict_(&verdict) {}
  template <class... Parts>
  void add(const std::string& kind, const Parts&... parts) {
    constexpr int kMost = 3;
    const int count = ++counts_[kind];
    if (count <= kMost) {
      std::ostringstream text;
      text.precision(9);
      text << kind << ": ";
      (text << ... << parts);
      verdict_->problems.push_back(text.str());
    } else if (count == kMost + 1) {
      verdict_->problems.push_back(kind + ": and more");
    }
  }

 private:
  Verdict* verdict_;
  std::map<std::string, int> counts_;
};

void note(Verdict& verdict, const std::string& name, double value) {
  double& worst = verdict.worst[name];
  worst = std::max(worst, value);
}

Eigen::Vector3d position(const Point& p) {
  return {p.x, p.y, p.z};
}

bool is_line(const Surface& surface) {
  return surface.eigenvalues[1] < reference::kLineRatio * surface.eigenvalues[2];
}

// Angle (rad) by which a direction may be off, given what separates its eigenvalue from the next.
double direction_bound(const Surface& surface) {
  const Eigen::Vector3d& e = surface.eigenvalues;
  const bool line = is_line(surface);
  const double gap = line ? e[2] - e[1] : e[1] - e[0];
  return kCovarianceError / std::max(gap, 1e-12) + kPackingError;
}

bool class_is_certain(const Surface& surface) {
  return surface.margin > kCovarianceError &&
         (!reference::is_plane(surface.kind) ||
          std::abs(surface.incidence - reference::kEdgeOn) > direction_bound(surface));
}

Verdict compare_surfaces(std::span<const Surface> expected,
                         std::span<const reference::SeenPoint> cloud,
                         std::span<const gpu::uvec4> surface_cloud) {
  Verdict verdict;
  Complaints complaints(verdict);
  if (surface_cloud.size() != cloud.size()) {
    complaints.add("points", "expected ", cloud.size(), ", found ", surface_cloud.size());
    return verdict;
  }
  for (size_t i = 0; i < cloud.size(); ++i) {
    const gpu::uvec4& packed = surface_cloud[i];
    if (packed.x != std::bit_cast<uint32_t>(cloud[i].p.x()) ||
        packed.y != std::bit_cast<uint32_t>(cloud[i].p.y()) ||
        packed.z != std::bit_cast<uint32_t>(cloud[i].p.z())) {
      complaints.add("position", i, " is not the cloud's");
    }
    const Surface& surface = expected[i];
    const SurfacePoint found = reference::decode(packed);
    if (!class_is_certain(surface)) {
      verdict.worst["classes that rounding decides"] += 1.0;
      continue;
    }
    if (found.kind != surface.kind) {
      verdict.worst["wrong classes"] += 1.0;
      complaints.add("class", i, " of ", surface.neighbours, " neighbours: expected ",
                     static_cast<uint32_t>(surface.kind), ", found ",
                     static_cast<uint32_t>(found.kind));
      continue;
    }
    const double bound = direction_bound(surface);
    const bool ball =
        !is_line(surface) && surface.eigenvalues[0] > kFlattest * surface.eigenvalues[1];
    if (found.kind == SurfaceKind::isotropic || bound > kUselessBound || ball) {
      verdict.worst["without a direction"] += 1.0;
      continue;
    }
    verdict.worst[is_plane(found.kind) ? "normals compared" : "lines compared"] += 1.0;
    const double angle = std::atan2(found.direction.cross(surface.direction).norm(),
                                    std::abs(found.direction.dot(surface.direction)));
    if (!(angle <= bound)) {
      complaints.add("direction", i, ": ", angle * kDegreesPerRadian, " degrees off, bound ",
                     bound * kDegreesPerRadian, ", eigenvalues ", surface.eigenvalues.transpose(),
                     " of ", surface.neighbours, " neighbours");
    }
    const Eigen::Vector3d ray = cloud[i].ray.cast<double>().normalized();
    if (found.direction.dot(ray) > bound) {
      complaints.add("side", i, ": points away from the sensor");
    }
    note(verdict, "direction error, fraction of bound", angle / bound);
    note(verdict,
         bound < 0.5 / kDegreesPerRadian
             ? "direction error where the bound is below 0.5 degrees, degrees"
             : "direction error elsewhere, degrees",
         angle * kDegreesPerRadian);
  }
  return verdict;
}

}  // namespace

std::string Verdict::text() const {
  std::ostringstream text;
  for (const std::string& problem : problems) {
    text << problem << '\n';
  }
  for (const auto& [name, value] : worst) {
    text << name << " = " << value << '\n';
  }
  return text.str();
}

Verdict verify_downsample(const engine::PreprocessSettings& settings, std::span<const Point> raw,
                          const gpu::SweepCounters& counters, std::span<const Point> cloud) {
  Verdict verdict;
  Complaints complaints(verdict);
  const reference::Downsampled expected = reference::downsample(raw, settings);
  if (counters.valid_points != expected.valid_points) {
    complaints.add("valid points", "expected ", expected.valid_points, ", found ",
                   counters.valid_points);
  }
  if (counters.input_failures != 0) {
    complaints.add("lost points", counters.input_failures);
  }
  if (counters.cloud_points != expected.points.size() || cloud.size() != expected.points.size()) {
    complaints.add("cells", "expected ", expected.points.size(), ", found ", counters.cloud_points,
                   " and ", cloud.size(), " points");
    return verdict;
  }
  for (size_t i = 0; i < cloud.size(); ++i) {
    const reference::DownsampledPoint& point = expected.points[i];
    const Eigen::Array3d error = (position(cloud[i]) - point.centroid).array().abs();
    const Eigen::Array3d bound =
        settings.r_input * (0.51 / 65536.0 + 1e-7) + point.centroid.array().abs() * 2.5e-7;
    if (!(error <= bound).all()) {
      complaints.add("centroid", i, " of ", point.count, " points: expected ",
                     point.centroid.transpose(), ", found ", position(cloud[i]).transpose());
    }
    if (cloud[i].intensity != point.intensity) {
      complaints.add("intensity", i, ": expected ", point.intensity, ", found ",
                     cloud[i].intensity);
    }
    note(verdict, "centroid error, fraction of bound", (error / bound).maxCoeff());
    note(verdict, "centroid error, m", error.maxCoeff());
  }
  verdict.worst["centroids compared"] = static_cast<double>(cloud.size());
  return verdict;
}

Verdict verify_deskew(std::span<const Point> raw, std::span<const Eigen::Vector3d> expected,
                      std::span<const Point> moved) {
  Verdict verdict;
  Complaints complaints(verdict);
  if (moved.size() != expected.size()) {
    complaints.add("points", "expected ", expected.size(), ", found ", moved.size());
    return verdict;
  }
  for (size_t i = 0; i < moved.size(); ++i) {
    const double off = (position(moved[i]) - expected[i]).norm();
    const bool no_return = expected[i].isZero(0.0);
    if (no_return ? off != 0.0 : !(off <= kDeskewError)) {
      complaints.add("moved", "point ", i, " is ", off, " m off");
    } else {
      note(verdict, "moved, m", off);
    }
    if (std::bit_cast<uint32_t>(moved[i].intensity) != std::bit_cast<uint32_t>(raw[i].intensity)) {
      complaints.add("intensity", "point ", i, " has ", moved[i].intensity, " instead of ",
                     raw[i].intensity);
    }
  }
  return verdict;
}

Verdict verify_surfaces(const engine::PreprocessSettings& settings, std::span<const Point> cloud,
                        std::span<const gpu::uvec4> surface_cloud) {
  const std::vector<reference::SeenPoint> seen = reference::seen_from_origin(cloud);
  return compare_surfaces(reference::surfaces(seen, settings, reference::SurfaceSearch::wide), seen,
                          surface_cloud);
}

Verdict verify_surfaces(const engine::PreprocessSettings& settings,
                        std::span<const reference::SeenPoint> cloud,
                        std::span<const gpu::uvec4> surface_cloud) {
  return compare_surfaces(reference::surfaces(cloud, settings, reference::SurfaceSearch::own_cell),
                          cloud, surface_cloud);
}

Verdict verify_merged(const reference::MergedClouds& expected,
                      std::span<const gpu::MergeCell> cells) {
  Verdict verdict;
  Complaints complaints(verdict);
  std::map<reference::Cell, const gpu::MergeCell*> found;
  for (const gpu::MergeCell& cell : cells) {
    if (cell.key != gpu::kFree &&
        !found.emplace(reference::unpacked_cell(cell.key), &cell).second) {
      complaints.add("cells", "two have the key ", cell.key);
    }
  }
  const double error = expected.border;
  for (const auto& [at, cell] : expected.cells) {
    const auto place = found.find(at);
    if (!cell.certain) {
      verdict.worst["cells that rounding decides"] += 1.0;
    } else if (place == found.end()) {
      complaints.add("cell", "of ", cell.count, " points at ", at[0], " ", at[1], " ", at[2],
                     " is missing");
    } else {
      const gpu::MergeCell& device = *place->second;
      const Eigen::Vector3d mean =
          Eigen::Vector3d(device.sum_x, device.sum_y, device.sum_z) / device.count / 65536.0;
      const Eigen::Array3d off = (mean - cell.mean).array();
      const uint32_t sweep = ~device.inverted_nearest & ((1U << gpu::kSweepBits) - 1U);
      if (device.count != cell.count) {
        complaints.add("count", "expected ", cell.count, ", found ", device.count);
      } else if (!(off <= error).all() || !(off >= -error - 1.0 / 65536.0).all()) {
        complaints.add("mean", "of ", cell.count, " points is ", off.transpose(), " of a cell off");
      } else if (cell.nearest_is_certain && sweep != cell.nearest) {
        complaints.add("nearest", "expected sweep ", cell.nearest, ", found ", sweep);
      }
      note(verdict, "mean, of a cell", off.abs().maxCoeff());
      verdict.worst["cells compared"] += 1.0;
    }
    if (place != found.end()) {
      found.erase(place);
    }
  }
  for (const auto& [at, cell] : found) {
    if (!expected.near_a_border.contains(at)) {
      complaints.add("cell", "of ", cell->count, " points at ", at[0], " ", at[1], " ", at[2],
                     " is one too many");
    }
  }
  return verdict;
}

Verdict verify_voxel_map(const reference::VoxelMap& expected,
                         std::span<const gpu::GaussianCell> cells) {
  Verdict verdict;
  Complaints complaints(verdict);
  const reference::VoxelMap found = reference::decode(cells, expected.voxel_size);
  if (found.voxels.size() != expected.voxels.size()) {
    complaints.add("voxels", "expected ", expected.voxels.size(), ", found ", found.voxels.size());
  }
  for (const auto& [at, voxel] : expected.voxels) {
    const auto there = found.voxels.find(at);
    if (there == found.voxels.end()) {
      complaints.add("voxel", at[0], " ", at[1], " ", at[2], " is missing");
      continue;
    }
    const reference::Voxel& other = there->second;
    if (other.count != voxel.count) {
      complaints.add("count", at[0], " ", at[1], " ", at[2], ": expected ", voxel.count, ", found ",
                     other.count);
      continue;
    }
    if (other.surfaces != voxel.surfaces) {
      complaints.add("surfaces", at[0], " ", at[1], " ", at[2], ": expected ", voxel.surfaces,
                     ", found ", other.surfaces);
    }
    if (other.along != voxel.along || other.against != voxel.against) {
      complaints.add("faces", at[0], " ", at[1], " ", at[2], ": expected ", voxel.along, " and ",
                     voxel.against, ", found ", other.along, " and ", other.against);
    }
    const auto n = static_cast<double>(voxel.count);
    const double offset_error = (other.offset_sum - voxel.offset_sum).cwiseAbs().maxCoeff() / n;
    const double constraint_error =
        (other.constraint_sum - voxel.constraint_sum).cwiseAbs().maxCoeff() / n;
    if (!(offset_error <= 1.0 / 65536.0 + kMovedPointError)) {
      complaints.add("mean", at[0], " ", at[1], " ", at[2], ": off by ", offset_error, " voxels");
    }
    if (!(constraint_error <= 1.0 / 32768.0 + 1e-6)) {
      complaints.add("constraint", at[0], " ", at[1], " ", at[2], ": off by ", constraint_error);
    }
    note(verdict, "mean error, voxels", offset_error);
    note(verdict, "constraint error", constraint_error);
  }
  verdict.worst["voxels compared"] = static_cast<double>(expected.voxels.size());
  return verdict;
}

reference::System system_of(const gpu::RegistrationState& state) {
  reference::System system;
  size_t k = 0;
  const auto next = [&] { return static_cast<double>(state.system[k++]); };
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      system.hessian(i, j) = system.hessian(j, i) = next();
    }
  }
  for (int i = 0; i < 6; ++i) {
    system.gradient(i) = next();
  }
  system.cost = next();
  system.squared_distance = next();
  system.inliers = static_cast<int64_t>(next());
  return system;
}

Verdict verify_system(const reference::System& expected, const gpu::RegistrationState& state,
                      double bound) {
  Verdict verdict;
  Complaints complaints(verdict);
  const reference::System found = system_of(state);
  const auto compare = [&](const std::string& what, double a, double b, double scale) {
    const double error = std::abs(a - b) / scale;
    if (!(error <= bound)) {
      complaints.add(what, "expected ", a, ", found ", b, ": ", error, " of its scale");
    }
    note(verdict, what + " error, fraction of scale", error);
  };
  if (found.inliers != expected.inliers) {
    complaints.add("matches", "expected ", expected.inliers, ", found ", found.inliers);
  }
  const Vector6d diagonal = expected.hessian.diagonal();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      compare("H", expected.hessian(i, j), found.hessian(i, j),
              std::sqrt(diagonal[i] * diagonal[j]));
    }
    compare("g", expected.gradient(i), found.gradient(i), std::sqrt(diagonal[i] * expected.cost));
  }
  compare("cost", expected.cost, found.cost, expected.cost);
  compare("squared distance", expected.squared_distance, found.squared_distance,
          expected.squared_distance);
  verdict.worst["matches compared"] = static_cast<double>(expected.inliers);
  return verdict;
}

}  // namespace adit::test
