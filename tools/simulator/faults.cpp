// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/faults.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/core.h>
#include <Eigen/Geometry>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/counter_random.hpp"
#include "adit/tools/simulator/imu_model.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr std::array<std::pair<std::string_view, Fault>, 38> kFaults{
    {{"clock-offset", Fault::clock_offset},
     {"clock-drift", Fault::clock_drift},
     {"gap", Fault::gap},
     {"duplicates", Fault::duplicates},
     {"reordering", Fault::reordering},
     {"nan", Fault::nan},
     {"wrong-units", Fault::wrong_units},
     {"swapped-axes", Fault::swapped_axes},
     {"blocked-sector", Fault::blocked_sector},
     {"shock", Fault::shock},
     {"own-carrier", Fault::own_carrier},
     {"rain", Fault::rain},
     {"truncated", Fault::truncated},
     {"kidnapped", Fault::kidnapped},
     {"covered", Fault::covered},
     {"rare-spikes", Fault::rare_spikes},
     {"spikes", Fault::spikes},
     {"many-spikes", Fault::many_spikes},
     {"gaps", Fault::gaps},
     {"odometry-leap", Fault::odometry_leap},
     {"odometry-lost", Fault::odometry_lost},
     {"heading-off-90", Fault::heading_off_90},
     {"heading-off-180", Fault::heading_off_180},
     {"heading-noisy", Fault::heading_noisy},
     {"heading-stuck", Fault::heading_stuck},
     {"heading-outliers", Fault::heading_outliers},
     {"camera-turned", Fault::camera_turned},
     {"camera-late", Fault::camera_late},
     {"camera-exposure", Fault::camera_exposure},
     {"wheel-scale", Fault::wheel_scale},
     {"wheel-slip", Fault::wheel_slip},
     {"wheel-stuck", Fault::wheel_stuck},
     {"wheel-units", Fault::wheel_units},
     {"wheel-reversed", Fault::wheel_reversed},
     {"wheel-axes", Fault::wheel_axes},
     {"wheel-late", Fault::wheel_late},
     {"wheel-zero-covariance", Fault::wheel_zero_covariance},
     {"wheel-negative-covariance", Fault::wheel_negative_covariance}}};

/// Those of the IMU's messages alone.
constexpr std::array kOfImu{Fault::clock_offset, Fault::clock_drift,  Fault::reordering,
                            Fault::wrong_units,  Fault::swapped_axes, Fault::shock,
                            Fault::rare_spikes,  Fault::spikes,       Fault::many_spikes,
                            Fault::gaps};
constexpr std::array kOfHeading{Fault::heading_off_90, Fault::heading_off_180, Fault::heading_noisy,
                                Fault::heading_stuck, Fault::heading_outliers};
constexpr std::array kOfCamera{Fault::camera_turned, Fault::camera_late, Fault::camera_exposure};
constexpr Fault kFirstOfWheels = Fault::wheel_scale;  // and all after it
constexpr std::array kSpikes{Fault::rare_spikes, Fault::spikes, Fault::many_spikes};

constexpr double kFirstBlow = 3.0;  // s
constexpr double kOneIn50 = 0.02;

/// Each purpose of a topic's messages has its own numbers.
uint64_t counter(uint64_t index, uint64_t purpose) {
  return index * 16U + purpose;
}

/// One of the six numbers becomes anything from what motion reaches to twice 2000 degrees/s or 16
/// g, small and large alike.
void spike(ImuSample& sample, const CounterRandom& random, uint64_t index) {
  constexpr double kLeastRate = 1.0;           // rad/s
  constexpr double kLeastAcceleration = 10.0;  // m/s^2
  constexpr double kRates = 4.248;             // logarithm of 70, from 1 to 70 rad/s
  constexpr double kAccelerations = 3.446;     // logarithm of 31.4, from 10 to 314 m/s^2
  const auto choice = static_cast<Eigen::Index>(6.0 * random.uniform(counter(index, 12)));
  const double sign = random.uniform(counter(index, 11)) < 0.5 ? -1.0 : 1.0;
  const double part = random.uniform(counter(index, 10));
  if (choice < 3) {
    sample.angular_velocity(choice) = sign * kLeastRate * repeatable_exp(kRates * part);
  } else {
    sample.linear_acceleration(choice - 3) =
        sign * kLeastAcceleration * repeatable_exp(kAccelerations * part);
  }
}

/// A mount that was hit swings out and back, x(t) = (t / tau)^2 exp(-t / tau) sin(w t): it begins
/// and ends at rest where it was. Velocity and acceleration of that, for x in units of 1.
struct Ringing {
  double velocity = 0.0;      ///< 1/s
  double acceleration = 0.0;  ///< 1/s²
};

Ringing ringing_after(double time) {
  constexpr double kDecay = 0.01;                             // s
  constexpr double kTurning = 2.0 * std::numbers::pi * 40.0;  // rad/s
  const double u = time / kDecay;
  if (u < 0.0 || u > 40.0) {
    return {};
  }
  const double fading = repeatable_exp(-u);
  const double g = u * u * fading;
  const double g1 = (2.0 * u - u * u) * fading / kDecay;
  const double g2 = (2.0 - 4.0 * u + u * u) * fading / (kDecay * kDecay);
  const SinCos swing = repeatable_sin_cos(kTurning * time);
  return {.velocity = g1 * swing.sin + g * kTurning * swing.cos,
          .acceleration = g2 * swing.sin + 2.0 * g1 * kTurning * swing.cos -
                          g * kTurning * kTurning * swing.sin};
}

/// A blow every few seconds, from another side each. The mount gives by less than 2 mm and 4 mrad:
/// truth and ranges leave that out.
void hit(ImuSample& sample, const CounterRandom& random) {
  constexpr double kEvery = 4.0;    // s
  constexpr double kPush = 0.0029;  // m, of x = 1
  constexpr double kTurn = 0.0074;  // rad
  const double time = 1e-9 * static_cast<double>(sample.stamp.count()) - kFirstBlow;
  if (time < 0.0) {
    return;
  }
  const double blow = std::floor(time / kEvery);
  const Ringing ringing = ringing_after(time - blow * kEvery);
  const auto side = [&](uint64_t purpose) {
    const Eigen::Vector3d any =
        random.gaussian_vector(counter(static_cast<uint64_t>(blow), purpose));
    return Eigen::Vector3d(any / std::sqrt(any.squaredNorm()));
  };
  sample.linear_acceleration += kPush * ringing.acceleration * side(13);
  sample.angular_velocity += kTurn * ringing.velocity * side(12);
}

/// Range to an upright post, m; infinite where the ray passes it.
double range_to_post(const Firing& firing, const Eigen::Vector2d& center, double radius) {
  const Eigen::Vector2d from = firing.origin.head<2>() - center;
  const Eigen::Vector2d way = firing.direction.head<2>();
  const double a = way.squaredNorm();
  const double b = from.dot(way);
  const double inside = b * b - a * (from.squaredNorm() - radius * radius);
  return inside < 0.0 || b > 0.0 ? std::numeric_limits<double>::infinity()
                                 : (-b - std::sqrt(inside)) / a;
}

/// Range to a box, m; infinite where the ray passes it.
double range_to_box(const Firing& firing, const Eigen::AlignedBox3d& box) {
  double enters = 0.0;
  double leaves = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double one = (box.min()[k] - firing.origin[k]) / firing.direction[k];
    const double other = (box.max()[k] - firing.origin[k]) / firing.direction[k];
    enters = std::max(enters, std::min(one, other));
    leaves = std::min(leaves, std::max(one, other));
  }
  return enters < leaves ? enters : std::numeric_limits<double>::infinity();
}

/// What carries the sensor, in its frame: two posts of 8 cm to the left and right behind it, and a
/// box of 0.5 x 0.8 m whose upper side is 0.1 m below it.
void carrier_in_view(RangeSweep& sweep, const CounterRandom& random) {
  constexpr double kNoise = 0.02;  // m, of its ranges
  constexpr double kPost = 0.04;   // m, radius
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-1.7, -0.4, -0.6),
                                Eigen::Vector3d(-1.2, 0.4, -0.1));
  const uint64_t first = static_cast<uint64_t>(sweep.start);
  for (std::size_t i = 0; i < sweep.returns.size(); ++i) {
    const Firing& firing = sweep.firings[i];
    const double range =
        std::min({range_to_post(firing, {-0.5, 0.7}, kPost),
                  range_to_post(firing, {-0.5, -0.7}, kPost), range_to_box(firing, box)});
    if (std::isfinite(range) && (sweep.returns[i].range == 0.0 || range < sweep.returns[i].range)) {
      const double error = kNoise * random.gaussians(counter(first + i, 8)).x();
      sweep.returns[i] = {.range = range + error, .intensity = 40.0F, .surface = kCarrier};
    }
  }
}

/// Heavy rain: a drop answers before the surface for a share of the pulses that grows with the
/// range, from anywhere on the way within 20 m; and what is far is lost.
void rain_on(RangeSweep& sweep, const CounterRandom& random) {
  constexpr double kDrops = 0.003;       // 1/m, share of pulses that a drop scatters back
  constexpr double kNearby = 20.0;       // m, beyond it drops are too small to be seen
  constexpr double kExtinction = 0.004;  // 1/m, share lost a metre, there and back
  constexpr float kFaint = 0.05F;        // share of the surface's intensity
  const uint64_t first = static_cast<uint64_t>(sweep.start);
  for (std::size_t i = 0; i < sweep.returns.size(); ++i) {
    Return& back = sweep.returns[i];
    if (!(back.range > 0.0)) {
      continue;
    }
    const double way = std::min(back.range, kNearby);
    if (random.uniform(counter(first + i, 11)) < 1.0 - repeatable_exp(-kDrops * way)) {
      back.range = std::max(0.5, way * random.uniform(counter(first + i, 10)));
      back.intensity *= kFaint;
      back.object = 0;
      back.surface = 0;
      back.color = {};
    } else if (random.uniform(counter(first + i, 9)) <
               1.0 - repeatable_exp(-kExtinction * back.range)) {
      back = {};
    }
  }
}

}  // namespace

std::vector<std::string> fault_names() {
  std::vector<std::string> names;
  for (const auto& [name, fault] : kFaults) {
    names.emplace_back(name);
  }
  return names;
}

Fault fault_named(std::string_view name) {
  for (const auto& [known, fault] : kFaults) {
    if (known == name) {
      return fault;
    }
  }
  throw UsageError("there is no fault '" + std::string(name) + "'. " +
                   suggestion(std::string(name), fault_names()) + ".");
}

void require_seen(const std::vector<std::string>& names, double duration,
                  const SimulatedSenses& senses) {
  std::string spikes;
  for (const std::string& name : names) {
    const Fault fault = fault_named(name);
    if (!senses.imu && std::ranges::count(kOfImu, fault) > 0) {
      throw UsageError(name + " is one of the IMU, and there is none.");
    }
    if (!senses.wheels && fault >= kFirstOfWheels) {
      throw UsageError(name +
                       " is one of the wheels, and there are none. --wheels, or use in "
                       "[wheels] of a scene file, adds them.");
    }
    if (!senses.visual_odometry &&
        (fault == Fault::odometry_leap || fault == Fault::odometry_lost)) {
      throw UsageError(name +
                       " is one of the visual odometry, and there is none. --visual-odometry, or "
                       "use in [visual_odometry] of a scene file, adds it.");
    }
    if (!senses.heading && std::ranges::count(kOfHeading, fault) > 0) {
      throw UsageError(name +
                       " is one of the heading, and there is none. --heading, or heading in [gnss] "
                       "of a scene file, adds it.");
    }
    if (!senses.camera && std::ranges::count(kOfCamera, fault) > 0) {
      throw UsageError(name +
                       " is one of the cameras, and there are none. --camera, or [[camera]] of a "
                       "scene file, adds one.");
    }
    if (fault == Fault::covered && duration < 2.0 * kCarried) {
      throw UsageError(
          fmt::format("covered: lasts {:.0f} s, after which the sensor is to see again. Choose a "
                      "duration of at least {:.0f} s.",
                      kCarried, 2.0 * kCarried));
    }
    if (fault == Fault::shock && duration <= kFirstBlow) {
      throw UsageError("shock: the first blow comes after 3 s. Choose a longer duration.");
    }
    if (std::ranges::count(kSpikes, fault) > 0) {
      if (!spikes.empty()) {
        throw UsageError(name + " and " + spikes + " exclude each other.");
      }
      spikes = name;
    }
  }
}

double time_of_kidnap(double duration) {
  return std::floor(5.0 * duration) / 10.0;
}

FaultMaker::FaultMaker(std::vector<Fault> faults, double duration, uint64_t seed)
    : faults_(std::move(faults)), duration_(duration), seed_(seed) {}

bool FaultMaker::has(Fault fault) const {
  return std::ranges::count(faults_, fault) > 0;
}

void FaultMaker::distort(RangeSweep& sweep) const {
  const CounterRandom random(seed_, RandomStream::fault);
  if (has(Fault::rain)) {
    rain_on(sweep, random);
  }
  if (has(Fault::own_carrier)) {
    carrier_in_view(sweep, random);
  }
  if (has(Fault::nan)) {
    const uint64_t first = static_cast<uint64_t>(sweep.start);
    for (std::size_t i = 0; i < sweep.returns.size(); ++i) {
      if (sweep.returns[i].range > 0.0 && random.uniform(counter(first + i, 15)) < 0.05) {
        sweep.returns[i].range = std::numeric_limits<double>::quiet_NaN();
      }
    }
  }
  const double time = 1e-9 * static_cast<double>(sweep.start);
  if (has(Fault::covered) && time >= 0.4 * duration_ && time < 0.4 * duration_ + kCarried) {
    std::ranges::fill(sweep.returns, Return{});
  }
  if (has(Fault::blocked_sector)) {
    for (std::size_t i = 0; i < sweep.returns.size(); ++i) {
      // From 120 to 180 degrees.
      const Eigen::Vector3d& direction = sweep.firings[i].direction;
      if (direction.y() > 0.0 && -direction.x() > direction.y() / std::numbers::sqrt3) {
        sweep.returns[i] = {};
      }
    }
  }
}

double FaultMaker::spiked_share() const {
  return has(Fault::many_spikes)   ? 0.05
         : has(Fault::spikes)      ? 0.01
         : has(Fault::rare_spikes) ? 0.001
                                   : 0.0;
}

void FaultMaker::distort(ImuSample& sample) const {
  const CounterRandom random(seed_, RandomStream::fault);
  if (has(Fault::shock)) {
    hit(sample, random);
  }
  const auto index = static_cast<uint64_t>(sample.stamp.count());
  if (random.uniform(counter(index, 13)) < spiked_share()) {
    spike(sample, random, index);
  }
  if (has(Fault::clock_offset)) {
    sample.stamp += std::chrono::milliseconds(50);
  }
  if (has(Fault::clock_drift)) {
    sample.stamp += sample.stamp / 5000;
  }
  if (has(Fault::wrong_units)) {
    sample.linear_acceleration /= kStandardGravity;
    sample.angular_velocity *= kDegreesPerRadian;
  }
  if (has(Fault::swapped_axes)) {
    const auto turned = [](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(v.y(), -v.x(), v.z());
    };
    sample.linear_acceleration = turned(sample.linear_acceleration);
    sample.angular_velocity = turned(sample.angular_velocity);
  }
}

bool FaultMaker::wheels_slip(Nanoseconds time) const {
  constexpr double kEvery = 10.0;  // s
  constexpr double kLasts = 2.0;   // s
  constexpr uint64_t kOfSlip = uint64_t{1} << 40U;
  const double seconds = 1e-9 * static_cast<double>(time.count());
  const double window = std::floor(seconds / kEvery);
  const CounterRandom random(seed_, RandomStream::wheels);
  const double begin =
      window * kEvery + (kEvery - kLasts) * random.uniform(kOfSlip + static_cast<uint64_t>(window));
  return seconds >= begin && seconds < begin + kLasts;
}

void FaultMaker::distort(BodyVelocity& velocity) const {
  constexpr double kScale = 1.05;
  constexpr double kSlip = 1.1;
  constexpr double kKilometresPerHour = 3.6;
  if (has(Fault::wheel_scale)) {
    velocity.linear *= kScale;
  }
  if (has(Fault::wheel_slip) && wheels_slip(velocity.stamp)) {
    velocity.linear *= kSlip;
  }
  if (has(Fault::wheel_stuck)) {
    velocity.linear.setZero();
  }
  if (has(Fault::wheel_units)) {
    velocity.linear *= kKilometresPerHour;
  }
  if (has(Fault::wheel_reversed)) {
    velocity.linear.x() = -velocity.linear.x();
  }
  if (has(Fault::wheel_axes)) {
    std::swap(velocity.linear.x(), velocity.linear.y());
  }
  if (has(Fault::wheel_late)) {
    velocity.stamp += std::chrono::milliseconds(50);
  }
  if (has(Fault::wheel_zero_covariance)) {
    velocity.covariance = Eigen::Matrix3d::Zero();
  }
  if (has(Fault::wheel_negative_covariance)) {
    velocity.covariance = -Eigen::Matrix3d::Identity();
  }
}

void FaultMaker::distort(ReferencePose& pose) const {
  const double seconds = 1e-9 * static_cast<double>(pose.stamp.count());
  if (has(Fault::odometry_leap) && seconds >= 0.5 * duration_) {
    pose.T_parent_child.translation() += Eigen::Vector3d(2.0, 2.0, 1.0);
  }
  if (has(Fault::odometry_lost) && seconds >= 0.4 * duration_ && seconds < 0.4 * duration_ + 5.0) {
    pose.T_parent_child = Eigen::Isometry3d::Identity();
  }
}

void FaultMaker::distort(Heading& heading, double first) const {
  constexpr double kNoise = 20.0 * kDegree;
  constexpr double kOutliers = 0.1;
  constexpr uint64_t kOfFaults = uint64_t{1} << 40U;
  const auto index = kOfFaults + static_cast<uint64_t>(heading.stamp.count());
  const CounterRandom random(seed_, RandomStream::heading);
  if (has(Fault::heading_off_90)) {
    heading.yaw += 90.0 * kDegree;
  }
  if (has(Fault::heading_off_180)) {
    heading.yaw += 180.0 * kDegree;
  }
  if (has(Fault::heading_noisy)) {
    heading.yaw += kNoise * random.gaussians(counter(index, 15)).x();
  }
  if (has(Fault::heading_outliers) && random.uniform(counter(index, 14)) < kOutliers) {
    heading.yaw += 360.0 * kDegree * random.uniform(counter(index, 13));
  }
  if (has(Fault::heading_stuck)) {
    heading.yaw = first;
  }
}

void FaultMaker::distort(SimulatedImage& image) const {
  constexpr double kPeriod = 10.0;  // s
  if (has(Fault::camera_exposure)) {
    const double time = 1e-9 * static_cast<double>(image.stamp.count());
    const double swing = repeatable_sin_cos(2.0 * std::numbers::pi * time / kPeriod).sin;
    const double gain = repeatable_exp(std::numbers::ln2 * swing);
    for (uint8_t& part : image.image.rgb) {
      part = static_cast<uint8_t>(std::min(std::floor(gain * part + 0.5), 255.0));
    }
  }
  if (has(Fault::camera_late)) {
    image.stamp += std::chrono::milliseconds(20);
  }
}

Eigen::Isometry3d FaultMaker::stated_mount(const Eigen::Isometry3d& T_imu_camera) const {
  if (!has(Fault::camera_turned)) {
    return T_imu_camera;
  }
  const Eigen::Vector3d axis(2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0);
  Eigen::Isometry3d turned = T_imu_camera;
  turned.linear() = T_imu_camera.linear() * repeatable_so3_exp(1.0 * kDegree * axis);
  return turned;
}

bool FaultMaker::is_silent(Nanoseconds time) const {
  if (!has(Fault::gaps)) {
    return false;
  }
  const auto second = static_cast<uint64_t>(time / std::chrono::seconds(1));
  const double after = 1e-9 * static_cast<double>((time % std::chrono::seconds(1)).count());
  const CounterRandom random(seed_, RandomStream::fault);
  const double length = 0.06 + 0.09 * random.uniform(counter(second, 9));
  const double begin = (1.0 - length) * random.uniform(counter(second, 8));
  return after >= begin && after < begin + length;
}

int FaultMaker::copies(uint64_t topic, uint64_t index, Nanoseconds time) const {
  const double seconds = 1e-9 * static_cast<double>(time.count());
  if (has(Fault::gap) && seconds >= 0.4 * duration_ && seconds < 0.4 * duration_ + 2.0) {
    return 0;
  }
  const CounterRandom random(seed_, RandomStream::fault);
  return has(Fault::duplicates) && random.uniform(counter(index, topic)) < kOneIn50 ? 2 : 1;
}

bool FaultMaker::comes_late(uint64_t index) const {
  return has(Fault::reordering) &&
         CounterRandom(seed_, RandomStream::fault).uniform(counter(index, 14)) < kOneIn50;
}

}  // namespace adit
