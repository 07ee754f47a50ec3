// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/changed_objects.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

namespace adit {
namespace {

using Place = std::tuple<ChangeOfSpace, int64_t, int64_t, int64_t>;

Place place_of(const ChangedVoxel& voxel, const VoxelIndex& offset) {
  const VoxelIndex at = voxel.voxel + offset;
  return {voxel.change, at.x(), at.y(), at.z()};
}

/// Voxels by place and change: more than one where several sessions have a surface there.
class Neighbours {
 public:
  explicit Neighbours(std::span<const ChangedVoxel> voxels) : voxels_(voxels) {
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      places_[place_of(voxels[i], VoxelIndex::Zero())].push_back(i);
    }
  }

  template <class Visitor>
  void visit(std::size_t voxel, const Visitor& visitor) const {
    for (int64_t x = -1; x <= 1; ++x) {
      for (int64_t y = -1; y <= 1; ++y) {
        for (int64_t z = -1; z <= 1; ++z) {
          const auto found = places_.find(place_of(voxels_[voxel], {x, y, z}));
          if (found != places_.end()) {
            std::ranges::for_each(found->second, visitor);
          }
        }
      }
    }
  }

 private:
  std::span<const ChangedVoxel> voxels_;
  std::map<Place, std::vector<std::size_t>> places_{};
};

}  // namespace

std::vector<std::vector<std::size_t>> changed_objects(std::span<const ChangedVoxel> voxels,
                                                      std::size_t least_points) {
  const Neighbours neighbours(voxels);
  std::vector<bool> changes(voxels.size(), false);
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (voxels[i].log_odds >= kChangedLogOdds) {
      neighbours.visit(i, [&](std::size_t other) {
        changes[other] = changes[other] || voxels[other].log_odds >= kLeastLogOdds;
      });
    }
  }
  std::vector<bool> taken(voxels.size(), false);
  std::vector<std::vector<std::size_t>> objects;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (!changes[i] || taken[i]) {
      continue;
    }
    std::vector<std::size_t> object{i};
    taken[i] = true;
    std::size_t points = 0;
    for (std::size_t next = 0; next < object.size(); ++next) {
      const std::size_t here = object[next];
      points += voxels[here].points.size();
      neighbours.visit(here, [&](std::size_t other) {
        if (changes[other] && !taken[other]) {
          taken[other] = true;
          object.push_back(other);
        }
      });
    }
    if (points >= least_points) {
      std::ranges::sort(object);
      objects.push_back(std::move(object));
    }
  }
  return objects;
}

}  // namespace adit
