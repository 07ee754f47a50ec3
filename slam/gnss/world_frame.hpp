// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Frames on the Earth. world_frame.cpp is the one file that sees GeographicLib, but for its geoids.
#pragma once

#include <optional>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/types.hpp"

namespace adit {

/// Of the origin of a world frame, degrees north or south.
inline constexpr double kMostLatitude = 84.0;
/// Of a place that somebody has been to, m above or below the ellipsoid.
inline constexpr double kMostAltitude = 20e3;

/// A frame of metres that lies on the WGS 84 ellipsoid: x east and y north at its origin, z up.
///
/// x and y are a transverse Mercator projection with its central meridian through the origin,
/// scaled by 1 + altitude / radius, so that distances are those on the ground at the origin's
/// altitude (within 1e-6 as far as 9 km from it); z is the ellipsoidal altitude above the origin's.
/// Unlike a plane tangent to the Earth it stays level wherever one goes, as a map does that an
/// inertial sensor levels; unlike UTM it has no zones, and distances that agree with the range
/// sensor's.
class WorldFrame {
 public:
  /// Throws std::invalid_argument: not finite, or a latitude beyond 84 degrees, where meridians are
  /// too close together for the projection.
  explicit WorldFrame(const Geodetic& origin);

  const Geodetic& origin() const { return origin_; }
  /// The projection's scale on its central meridian.
  double scale() const { return scale_; }

  /// m.
  Eigen::Vector3d position_of(const Geodetic& place) const;
  Geodetic place_of(const Eigen::Vector3d& position) const;
  /// From true north to the frame's y axis there, clockwise, rad.
  double convergence_at(const Eigen::Vector3d& position) const;

 private:
  Geodetic origin_;
  double scale_;
  double northing_of_origin_;
};

/// A place given by metres east, north and up in the plane that touches the ellipsoid at a place.
Geodetic place_in_tangent_plane(const Geodetic& origin, const Eigen::Vector3d& east_north_up);

/// A place in the Universal Transverse Mercator projection on WGS 84.
struct UtmPosition {
  int zone = 0;  ///< 1 to 60
  bool north = true;
  double easting = 0.0;      ///< m, 500 000 added
  double northing = 0.0;     ///< m, in the south 10 000 000 added
  double convergence = 0.0;  ///< rad, from true to grid north, clockwise
  double scale = 1.0;        ///< of lengths on the ellipsoid
};

/// `zone` and `north` of the frame to express it in, so that no edge of a zone breaks a map;
/// without them the place's own by the standard. Throws std::invalid_argument where UTM has no such
/// place: beyond 84 degrees of latitude, or too far from the zone.
struct UtmZone {
  int zone = 0;
  bool north = true;
};
UtmPosition utm_of(const Geodetic& place, std::optional<UtmZone> in = {});
Geodetic place_of(const UtmPosition& position, double altitude);

/// Where a map lies on the Earth.
struct Georeference {
  Geodetic origin;  ///< of the world frame
  /// The map in it: turned about the vertical, levelled and moved.
  Eigen::Isometry3d T_world_map = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of T_world_map, [rho, phi]: m^2, rad^2
};
/// The same with another place of the map; nothing stays nothing.
std::optional<Georeference> placed(std::optional<Georeference> georeference,
                                   const Eigen::Isometry3d& T_world_map);

}  // namespace adit
