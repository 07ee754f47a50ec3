// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/surface_elements.hpp"

#include <cmath>

#include "adit/slam/core/median.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr double kLeastSigma = 0.01;  // m: points are rounded, and cells are means
// Sine of the angle between a ray and a plane that it crosses: below 12 degrees an error of the
// range of 4 cm moves the crossing by a voxel of 0.2 m.
constexpr double kLeastSlope = 0.2;
constexpr double kSameFacing = 0.7;  // cosine between normals of one plane: 45 degrees
// Length of the mean of a plane's unit normals: two halves that differ by more than 106 degrees are
// a corner or both sides of a thin wall.
constexpr double kOnePlane = 0.6;
constexpr double kFarthest = 1e6;    // m, from the map's origin
constexpr double kLongest = 1000.0;  // m, a ray
constexpr int64_t kBlock = 8;        // voxels along a block, which rays skip if nothing is there

/// Damaged maps have points anywhere.
bool is_possible(const Vector3d& p) {
  return (p.array().abs() < kFarthest).all();
}

/// Visits the cells of a grid that a ray passes from `begin` to `end` (m along it), with the part
/// of it in each.
template <class Visitor>
void traverse(const Vector3d& from, const Vector3d& direction, double begin, double end,
              double edge, const Visitor& visit) {
  VoxelIndex cell = voxel_of(from + begin * direction, edge);
  Vector3d next;
  Vector3d step;
  for (int k = 0; k < 3; ++k) {
    step[k] = direction[k] == 0.0 ? std::numeric_limits<double>::infinity()
                                  : edge / std::abs(direction[k]);
    const double border = edge * static_cast<double>(cell[k] + (direction[k] > 0.0 ? 1 : 0));
    next[k] = direction[k] == 0.0 ? std::numeric_limits<double>::infinity()
                                  : (border - from[k]) / direction[k];
  }
  for (double at = begin; at < end;) {
    int axis = 0;
    const double leaves = std::min(end, next.minCoeff(&axis));
    visit(cell, at, leaves);
    cell[axis] += direction[axis] > 0.0 ? 1 : -1;
    next[axis] += step[axis];
    at = leaves;
  }
}

/// The axis of the map that a direction is closest to.
std::size_t axis_of(const Vector3d& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::size_t>(axis);
}

}  // namespace

std::vector<Sighting> sightings_of(const PlacedSubmap& placed) {
  std::vector<Vector3d> sensors;
  for (const SubmapSweep& sweep : placed.submap->sweeps) {
    sensors.emplace_back(placed.T_map_keyframe * sweep.T_keyframe_lidar.translation());
  }
  std::vector<Sighting> sightings;
  sightings.reserve(placed.submap->points.size());
  for (const SubmapPoint& point : placed.submap->points) {
    const Vector3d p = placed.T_map_keyframe * point.position();
    if (point.sweep >= sensors.size() || !is_possible(p) || !is_possible(sensors[point.sweep])) {
      continue;
    }
    sightings.push_back(
        {.p = p,
         .sensor = sensors[point.sweep],
         .normal = is_plane(point.surface)
                       ? Vector3d(placed.T_map_keyframe.linear() * surface_direction(point.surface))
                       : Vector3d::Zero(),
         .moves = point.seen_through});
  }
  return sightings;
}

void SurfaceElements::add_surface(const std::vector<Sighting>& sightings, uint32_t session) {
  for (const Sighting& sighting : sightings) {
    const VoxelIndex voxel = voxel_of(sighting.p, edge_);
    if (sighting.moves || !is_in(voxel)) {
      continue;
    }
    ++points_;
    const auto [found, is_new] = first_.try_emplace(key_of(voxel), kNoNumber);
    uint32_t at = found->second;
    while (at != kNoNumber && elements_[at].session != session) {
      at = elements_[at].next;
    }
    if (at == kNoNumber) {
      at = static_cast<uint32_t>(elements_.size());
      elements_.push_back({.voxel = voxel, .session = session, .next = found->second});
      found->second = at;
    }
    SurfaceElement& element = elements_[at];
    element.mean += sighting.p;
    element.normal += sighting.normal;
    ++element.points;
  }
}

void SurfaceElements::finish_surfaces() {
  for (SurfaceElement& element : elements_) {  // of sums
    const double count = element.points;
    element.mean /= count;
    element.normal /= count;
    element.is_plane = element.normal.norm() > kOnePlane;
    element.normal.normalize();
  }
}

template <class Visitor>
void SurfaceElements::visit_near(const Vector3d& p, const Visitor& visitor) {
  const VoxelIndex middle = voxel_of(p, edge_);
  if (middle.x() < low_[0] - 1 || middle.y() < low_[1] - 1 || middle.x() > high_[0] ||
      middle.y() > high_[1]) {
    return;
  }
  for (int64_t x = -1; x <= 1; ++x) {
    for (int64_t y = -1; y <= 1; ++y) {
      for (int64_t z = -1; z <= 1; ++z) {
        const auto found = first_.find(key_of(middle + VoxelIndex(x, y, z)));
        for (uint32_t at = found == first_.end() ? kNoNumber : found->second; at != kNoNumber;
             at = elements_[at].next) {
          visitor(elements_[at]);
        }
      }
    }
  }
}

void SurfaceElements::add_misfit(const std::vector<Sighting>& sightings, uint32_t submap,
                                 uint32_t session) {
  std::array<std::vector<double>, 3> offs;
  std::array<std::vector<double>, 3> ranges;
  for (const Sighting& sighting : sightings) {
    if (sighting.moves || sighting.normal.isZero()) {
      continue;
    }
    const SurfaceElement* nearest = nullptr;
    double distance = edge_;
    visit_near(sighting.p, [&](const SurfaceElement& element) {
      const double apart = (sighting.p - element.mean).norm();
      if (element.session != session && element.is_plane && apart < distance &&
          std::abs(element.normal.dot(sighting.normal)) > kSameFacing) {
        nearest = &element;
        distance = apart;
      }
    });
    if (nearest != nullptr) {
      const std::size_t axis = axis_of(nearest->normal);
      offs[axis].push_back(std::abs(nearest->normal.dot(sighting.p - nearest->mean)));
      ranges[axis].push_back((sighting.p - sighting.sensor).norm());
    }
  }
  Fits& fits = fits_of(submap);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (offs[axis].size() >= kLeastPlaneMatches) {
      constexpr double kSigmaOfMedian = 1.4826;  // of the magnitudes of normal errors
      fits[axis].sigma = std::max(kLeastSigma, kSigmaOfMedian * median(offs[axis]));
      fits[axis].range = median(ranges[axis]);
      fits[axis].is_known = true;
    }
  }
}

/// The axis along which a plane faces; of other elements the one that is known worst.
SurfaceElements::Fit SurfaceElements::fit_along(const Fits& fits, const SurfaceElement& element) {
  if (element.is_plane) {
    return fits[axis_of(element.normal)];
  }
  return *std::ranges::max_element(fits, {}, &Fit::sigma);
}

bool SurfaceElements::is_hit(const SurfaceElement& element, const Sighting& sighting,
                             double reach) const {
  const Vector3d apart = sighting.p - element.mean;
  if (!element.is_plane) {
    return apart.norm() < std::max(edge_, reach);
  }
  const double off = element.normal.dot(apart);
  if (std::abs(off) > reach || (apart - off * element.normal).norm() > edge_) {
    return false;
  }
  return sighting.normal.isZero() || std::abs(element.normal.dot(sighting.normal)) > kSameFacing;
}

void SurfaceElements::mark_hits(const std::vector<Sighting>& sightings, uint32_t submap,
                                uint32_t session, bool counts) {
  Fits& fits = fits_of(submap);
  for (const Sighting& sighting : sightings) {
    if (sighting.moves) {
      continue;
    }
    const double range = (sighting.p - sighting.sensor).norm();
    visit_near(sighting.p, [&](SurfaceElement& element) {
      if (element.hit_by == submap ||
          !is_hit(element, sighting, fit_along(fits, element).reach(range))) {
        return;
      }
      element.hit_by = submap;
      if (counts) {
        ++votes_of(element, session).hits;
        if (element.is_plane && element.session != session) {
          ++fits[axis_of(element.normal)].hits;
        }
      }
    });
  }
}

void SurfaceElements::choose_candidates(uint32_t first_session, uint32_t last_session) {
  is_candidate_.assign(elements_.size(), 0);
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    SurfaceElement& element = elements_[i];
    element.hit_by = kNoNumber;
    const bool may_be_gone =
        element.session < last_session && element.after.hits < kLeastSeenThrough;
    const bool may_be_new =
        element.session > first_session && element.before.hits < kLeastSeenThrough;
    if (may_be_gone || may_be_new) {
      is_candidate_[i] = 1;
      blocks_.insert(key_of(voxel_of(element.voxel.cast<double>(), static_cast<double>(kBlock))));
    }
  }
}

bool SurfaceElements::is_crossed(const SurfaceElement& element, const Sighting& sighting,
                                 const Vector3d& direction, double range, double reach) const {
  const Vector3d to = element.mean - sighting.sensor;
  if (!element.is_plane) {
    const double along = to.dot(direction);
    const double aside = (to - along * direction).norm();
    return aside < 0.25 * edge_ && range - along > 0.5 * edge_ + reach;
  }
  const double slope = element.normal.dot(direction);
  if (std::abs(slope) < kLeastSlope) {
    return false;
  }
  const double along = element.normal.dot(to) / slope;
  const double aside = (to - along * direction).norm();
  return aside < 0.5 * edge_ && (range - along) * std::abs(slope) > reach;
}

void SurfaceElements::cast(const std::vector<Sighting>& sightings, uint32_t submap,
                           uint32_t session) {
  Fits& fits = fits_of(submap);
  const double block = edge_ * static_cast<double>(kBlock);
  std::vector<uint32_t> crossed;
  for (const Sighting& sighting : sightings) {
    const double range = (sighting.p - sighting.sensor).norm();
    if (range < edge_ || range > kLongest) {
      continue;
    }
    const Vector3d direction = (sighting.p - sighting.sensor) / range;
    const auto look = [&](const VoxelIndex& voxel, double, double) {
      const auto found = first_.find(key_of(voxel));
      for (uint32_t at = found == first_.end() ? kNoNumber : found->second; at != kNoNumber;
           at = elements_[at].next) {
        SurfaceElement& element = elements_[at];
        if (is_candidate_[at] != 0 && element.hit_by != submap && element.through_by != submap &&
            is_crossed(element, sighting, direction, range,
                       fit_along(fits, element).reach(range))) {
          element.through_by = submap;
          crossed.push_back(at);
        }
      }
    };
    traverse(sighting.sensor, direction, 0.0, range, block,
             [&](const VoxelIndex& cell, double enters, double leaves) {
               if (blocks_.contains(key_of(cell))) {
                 traverse(sighting.sensor, direction, enters, leaves, edge_, look);
               }
             });
  }
  for (const uint32_t at : crossed) {
    if (elements_[at].session != session && elements_[at].is_plane) {
      ++fits[axis_of(elements_[at].normal)].through;
    }
  }
  // A wrong pose along any axis shows where planes end, too.
  const bool may_vote = std::ranges::all_of(fits, &Fit::is_placed);
  for (const uint32_t at : crossed) {
    SurfaceElement& element = elements_[at];
    if (element.session == session) {
      ++element.own.through;
    } else if (may_vote) {
      ++votes_of(element, session).through;
      if (session < element.session) {
        element.nearest_before = std::max(element.nearest_before, session);
      } else {
        element.nearest_after = std::min(element.nearest_after, session);
      }
    }
  }
}

}  // namespace adit
