// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/gnss_model.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/counter_random.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr double kEquator = 6378137.0;               // m, WGS 84
constexpr double kFlattening = 1.0 / 298.257223563;  // WGS 84
constexpr double kSquaredEccentricity = kFlattening * (2.0 - kFlattening);

std::vector<GnssModel> models() {
  return {{.name = "rtk"},
          {.name = "single", .rtk = false},
          {.name = "overconfident", .confidence = 10.0}};
}

/// Standard deviation of the horizontal error (m); upwards it is twice that.
double sigma_of(GnssFixKind kind) {
  switch (kind) {
    case GnssFixKind::ground_augmented:
      return 0.012;
    case GnssFixKind::satellite_augmented:
      return 0.25;
    case GnssFixKind::single:
      return 1.5;
    case GnssFixKind::none:
      break;
  }
  return 0.0;
}

GnssFixKind kind_of(const GnssModel& model, double sky) {
  if (sky < 0.2) {
    return GnssFixKind::none;
  }
  if (!model.rtk || sky < 0.45) {
    return GnssFixKind::single;
  }
  return sky < 0.7 ? GnssFixKind::satellite_augmented : GnssFixKind::ground_augmented;
}

/// Looks in directions spread evenly over the sky above 15 degrees.
double open_sky(const RayScene& scene, const Vector3d& antenna) {
  constexpr int kDirections = 48;
  constexpr double kReach = 300.0;
  const double lowest = repeatable_sin_cos(15.0 * kDegree).sin;
  int open = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double up = lowest + (1.0 - lowest) * (i + 0.5) / kDirections;
    const SinCos around = repeatable_sin_cos(2.399963229728653 * i);  // the golden angle
    const double level = std::sqrt(1.0 - up * up);
    const Vector3d direction(level * around.cos, level * around.sin, up);
    open += scene.cast(antenna, direction, kReach) ? 0 : 1;
  }
  return static_cast<double>(open) / kDirections;
}

}  // namespace

Geodetic geodetic_of(const Vector3d& p_world) {
  const SinCos lat = repeatable_sin_cos(kOriginLatitude * kDegree);
  const SinCos lon = repeatable_sin_cos(kOriginLongitude * kDegree);
  const double n = kEquator / std::sqrt(1.0 - kSquaredEccentricity * lat.sin * lat.sin);
  const Vector3d origin((n + kOriginAltitude) * lat.cos * lon.cos,
                        (n + kOriginAltitude) * lat.cos * lon.sin,
                        (n * (1.0 - kSquaredEccentricity) + kOriginAltitude) * lat.sin);
  const Vector3d east(-lon.sin, lon.cos, 0.0);
  const Vector3d north(-lat.sin * lon.cos, -lat.sin * lon.sin, lat.cos);
  const Vector3d up(lat.cos * lon.cos, lat.cos * lon.sin, lat.sin);
  const Vector3d p = origin + p_world.x() * east + p_world.y() * north + p_world.z() * up;
  const double level = std::sqrt(p.x() * p.x() + p.y() * p.y());
  double latitude = kOriginLatitude * kDegree;
  double altitude = 0.0;
  constexpr int kIterations = 6;  // each gains two digits or more
  for (int i = 0; i < kIterations; ++i) {
    const SinCos at = repeatable_sin_cos(latitude);
    const double radius = kEquator / std::sqrt(1.0 - kSquaredEccentricity * at.sin * at.sin);
    altitude =
        level * at.cos + p.z() * at.sin - radius * (1.0 - kSquaredEccentricity * at.sin * at.sin);
    latitude = repeatable_atan2(
        p.z(), level * (1.0 - kSquaredEccentricity * radius / (radius + altitude)));
  }
  return {.latitude = latitude / kDegree,
          .longitude = repeatable_atan2(p.y(), p.x()) / kDegree,
          .altitude = altitude};
}

std::vector<std::string> gnss_names() {
  std::vector<std::string> names;
  for (const GnssModel& model : models()) {
    names.push_back(model.name);
  }
  return names;
}

GnssModel gnss_named(std::string_view name) {
  for (GnssModel& model : models()) {
    if (model.name == name) {
      return std::move(model);
    }
  }
  throw UsageError("there is no GNSS receiver '" + std::string(name) + "'. " +
                   suggestion(std::string(name), gnss_names()) + ".");
}

Vector3d antenna_mount() {
  return {-0.2, 0.05, 0.35};
}

GnssSimulator::GnssSimulator(GnssModel model, int rate, const SplineTrajectory& trajectory,
                             const Vector3d& p_imu_antenna, const RayScene& scene, uint64_t seed)
    : model_(std::move(model)),
      period_(1000000000 / rate),
      trajectory_(&trajectory),
      p_imu_antenna_(p_imu_antenna),
      scene_(&scene),
      seed_(seed),
      drift_(CounterRandom(seed, RandomStream::gnss).gaussian_vector(~uint64_t{0} >> 2U)) {}

SimulatedFix GnssSimulator::next() {
  constexpr double kDriftShare = 0.9;  // share of the variance
  constexpr uint64_t kLanes = 4;
  const CounterRandom random(seed_, RandomStream::gnss);
  const uint64_t lane = kLanes * static_cast<uint64_t>(index_);
  const double dt = 1e-9 * static_cast<double>(period_);
  SimulatedFix out;
  out.fix.stamp = Nanoseconds(index_ * period_);
  out.p_world_antenna = trajectory_->pose(dt * static_cast<double>(index_)) * p_imu_antenna_;
  out.sky = open_sky(*scene_, out.p_world_antenna);
  out.fix.kind = kind_of(model_, out.sky);
  const double kept = repeatable_exp(-dt / model_.correlation);
  drift_ = kept * drift_ + std::sqrt(1.0 - kept * kept) * random.gaussian_vector(lane);
  ++index_;
  if (out.fix.kind == GnssFixKind::none) {
    return out;
  }
  const double sigma = sigma_of(out.fix.kind);
  const Vector3d sigmas(sigma, sigma, 2.0 * sigma);
  Vector3d error =
      sigmas.cwiseProduct(std::sqrt(kDriftShare) * drift_ +
                          std::sqrt(1.0 - kDriftShare) * random.gaussian_vector(lane + 1));
  if (random.uniform(4 * lane + 11) < 2.0 * model_.multipath * (1.0 - out.sky)) {
    const SinCos way = repeatable_sin_cos(2.0 * std::numbers::pi * random.uniform(4 * lane + 12));
    const double far = 3.0 + 22.0 * random.uniform(4 * lane + 13);
    error += far * Vector3d(way.cos, way.sin, 0.5);
    out.outlier = true;
  }
  const Geodetic place = geodetic_of(out.p_world_antenna + error);
  out.fix.latitude = place.latitude;
  out.fix.longitude = place.longitude;
  out.fix.altitude = place.altitude;
  out.fix.covariance = (sigmas / model_.confidence).cwiseAbs2().asDiagonal().toDenseMatrix();
  return out;
}

}  // namespace adit
