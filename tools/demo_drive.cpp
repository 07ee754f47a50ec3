// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/demo_drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

// ---- the street's centreline, by arc length s (m); the car starts at s = 0 ----

struct Turn {
  double start;  ///< m
  double angle;  ///< rad, positive to the left
};
constexpr double kTurnLength = 24.0;
constexpr std::array<Turn, 2> kTurns{Turn{12.0, kPi / 2}, Turn{44.0, -kPi / 2}};
constexpr double kSharpest = kPi / kTurnLength;  ///< 1/m, the curvature in the middle of a turn

/// Curvature (1/m): zero on the straights, a raised cosine in the turns, so that the steering is
/// smooth.
double curvature(double s) {
  double sum = 0.0;
  for (const Turn& turn : kTurns) {
    const double u = (s - turn.start) / kTurnLength;
    if (u > 0.0 && u < 1.0) {
      sum += turn.angle / kTurnLength * (1.0 - std::cos(2.0 * kPi * u));
    }
  }
  return sum;
}

struct Station {
  Vector2d position;
  double heading;  ///< rad

  Vector2d ahead() const { return {std::cos(heading), std::sin(heading)}; }
  Vector2d left() const { return {-std::sin(heading), std::cos(heading)}; }
};

constexpr double kBefore = 60.0;  ///< m of street behind the start
constexpr double kAfter = 160.0;  ///< m of street ahead of it
constexpr double kStep = 0.05;    ///< m between stations

/// The centreline, integrated by midpoints.
class Street {
 public:
  Street() {
    Station station{.position = {-kBefore, 0.0}, .heading = 0.0};
    const auto count = static_cast<std::size_t>((kBefore + kAfter) / kStep);
    for (std::size_t i = 0; i <= count; ++i) {
      stations_.push_back(station);
      const double turn = kStep * curvature(-kBefore + (static_cast<double>(i) + 0.5) * kStep);
      const Station middle{.position = station.position, .heading = station.heading + 0.5 * turn};
      station = {.position = station.position + kStep * middle.ahead(),
                 .heading = station.heading + turn};
    }
  }

  /// Between two stations the street is straight enough for linear interpolation.
  Station at(double s) const {
    const double index =
        std::clamp((s + kBefore) / kStep, 0.0, static_cast<double>(stations_.size()) - 1.001);
    const auto i = static_cast<std::size_t>(index);
    const double u = index - static_cast<double>(i);
    return {.position = (1.0 - u) * stations_[i].position + u * stations_[i + 1].position,
            .heading = (1.0 - u) * stations_[i].heading + u * stations_[i + 1].heading};
  }

  /// Whether a box stands clear of the carriageway.
  bool clear_of(const Box& box) const {
    constexpr double kHalfCarriageway = 3.6;
    return std::ranges::none_of(stations_, [&](const Station& station) {
      return distance_to({station.position.x(), station.position.y(), box.center.z()}, box) <
             kHalfCarriageway;
    });
  }

 private:
  std::vector<Station> stations_;
};

// ---- what stands along the street ----

/// A box on the ground beside the street: `along` and `across` are its full lengths.
Box box_beside(const Station& station, double offset, double along, double across, double height,
               double yaw = 0.0) {
  const Vector2d place = station.position + offset * station.left();
  return {.center = {place.x(), place.y(), 0.5 * height},
          .half_size = {0.5 * along, 0.5 * across, 0.5 * height},
          .ahead = {std::cos(station.heading + yaw), std::sin(station.heading + yaw)}};
}

void add_buildings(const Street& street, std::vector<SceneObject>& scene, Random& random) {
  for (const double side : {-1.0, 1.0}) {
    double s = -kBefore;
    while (s < kAfter) {
      const double front = random.uniform(8.0, 16.0);
      const double depth = random.uniform(8.0, 12.0);
      const double setback = random.uniform(7.5, 11.0);
      const Box house = box_beside(street.at(s), side * (setback + 0.5 * depth), front, depth,
                                   random.uniform(5.0, 14.0), random.uniform(-0.08, 0.08));
      const auto shade = static_cast<float>(random.uniform(0.3, 0.8));
      if (street.clear_of(house)) scene.push_back({.shape = house, .reflectivity = shade});
      s += front + random.uniform(0.5, 6.0);
    }
  }
}

void add_curbs(const Street& street, std::vector<SceneObject>& scene) {
  constexpr double kPiece = 2.0;  // m
  constexpr int kPieces = static_cast<int>((kBefore + kAfter) / kPiece);
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i < kPieces; ++i) {
      const Box curb = box_beside(street.at(-kBefore + kPiece * i), side * 5.2, kPiece, 2.4, 0.14);
      if (street.clear_of(curb)) scene.push_back({.shape = curb, .reflectivity = 0.35F});
    }
  }
}

void add_pole(const Vector2d& place, std::vector<SceneObject>& scene) {
  const Cylinder pole{.center = place, .radius = 0.12, .bottom = 0.0, .top = 6.0};
  scene.push_back({.shape = pole, .reflectivity = 0.9F});
}

void add_tree(const Vector2d& place, std::vector<SceneObject>& scene, Random& random) {
  const double height = random.uniform(3.0, 4.0);
  const Cylinder trunk{.center = place, .radius = 0.2, .bottom = 0.0, .top = height};
  const Sphere crown{.center = {place.x(), place.y(), height + 1.0},
                     .radius = random.uniform(1.2, 1.8)};
  scene.push_back({.shape = trunk, .reflectivity = 0.3F});
  scene.push_back({.shape = crown, .reflectivity = 0.5F});
}

void add_poles_and_trees(const Street& street, std::vector<SceneObject>& scene, Random& random) {
  for (const double side : {-1.0, 1.0}) {
    double s = -kBefore + 3.0 * side;
    while (s < kAfter) {
      const Station station = street.at(s);
      const Vector2d place = station.position + side * random.uniform(4.3, 5.5) * station.left();
      if (random.uniform(0.0, 1.0) < 0.5) {
        add_pole(place, scene);
      } else {
        add_tree(place, scene, random);
      }
      s += random.uniform(7.0, 13.0);
    }
  }
}

void add_cars_and_walls(const Street& street, std::vector<SceneObject>& scene, Random& random) {
  for (const double side : {-1.0, 1.0}) {
    double s = -kBefore;
    while (s < kAfter) {
      const Box car = box_beside(street.at(s), side * 4.6, 4.3, 1.8, random.uniform(1.4, 1.9));
      if (street.clear_of(car)) {
        scene.push_back({.shape = car, .reflectivity = 0.6F});
      }
      const Box wall =
          box_beside(street.at(s + 5.0), side * 7.0, random.uniform(3.0, 8.0), 0.3, 1.1);
      if (street.clear_of(wall)) {
        scene.push_back({.shape = wall, .reflectivity = 0.45F});
      }
      s += random.uniform(9.0, 25.0);
    }
  }
}

// ---- the car ----

/// Slower in the turns (m/s).
double speed(double s) {
  return 8.0 - 3.0 * std::abs(curvature(s)) / kSharpest;
}

/// The lidar on the roof: it heaves, pitches and leans a little, as a car does.
Eigen::Isometry3d lidar_pose(const Street& street, double s) {
  const Station station = street.at(s);
  const double heave = 0.02 * std::sin(2.0 * kPi * s / 7.0);
  const double pitch = 0.006 * std::sin(2.0 * kPi * s / 9.0);
  const double roll = 0.004 * std::sin(2.0 * kPi * s / 5.0) + 0.2 * curvature(s);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Vector3d(station.position.x(), station.position.y(), 1.9 + heave);
  pose.linear() =
      (Eigen::AngleAxisd(station.heading, Vector3d::UnitZ()) *
       Eigen::AngleAxisd(pitch, Vector3d::UnitY()) * Eigen::AngleAxisd(roll, Vector3d::UnitX()))
          .toRotationMatrix();
  return pose;
}

}  // namespace

double SpinningLidar::beam_spacing() const {
  return std::max((highest - lowest) / (beams - 1), 2.0 * kPi / columns);
}

DemoDrive make_demo_drive(std::size_t sweeps) {
  const Street street;
  Random random(20240607);
  DemoDrive drive;
  add_buildings(street, drive.scene, random);
  add_curbs(street, drive.scene);
  add_poles_and_trees(street, drive.scene, random);
  add_cars_and_walls(street, drive.scene, random);

  constexpr auto kPeriod = std::chrono::milliseconds(100);
  constexpr int kSubsteps = 100;
  double s = 0.0;
  for (std::size_t i = 0; i < sweeps; ++i) {
    drive.poses.push_back(
        {.stamp = static_cast<int64_t>(i) * kPeriod, .pose = lidar_pose(street, s)});
    for (int k = 0; k < kSubsteps; ++k) {
      s += speed(s) * 0.1 / kSubsteps;
    }
  }
  return drive;
}

Sweep scan(const std::vector<SceneObject>& scene, const StampedPose& T_world_lidar,
           const SpinningLidar& lidar, Random& random) {
  const SceneView view(scene, T_world_lidar.pose.translation(), lidar.max_range);
  const Eigen::Matrix3d R_world_lidar = T_world_lidar.pose.linear();
  Sweep sweep;
  sweep.stamp = T_world_lidar.stamp;
  for (int column = 0; column < lidar.columns; ++column) {
    const double azimuth = 2.0 * kPi * column / lidar.columns;
    for (int beam = 0; beam < lidar.beams; ++beam) {
      const double elevation =
          lidar.lowest + (lidar.highest - lidar.lowest) * beam / (lidar.beams - 1);
      const Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                               std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const auto hit = view.cast(R_world_lidar * direction);
      if (!hit) {
        continue;
      }
      const Vector3d p = (hit->distance + lidar.range_noise * random.gaussian()) * direction;
      sweep.points.push_back({.x = static_cast<float>(p.x()),
                              .y = static_cast<float>(p.y()),
                              .z = static_cast<float>(p.z()),
                              .intensity = hit->reflectivity});
    }
  }
  return sweep;
}

}  // namespace adit
