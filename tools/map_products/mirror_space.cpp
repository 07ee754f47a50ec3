// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/mirror_space.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/support/parallel.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr double kFinestMirror = 0.2;  // m, a voxel's edge
// Rays, as in slam/submaps/moved_space: from behind what carries the sensor to before what they
// hit, by what surfaces and poses may be off by. m, and a share of the range.
constexpr double kMirrorRayBegins = 1.5;
constexpr double kMirrorRayMargin = 0.5;
constexpr double kMirrorRayShare = 0.02;
constexpr double kMirrorRayReach = 60.0;
constexpr double kOnePlane = 0.6;       // length of the mean of normals that agree
constexpr double kCrosses = 0.3;        // cosine: a ray at a smaller angle passes along a plane
constexpr double kSameNormal = 0.9;     // cosine between neighbours of a pane
constexpr std::size_t kLeastPane = 15;  // voxels: a square metre
constexpr int64_t kNextTo = 2;          // voxels between neighbours of a pane
constexpr int kNoPane = -1;

struct MirrorVoxel {
  VoxelIndex index = VoxelIndex::Zero();
  Vector3d sum = Vector3d::Zero();     ///< of points, m
  Vector3d normal = Vector3d::Zero();  ///< unit, zero where there is no plane
  uint32_t points = 0;
  uint32_t through = 0;  ///< rays
  uint32_t images = 0;   ///< points that are
  int pane = kNoPane;

  Vector3d centre() const { return sum / points; }
  bool is_plane() const { return !normal.isZero(); }
  bool lets_through() const { return through > points; }
};

struct Pane {
  Vector3d centre;
  Vector3d normal;
};

/// The voxels of a map, and the panes among them.
class MirrorSearch {
 public:
  explicit MirrorSearch(double edge) : edge_(edge) {}

  void add(const KeyframeSubmap& submap, const Eigen::Isometry3d& T_map_keyframe);
  void finish_voxels();
  void cast(const KeyframeSubmap& submap, const Eigen::Isometry3d& T_map_keyframe);
  void find_panes();
  void look_into_mirrors(const KeyframeSubmap& submap, const Eigen::Isometry3d& T_map_keyframe);
  MirrorSpace found() const;
  bool has_panes() const { return !panes_.empty(); }

 private:
  /// Calls look(voxel) for those that hold points in the cube around one.
  template <class Look>
  void visit_around(const VoxelIndex& middle, int64_t reach, const Look& look) const;
  MirrorVoxel* at(const VoxelIndex& index);
  const MirrorVoxel* at(const VoxelIndex& index) const;
  std::vector<std::size_t> connected(std::size_t seed) const;
  std::optional<Pane> plane_of(const std::vector<std::size_t>& voxels) const;
  void extend(std::vector<std::size_t> voxels, const Pane& pane);
  bool is_image(const Vector3d& point, const Vector3d& sensor, const MirrorVoxel& voxel) const;

  double edge_;
  std::unordered_map<uint64_t, std::size_t> places_;
  std::vector<MirrorVoxel> voxels_;
  std::vector<Pane> panes_;
};

MirrorVoxel* MirrorSearch::at(const VoxelIndex& index) {
  const auto found = places_.find(key_of(index));
  return found == places_.end() ? nullptr : &voxels_[found->second];
}

const MirrorVoxel* MirrorSearch::at(const VoxelIndex& index) const {
  const auto found = places_.find(key_of(index));
  return found == places_.end() ? nullptr : &voxels_[found->second];
}

template <class Look>
void MirrorSearch::visit_around(const VoxelIndex& middle, int64_t reach, const Look& look) const {
  for (int64_t x = -reach; x <= reach; ++x) {
    for (int64_t y = -reach; y <= reach; ++y) {
      for (int64_t z = -reach; z <= reach; ++z) {
        const auto found = places_.find(key_of(middle + VoxelIndex(x, y, z)));
        if (found != places_.end()) {
          look(found->second);
        }
      }
    }
  }
}

void MirrorSearch::add(const KeyframeSubmap& submap, const Eigen::Isometry3d& T_map_keyframe) {
  for (const SubmapPoint& point : submap.points) {
    const Vector3d p = T_map_keyframe * point.position();
    const VoxelIndex index = voxel_of(p, edge_);
    const auto [place, is_new] = places_.try_emplace(key_of(index), voxels_.size());
    if (is_new) {
      voxels_.push_back({.index = index});
    }
    MirrorVoxel& voxel = voxels_[place->second];
    voxel.sum += p;
    ++voxel.points;
    if (is_plane(point.surface)) {
      // Panes are seen from both sides: the line of the normal counts.
      const Vector3d normal = T_map_keyframe.linear() * surface_direction(point.surface);
      voxel.normal += voxel.normal.dot(normal) < 0.0 ? Vector3d(-normal) : normal;
    }
  }
}

void MirrorSearch::finish_voxels() {
  for (MirrorVoxel& voxel : voxels_) {
    const double length = voxel.normal.norm();
    voxel.normal =
        length > kOnePlane * voxel.points ? Vector3d(voxel.normal / length) : Vector3d::Zero();
  }
}

void MirrorSearch::cast(const KeyframeSubmap& submap, const Eigen::Isometry3d& T_map_keyframe) {
  std::vector<Vector3d> sensors;
  for (const SubmapSweep& sweep : submap.sweeps) {
    sensors.emplace_back(T_map_keyframe * sweep.T_keyframe_lidar.translation());
  }
  in_parallel(submap.points.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SubmapPoint& point = submap.points[i];
      if (point.sweep >= sensors.size()) {
        continue;
      }
      const Vector3d& sensor = sensors[point.sweep];
      const Vector3d way = T_map_keyframe * point.position() - sensor;
      const double range = way.norm();
      const double stop =
          std::min((1.0 - kMirrorRayShare) * range - kMirrorRayMargin, kMirrorRayReach);
      const Vector3d direction = way / std::max(range, edge_);
      const MirrorVoxel* last = nullptr;
      for (double along = kMirrorRayBegins; along <= stop; along += edge_) {
        MirrorVoxel* voxel = at(voxel_of(sensor + along * direction, edge_));
        if (voxel && voxel != last &&
            (!voxel->is_plane() || std::abs(voxel->normal.dot(direction)) > kCrosses)) {
          std::atomic_ref(voxel->through).fetch_add(1, std::memory_order_relaxed);
        }
        last = voxel;
      }
    }
  });
}

std::vector<std::size_t> MirrorSearch::connected(std::size_t seed) const {
  std::vector<std::size_t> voxels{seed};
  std::unordered_set<std::size_t> taken{seed};
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const MirrorVoxel& one = voxels_[voxels[i]];
    visit_around(one.index, kNextTo, [&](std::size_t other) {
      const MirrorVoxel& next = voxels_[other];
      if (next.pane == kNoPane && next.is_plane() && next.lets_through() &&
          std::abs(next.normal.dot(one.normal)) > kSameNormal &&
          std::abs((next.centre() - one.centre()).dot(one.normal)) < 0.5 * edge_ &&
          taken.insert(other).second) {
        voxels.push_back(other);
      }
    });
  }
  return voxels;
}

std::optional<Pane> MirrorSearch::plane_of(const std::vector<std::size_t>& voxels) const {
  Vector3d centre = Vector3d::Zero();
  for (const std::size_t i : voxels) {
    centre += voxels_[i].centre() / static_cast<double>(voxels.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const std::size_t i : voxels) {
    const Vector3d from = voxels_[i].centre() - centre;
    spread += from * from.transpose() / static_cast<double>(voxels.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  if (std::sqrt(std::max(0.0, solver.eigenvalues()[0])) > 0.5 * edge_) {
    return std::nullopt;
  }
  return Pane{.centre = centre, .normal = solver.eigenvectors().col(0)};
}

/// Takes in what lies in the plane beside it and lets rays through, too: of a pane that was seen
/// from afar, the voxels hold too few points for planes.
void MirrorSearch::extend(std::vector<std::size_t> voxels, const Pane& pane) {
  const auto number = static_cast<int>(panes_.size());
  for (const std::size_t i : voxels) {
    voxels_[i].pane = number;
  }
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    visit_around(voxels_[voxels[i]].index, kNextTo, [&](std::size_t other) {
      MirrorVoxel& next = voxels_[other];
      if (next.pane == kNoPane && next.lets_through() &&
          std::abs((next.centre() - pane.centre).dot(pane.normal)) < 0.5 * edge_) {
        next.pane = number;
        voxels.push_back(other);
      }
    });
  }
  panes_.push_back(pane);
}

void MirrorSearch::find_panes() {
  std::vector<char> tried(voxels_.size(), 0);
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    if (tried[i] != 0 || voxels_[i].pane != kNoPane || !voxels_[i].is_plane() ||
        !voxels_[i].lets_through()) {
      continue;
    }
    std::vector<std::size_t> voxels = connected(i);
    for (const std::size_t one : voxels) {
      tried[one] = 1;
    }
    if (voxels.size() < kLeastPane) {
      continue;
    }
    if (const auto pane = plane_of(voxels)) {
      extend(std::move(voxels), *pane);
    }
  }
}

bool MirrorSearch::is_image(const Vector3d& point, const Vector3d& sensor,
                            const MirrorVoxel& voxel) const {
  for (std::size_t i = 0; i < panes_.size(); ++i) {
    const Pane& pane = panes_[i];
    const double before = (sensor - pane.centre).dot(pane.normal);
    const double behind = (point - pane.centre).dot(pane.normal);
    if (before * behind >= 0.0 || std::abs(behind) < edge_ ||
        (voxel.is_plane() && std::abs(voxel.normal.dot(pane.normal)) < kCrosses)) {
      continue;
    }
    bool through_pane = false;
    const Vector3d at_pane = sensor + before / (before - behind) * (point - sensor);
    visit_around(voxel_of(at_pane, edge_), 1, [&](std::size_t other) {
      through_pane = through_pane || voxels_[other].pane == static_cast<int>(i);
    });
    if (!through_pane) {
      continue;
    }
    const VoxelIndex original = voxel_of(point - 2.0 * behind * pane.normal, edge_);
    bool has_original = false;
    visit_around(original, 1, [&](std::size_t other) {
      const VoxelIndex apart = (voxels_[other].index - original).cwiseAbs();
      has_original = has_original || (apart.sum() <= 1 && voxels_[other].pane == kNoPane);
    });
    if (has_original) {
      return true;
    }
  }
  return false;
}

void MirrorSearch::look_into_mirrors(const KeyframeSubmap& submap,
                                     const Eigen::Isometry3d& T_map_keyframe) {
  for (const SubmapPoint& point : submap.points) {
    if (point.sweep >= submap.sweeps.size()) {
      continue;
    }
    const Vector3d p = T_map_keyframe * point.position();
    const Vector3d sensor =
        T_map_keyframe * submap.sweeps[point.sweep].T_keyframe_lidar.translation();
    MirrorVoxel* voxel = at(voxel_of(p, edge_));
    if (voxel && is_image(p, sensor, *voxel)) {
      ++voxel->images;
    }
  }
}

MirrorSpace MirrorSearch::found() const {
  MirrorSpace space(edge_);
  space.panes = panes_.size();
  for (const MirrorVoxel& voxel : voxels_) {
    if (2 * voxel.images <= voxel.points) {
      continue;
    }
    for (int64_t x = -1; x <= 1; ++x) {
      for (int64_t y = -1; y <= 1; ++y) {
        for (int64_t z = -1; z <= 1; ++z) {
          const VoxelIndex beside = voxel.index + VoxelIndex(x, y, z);
          if (beside == voxel.index || at(beside) == nullptr) {
            space.add(beside);
          }
        }
      }
    }
  }
  return space;
}

}  // namespace

MirrorSpace find_mirror_space(const MapDatabase& map, uint64_t submap_bytes,
                              const std::function<void(std::size_t, std::size_t)>& progress) {
  SubmapCache cache(submap_loader(map), submap_bytes);
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  double edge = kFinestMirror;
  if (!keyframes.empty()) {
    edge = std::max(edge, load_submap(cache, keyframes.front().id, map.file())->r_submap);
  }
  MirrorSearch search(edge);
  std::size_t done = 0;
  const auto for_each = [&](const auto& work) {
    for (const MapKeyframe& keyframe : keyframes) {
      work(*load_submap(cache, keyframe.id, map.file()), keyframe.T_map_keyframe);
      progress(++done, 3 * keyframes.size());
    }
  };
  for_each([&](const auto& submap, const auto& T) { search.add(submap, T); });
  search.finish_voxels();
  for_each([&](const auto& submap, const auto& T) { search.cast(submap, T); });
  search.find_panes();
  if (search.has_panes()) {
    for_each([&](const auto& submap, const auto& T) { search.look_into_mirrors(submap, T); });
  } else if (done > 0) {
    progress(3 * keyframes.size(), 3 * keyframes.size());
  }
  return search.found();
}

}  // namespace adit
