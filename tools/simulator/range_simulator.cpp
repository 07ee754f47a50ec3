// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/range_simulator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "adit/tools/simulator/counter_random.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/parallel.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

/// What each of a pulse's sixteen random numbers is for: two for the noise, four for glass.
enum Lane : uint64_t {
  kNoise = 0,
  kDetection = 2,
  kFootprint = 3,
  kFootprintTurn = 4,
  kShare = 5,
  kDust = 6,
  kGlass = 8
};
constexpr uint64_t kLanes = 16;
constexpr uint64_t kPanes = 4;

double length_of(const Vector3d& v) {
  return std::sqrt(v.squaredNorm());
}

/// A direction within the beam, evenly spread over its cross-section.
Vector3d within_beam(const Vector3d& direction, double half_angle, double radius, double turn) {
  const Vector3d helper = std::abs(direction.z()) < 0.9 ? Vector3d::UnitZ() : Vector3d::UnitX();
  const Vector3d right = direction.cross(helper) / length_of(direction.cross(helper));
  const SinCos angle = repeatable_sin_cos(2.0 * std::numbers::pi * turn);
  const double off = half_angle * std::sqrt(radius);
  const Vector3d tilted =
      direction + off * (angle.cos * right + angle.sin * direction.cross(right));
  return tilted / length_of(tilted);
}

/// Probability that a pulse is detected, by its power as a multiple of the least.
double detected_share(double power) {
  constexpr double kLost = 0.002;  // for no reason that is modelled
  return power >= 1.0 ? 1.0 - kLost : power * power;
}

/// Share of the light that an interface of air and glass reflects, by the cosine of the angle of
/// incidence: Schlick's approximation of Fresnel's equations ("An inexpensive BRDF model for
/// physically-based rendering", 1994), for a refractive index of 1.5.
double reflected_share(double cosine) {
  constexpr double kIndex = 1.5;
  constexpr double kStraight = (kIndex - 1.0) * (kIndex - 1.0) / ((kIndex + 1.0) * (kIndex + 1.0));
  const double rest = 1.0 - cosine;
  return kStraight + (1.0 - kStraight) * rest * rest * rest * rest * rest;
}

}  // namespace

RangeSimulator::RangeSimulator(const Scene& scene, RangeSensor sensor, const RangeMount& mount,
                               uint64_t seed, const RangeEffects& effects,
                               std::optional<uint64_t> color_seed)
    : caster_(scene),
      sensor_(std::move(sensor)),
      mount_(mount),
      effects_(effects),
      seed_(seed),
      color_seed_(color_seed) {}

RangeSweep RangeSimulator::sweep(int64_t index, const Checkpoint& checkpoint) const {
  RangeSweep sweep{.start = index * sensor_.period,
                   .firings = firings_of(sensor_, index),
                   .returns = {},
                   .doppler = sensor_.doppler};
  sweep.returns.resize(sweep.firings.size());
  const uint64_t first = static_cast<uint64_t>(index) * 1000000U;  // more than a sweep has
  const std::vector<Mover> near = movers_near(sweep);
  constexpr std::size_t kPiece = 2048;
  in_parallel(
      sweep.firings.size(), kPiece,
      [&](std::size_t begin, std::size_t end) {
        Eigen::Isometry3d T_world_lidar = Eigen::Isometry3d::Identity();
        MotionState motion;
        int64_t posed = -1;
        for (std::size_t i = begin; i < end; ++i) {
          const Firing& firing = sweep.firings[i];
          const double time = 1e-9 * static_cast<double>(sweep.start + firing.time);
          if (firing.time != posed) {
            T_world_lidar = pose(time);
            if (sensor_.doppler) {
              motion = mount_.trajectory->at(time);
            }
            posed = firing.time;
          }
          sweep.returns[i] = measure({.firing = &firing,
                                      .number = first + i,
                                      .time = time,
                                      .motion = &motion,
                                      .movers = &near},
                                     T_world_lidar);
        }
      },
      checkpoint);
  return sweep;
}

std::vector<Mover> RangeSimulator::movers_near(const RangeSweep& sweep) const {
  constexpr double kOwnWay = 10.0;  // m that the sensor itself may come nearer
  const double begin = 1e-9 * static_cast<double>(sweep.start);
  const double end = begin + 1e-9 * static_cast<double>(sweep.firings.back().time);
  return caster_.movers_near(mount_.trajectory->pose(begin).translation(),
                             sensor_.farthest + kOwnWay, begin, end);
}

std::optional<RangeSimulator::Sight> RangeSimulator::first_surface(const Vector3d& origin,
                                                                   const Vector3d& direction,
                                                                   const Pulse& pulse,
                                                                   uint64_t lane) const {
  const CounterRandom random(seed_, RandomStream::range);
  double gone = 0.0;
  double share = 1.0;
  std::optional<Sight> in_mirror;  // the strongest
  // A pulse goes through a few panes of glass at most.
  for (uint64_t pane = 0; pane < kPanes; ++pane) {
    const Vector3d from = origin + gone * direction;
    auto target = caster_.cast(from, direction, sensor_.farthest - gone, pulse.time, *pulse.movers);
    if (!target) {
      return in_mirror;
    }
    target->hit.distance += gone;
    const double transmission = optics_of(target->hit.material).transmission;
    const Sight straight{.target = *target, .share = share};
    if (transmission == 0.0 ||
        random.uniform(pulse.number * kLanes + lane + pane) >= transmission ||
        (effects_.reflections && faces_sensor(*target, direction))) {
      // One echo is reported: the stronger one.
      return in_mirror && strength(*in_mirror, direction) > strength(straight, direction)
                 ? in_mirror
                 : straight;
    }
    if (effects_.reflections) {
      const auto other = mirrored(origin, direction, *target, share, pulse);
      if (other && (!in_mirror || strength(*other, direction) > strength(*in_mirror, direction))) {
        in_mirror = other;
      }
      const double passed = 1.0 - reflected_share(std::abs(target->hit.normal.dot(direction)));
      share *= passed * passed;
    }
    gone = target->hit.distance + 1e-6;
  }
  return in_mirror;
}

std::optional<RangeSimulator::Sight> RangeSimulator::mirrored(const Vector3d& origin,
                                                              const Vector3d& direction,
                                                              const SceneHit& pane, double share,
                                                              const Pulse& pulse) const {
  const Vector3d& normal = pane.hit.normal;
  const Vector3d onwards = direction - 2.0 * direction.dot(normal) * normal;
  const double reflected = reflected_share(std::abs(normal.dot(direction)));
  double gone = 1e-6;
  for (uint64_t i = 0; i < kPanes; ++i) {
    const double left = sensor_.farthest - pane.hit.distance - gone;
    auto target = caster_.cast(origin + pane.hit.distance * direction + gone * onwards, onwards,
                               left, pulse.time, *pulse.movers);
    if (!target) {
      return std::nullopt;
    }
    if (optics_of(target->hit.material).transmission == 0.0) {
      target->hit.distance += pane.hit.distance + gone;
      target->hit.normal -= 2.0 * target->hit.normal.dot(normal) * normal;
      target->object = 0;
      return Sight{.target = *target, .share = share * reflected * reflected, .mirrored = true};
    }
    gone += target->hit.distance + 1e-6;
  }
  return std::nullopt;
}

bool RangeSimulator::faces_sensor(const SceneHit& pane, const Vector3d& direction) const {
  constexpr double kLens = 0.02;  // m, radius: a sensor's windows are some 4 cm high
  // The light comes back to where the sensor is twice the angle off, from twice as far.
  const double angle = sensor_.divergence + 0.5 * kLens / pane.hit.distance;
  return optics_of(pane.hit.material).transmission > 0.0 &&
         std::abs(pane.hit.normal.dot(direction)) > 1.0 - 0.5 * angle * angle;
}

double RangeSimulator::strength(const Sight& seen, const Vector3d& direction) const {
  const SceneHit& target = seen.target;
  const double slant = std::abs(target.hit.normal.dot(direction));
  const double ratio = sensor_.range_at_tenth / target.hit.distance;
  return seen.share * static_cast<double>(optics_of(target.hit.material).reflectivity) * slant /
         0.1 * ratio * ratio;
}

float RangeSimulator::radial_speed(const Pulse& pulse, const Vector3d& direction, uint16_t object,
                                   const Vector3d& p_world) const {
  constexpr double kNoise = 0.05;  // m/s; data sheets of FMCW lidars have 0.03 to 0.1
  constexpr double kStep = 1e-3;   // s, of the difference that stands for the object's velocity
  const Vector3d p_body = mount_.T_body_lidar * pulse.firing->origin;
  Vector3d relative = -(pulse.motion->velocity + pulse.motion->T_world_body.linear() *
                                                     pulse.motion->angular_velocity.cross(p_body));
  if (object > 0) {
    const auto& pose_at = caster_.scene().moving[object - 1U].T_world_object;
    const Eigen::Isometry3d here = pose_at(pulse.time);
    const Vector3d p_object = here.linear().transpose() * (p_world - here.translation());
    relative += (pose_at(pulse.time + 0.5 * kStep) * p_object -
                 pose_at(pulse.time - 0.5 * kStep) * p_object) /
                kStep;
  }
  double speed = relative.dot(direction);
  if (effects_.noise) {
    speed += kNoise * CounterRandom(seed_, RandomStream::doppler).gaussians(pulse.number).x();
  }
  return static_cast<float>(speed);
}

uint8_t RangeSimulator::surface_of(const Sight& seen) {
  constexpr double kLevel = 0.7071;  // cosine of 45 degrees
  if (seen.mirrored) {
    return kMirrored;
  }
  const SceneHit& target = seen.target;
  const auto material = static_cast<uint8_t>(static_cast<uint8_t>(target.hit.material) + 1U);
  return target.hit.normal.z() > kLevel ? static_cast<uint8_t>(material | kLevelSurface) : material;
}

std::optional<Return> RangeSimulator::scattered_by_dust(const Pulse& pulse, const Vector3d& origin,
                                                        const Vector3d& direction,
                                                        double reach) const {
  if (!effects_.dust || !(caster_.scene().dust > 0.0)) {
    return std::nullopt;
  }
  // Scattering by dust is exponential in the distance.
  const CounterRandom random(seed_, RandomStream::range);
  const double dust =
      -repeatable_log(1.0 - random.uniform(pulse.number * kLanes + kDust)) / caster_.scene().dust;
  if (!(dust < reach && dust > sensor_.nearest && dust < 0.2 * sensor_.range_at_tenth)) {
    return std::nullopt;
  }
  return Return{.range = dust,
                .intensity = 1.0F,
                .doppler = sensor_.doppler ? radial_speed(pulse, direction, 0, origin) : 0.0F};
}

Return RangeSimulator::measure(const Pulse& pulse, const Eigen::Isometry3d& T_world_lidar) const {
  const CounterRandom random(seed_, RandomStream::range);
  const uint64_t base = pulse.number * kLanes;
  const Vector3d origin = T_world_lidar * pulse.firing->origin;
  const Vector3d direction = T_world_lidar.linear() * pulse.firing->direction;
  auto seen = first_surface(origin, direction, pulse, kGlass);

  const double reach = seen ? seen->target.hit.distance : sensor_.farthest;
  if (const auto dust = scattered_by_dust(pulse, origin, direction, reach)) {
    return *dust;
  }
  double range = seen ? seen->target.hit.distance : 0.0;
  Vector3d beam = direction;  // to the target
  bool melted = false;
  if (effects_.mixed_pixels) {
    const Vector3d other_way =
        within_beam(direction, sensor_.divergence, random.uniform(base + kFootprint),
                    random.uniform(base + kFootprintTurn));
    const auto other = first_surface(origin, other_way, pulse, kGlass);
    // Echoes nearer to each other than a pulse is long melt into one; of others the stronger
    // counts.
    constexpr double kPulseLength = 0.8;
    constexpr double kOnSurface = 0.1;  // m, more than three sigma of any sensor's noise
    if (other && seen && std::abs(other->target.hit.distance - range) < kPulseLength) {
      const double apart = other->target.hit.distance - range;
      // Footprints of one surface differ as well; only steps count.
      const double own = std::abs(seen->target.hit.normal.dot(direction));
      const double smooth = 3.0 * sensor_.divergence * range / std::max(own, 0.05);
      if (std::abs(apart) > smooth) {
        range += random.uniform(base + kShare) * apart;
        melted = std::min(std::abs(range - seen->target.hit.distance),
                          std::abs(range - other->target.hit.distance)) > kOnSurface;
      }
    } else if (other && (!seen || strength(*other, other_way) > strength(*seen, direction)) &&
               random.uniform(base + kShare) < 0.5) {
      seen = other;
      range = other->target.hit.distance;
      beam = other_way;
    }
  }
  if (!seen || range < sensor_.nearest) {
    return {};
  }
  const SceneHit& target = seen->target;
  if (effects_.dropout &&
      random.uniform(base + kDetection) >= detected_share(strength(*seen, direction))) {
    return {};
  }
  const double slant = std::abs(target.hit.normal.dot(direction));
  double intensity = sensor_.intensity_scale * slant *
                     static_cast<double>(optics_of(target.hit.material).reflectivity);
  if (effects_.noise) {
    const Eigen::Vector2d errors = random.gaussians(base / 2 + kNoise);
    range += (sensor_.noise + sensor_.noise_growth * range * range) * errors.x();
    range = std::floor(range / sensor_.resolution + 0.5) * sensor_.resolution;
    intensity *= 1.0 + 0.03 * errors.y();
  }
  return {.range = range,
          .intensity = static_cast<float>(std::clamp(std::floor(intensity + 0.5), 0.0, 255.0)),
          .doppler = sensor_.doppler
                         ? radial_speed(pulse, direction, target.object, origin + range * direction)
                         : 0.0F,
          .object = target.object,
          .surface = melted ? uint8_t{0} : surface_of(*seen),
          .color = color_seed_ && !melted && !seen->mirrored
                       ? caster_.color_of(target, origin + target.hit.distance * beam, pulse.time,
                                          *color_seed_)
                       : SurfaceColor{}};
}

}  // namespace adit
