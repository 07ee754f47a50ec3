// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The surfaces of several sessions in pieces, and which submaps see them or see through them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <Eigen/Core>

#include "adit/slam/submaps/moved_space.hpp"

namespace adit {

/// Instead of the number of an element, session or submap.
inline constexpr uint32_t kNoNumber = std::numeric_limits<uint32_t>::max();
/// Nearer than that to a surface, a point lies on it.
inline constexpr double kSigmasOfReach = 3.0;
/// Points on planes of other sessions, so that their distances say how far a submap is off.
inline constexpr std::size_t kLeastPlaneMatches = 30;
/// Submaps that see through a surface: one alone may be misplaced.
inline constexpr uint32_t kLeastSeenThrough = 2;

/// How often submaps see a surface, and see through it.
struct SurfaceVotes {
  uint32_t hits = 0;
  uint32_t through = 0;
};

/// The part of a session's surface that lies in a voxel.
struct SurfaceElement {
  VoxelIndex voxel = VoxelIndex::Zero();
  uint32_t session = 0;
  uint32_t next = kNoNumber;                         ///< another session's in the same voxel
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();    ///< of its points
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< of its planes
  uint32_t points = 0;
  bool is_plane = false;
  SurfaceVotes own{};
  SurfaceVotes before{};               ///< of earlier sessions
  SurfaceVotes after{};                ///< of later ones
  uint32_t nearest_before = 0;         ///< session that sees through it
  uint32_t nearest_after = kNoNumber;  ///< the same
  uint32_t hit_by = kNoNumber;         ///< submap
  uint32_t through_by = kNoNumber;     ///< submap
};

/// A point of a submap, seen from its sensor.
struct Sighting {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d sensor = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< zero: it is no plane
  bool moves = false;                                ///< other sweeps see through it
};

/// What a submap sees: its points with their sensors, map frame. Those at impossible places are
/// left out.
std::vector<Sighting> sightings_of(const PlacedSubmap& placed);

/// The surface elements of all sessions in a tile, and the votes on them (docs/theory/changes.md).
/// The steps come in the order of its members, each for all submaps before the next.
class SurfaceElements {
 public:
  SurfaceElements(const SpaceTile& tile, double edge)
      : low_{tile.centre.x() - tile.across / 2, tile.centre.y() - tile.across / 2},
        high_{tile.centre.x() + tile.across / 2, tile.centre.y() + tile.across / 2},
        edge_(edge) {}

  void add_surface(const std::vector<Sighting>& sightings, uint32_t session);
  void finish_surfaces();
  /// How far the submap's points are off other sessions' planes.
  void add_misfit(const std::vector<Sighting>& sightings, uint32_t submap, uint32_t session);
  /// Finds the elements that the submap has points on; `counts`: as votes.
  void mark_hits(const std::vector<Sighting>& sightings, uint32_t submap, uint32_t session,
                 bool counts);
  /// Elements that few submaps of earlier or of later sessions hit: rays look for these alone.
  void choose_candidates(uint32_t first_session, uint32_t last_session);
  /// Counts what the rays of a submap see through, after its hits have been marked.
  void cast(const std::vector<Sighting>& sightings, uint32_t submap, uint32_t session);

  std::vector<SurfaceElement>& elements() { return elements_; }
  std::size_t points() const { return points_; }

 private:
  /// How a submap fits the other sessions' planes that face along one axis.
  struct Fit {
    double sigma = 0.03;  ///< m, of its points' distances from them; unknown: a lidar's
    double range = 0.0;   ///< m, median; sigma grows in proportion beyond it
    std::size_t hits = 0;
    std::size_t through = 0;
    bool is_known = false;  ///< there were enough points on such planes

    double reach(double at_range) const {
      return kSigmasOfReach * sigma * std::max(1.0, at_range / std::max(1.0, range));
    }
    /// The submap's place along that axis is right: it sees the most of the planes.
    bool is_placed() const { return is_known && hits >= kLeastPlaneMatches && hits > through; }
  };
  using Fits = std::array<Fit, 3>;

  bool is_in(const VoxelIndex& voxel) const {
    return voxel.x() >= low_[0] && voxel.y() >= low_[1] && voxel.x() < high_[0] &&
           voxel.y() < high_[1];
  }
  template <class Visitor>
  void visit_near(const Eigen::Vector3d& p, const Visitor& visitor);
  Fits& fits_of(uint32_t submap) { return fits_.try_emplace(submap, Fits{}).first->second; }
  static Fit fit_along(const Fits& fits, const SurfaceElement& element);
  bool is_hit(const SurfaceElement& element, const Sighting& sighting, double reach) const;
  bool is_crossed(const SurfaceElement& element, const Sighting& sighting,
                  const Eigen::Vector3d& direction, double range, double reach) const;
  static SurfaceVotes& votes_of(SurfaceElement& element, uint32_t session) {
    return session == element.session  ? element.own
           : session < element.session ? element.before
                                       : element.after;
  }

  std::array<int64_t, 2> low_;
  std::array<int64_t, 2> high_;
  double edge_;
  std::unordered_map<uint64_t, uint32_t> first_{};  ///< element by voxel
  std::unordered_set<uint64_t> blocks_{};           ///< with candidates
  std::vector<uint8_t> is_candidate_{};             ///< by element
  std::vector<SurfaceElement> elements_{};
  std::unordered_map<uint32_t, Fits> fits_{};  ///< by submap
  std::size_t points_ = 0;
};

}  // namespace adit
