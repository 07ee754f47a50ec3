// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr double kControlSpacing = 0.05;  // s

constexpr std::array kStyles{
    MotionStyle{.name = "drive", .height = 1.3},
    MotionStyle{.name = "walk", .height = 1.6, .speed_scale = 0.8, .step = 0.7},
    MotionStyle{.name = "handheld", .height = 1.4, .speed_scale = 0.7, .step = 0.65, .swing = 1.1},
    MotionStyle{.name = "fast-handheld",
                .height = 1.4,
                .speed = 3.0,
                .step = 1.05,
                .bounce = 0.054,
                .swing = 1.0,
                .pace = 2.2},
    MotionStyle{.name = "stop-and-go", .height = 1.3, .stops = true},
    MotionStyle{.name = "moving-start", .height = 1.3, .rest = 0.0}};

/// The route with its corners rounded, by the distance from its start. Closed.
class Path {
 public:
  explicit Path(const Scene& scene) {
    const std::vector<Vector3d>& corners = scene.route;
    const std::size_t n = corners.size();
    const auto corner = [&](std::size_t i) { return corners[i % n]; };
    const auto reach = [&](std::size_t i, std::size_t j) {
      return std::min(scene.corner_radius, 0.5 * length_of(corner(j) - corner(i)));
    };
    for (std::size_t i = 1; i <= n; ++i) {
      const Vector3d to_last = corner(i - 1) - corner(i);
      const Vector3d to_next = corner(i + 1) - corner(i);
      const Vector3d from = corner(i) + reach(i - 1, i) / length_of(to_last) * to_last;
      const Vector3d to = corner(i) + reach(i, i + 1) / length_of(to_next) * to_next;
      constexpr int kParts = 24;
      for (int k = 0; k < kParts; ++k) {
        const double t = static_cast<double>(k) / kParts;
        append((1 - t) * (1 - t) * from + 2 * t * (1 - t) * corner(i) + t * t * to);
      }
      append(to);
    }
    append(points_.front());
  }

  double length() const { return distances_.back(); }

  Vector3d at(double distance) const {
    distance -= std::floor(distance / length()) * length();
    const auto after = std::ranges::upper_bound(distances_, distance);
    const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
        after - distances_.begin(), 1, static_cast<std::ptrdiff_t>(distances_.size()) - 1));
    const double part = distances_[i] - distances_[i - 1];
    const double u = part > 0.0 ? (distance - distances_[i - 1]) / part : 0.0;
    return points_[i - 1] + u * (points_[i] - points_[i - 1]);
  }

  /// Direction of travel, over a stretch as long as a vehicle.
  Vector3d ahead(double distance, double stretch) const {
    const Vector3d chord = at(distance + stretch) - at(distance - stretch);
    return chord / length_of(chord);
  }

 private:
  static double length_of(const Vector3d& v) { return std::sqrt(v.squaredNorm()); }

  void append(const Vector3d& point) {
    const double step = points_.empty() ? 0.0 : length_of(point - points_.back());
    distances_.push_back((distances_.empty() ? 0.0 : distances_.back()) + step);
    points_.push_back(point);
  }

  std::vector<Vector3d> points_;
  std::vector<double> distances_;
};

/// From 0 to 1, with a slope that begins and ends at 0.
double smooth_step(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3.0 - 2.0 * u);
}

double sine(double angle) {
  return repeatable_sin_cos(angle).sin;
}

/// Share of the full speed at a time (s).
double throttle(const MotionStyle& style, double time) {
  constexpr double kRamp = 2.0;
  double share = style.rest > 0.0 ? smooth_step((time - style.rest) / kRamp) : 1.0;
  if (style.stops) {
    constexpr double kEvery = 15.0;
    constexpr double kStanding = 3.0;
    const double phase = time - std::floor(time / kEvery) * kEvery;
    share *= 1.0 - smooth_step((phase - 8.0) / kRamp) +
             smooth_step((phase - 8.0 - kRamp - kStanding) / kRamp);
  }
  return share;
}

Eigen::Isometry3d body_pose(const Path& path, const MotionStyle& style, const Scene& scene,
                            double distance, double time) {
  const double stretch = 0.5 * scene.corner_radius;
  const Vector3d ahead = path.ahead(distance, stretch);
  const double level = std::sqrt(ahead.x() * ahead.x() + ahead.y() * ahead.y());
  double yaw = repeatable_atan2(ahead.y(), ahead.x());
  double pitch = 0.0;
  double roll = 0.0;
  Vector3d at = path.at(distance);
  const Vector3d left(-ahead.y() / level, ahead.x() / level, 0.0);
  at.z() += style.height;
  if (style.step > 0.0) {
    const double phase = kPi * distance / style.step;  // half a turn a step
    at.z() += style.bounce * sine(2.0 * phase);
    at += 0.02 * sine(phase) * left;
    roll += 0.02 * sine(phase + 0.4);
    pitch += 0.015 * sine(2.0 * phase + 0.9);
  } else {
    pitch += -repeatable_atan2(ahead.z(), level) + 0.006 * sine(2.0 * kPi * distance / 2.9);
    roll += 0.008 * sine(2.0 * kPi * distance / 3.7);
    at.z() += 0.01 * sine(2.0 * kPi * distance / 2.3);
  }
  if (style.swing > 0.0) {
    const double amount = smooth_step((time - style.rest) / 2.0);
    const double phase = style.pace * (time - style.rest);
    yaw += amount * style.swing * sine(1.6 * phase);
    pitch += amount * 0.3 * style.swing * sine(1.1 * phase + 0.5);
    roll += amount * 0.2 * style.swing * sine(0.9 * phase + 1.7);
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_from_yaw_pitch_roll(yaw, pitch, roll);
  pose.translation() = at;
  return pose;
}

}  // namespace

std::vector<std::string> motion_names() {
  std::vector<std::string> names;
  for (const MotionStyle& style : kStyles) {
    names.emplace_back(style.name);
  }
  return names;
}

MotionStyle motion_named(std::string_view name) {
  const auto* found = std::ranges::find(kStyles, name, &MotionStyle::name);
  if (found == kStyles.end()) {
    throw UsageError("there is no trajectory '" + std::string(name) + "'. " +
                     suggestion(std::string(name), motion_names()) + ".");
  }
  return *found;
}

SplineTrajectory make_trajectory(const Scene& scene, const MotionStyle& style, double duration,
                                 std::optional<double> speed, double begin,
                                 const Checkpoint& checkpoint) {
  const Path path(scene);
  const double usual = style.speed > 0.0 ? style.speed : scene.speed * style.speed_scale;
  const double full = speed.value_or(usual);
  const auto count = static_cast<int>(std::ceil(duration / kControlSpacing)) + 8;
  std::vector<Eigen::Isometry3d> poses;
  double distance = begin;
  for (int i = -1; i < count; ++i) {
    pass(checkpoint);
    const double time = kControlSpacing * i;
    poses.push_back(body_pose(path, style, scene, distance, time));
    if (!poses.back().matrix().allFinite()) {
      throw UsageError(fmt::format(
          "waypoints, corner_radius: the way has no direction {:.1f} m from its beginning. Choose "
          "corners that are farther apart, or another corner_radius.",
          distance));
    }
    constexpr int kSubsteps = 10;
    for (int k = 0; k < kSubsteps; ++k) {
      const double middle = time + kControlSpacing * (k + 0.5) / kSubsteps;
      distance += full * throttle(style, middle) * kControlSpacing / kSubsteps;
    }
  }
  return {kControlSpacing, std::move(poses)};
}

double route_length(const Scene& scene) {
  return Path(scene).length();
}

}  // namespace adit
