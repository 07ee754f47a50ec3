// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Motion in closed form, and what an inertial sensor reads in it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "adit/slam/core/imu_noise.hpp"
#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/nav_state.hpp"

namespace adit::test {

inline Nanoseconds at_seconds(double time) {
  return std::chrono::round<Nanoseconds>(std::chrono::duration<double>(time));
}

/// T_body_lidar of a lidar beside the IMU that looks elsewhere.
inline Eigen::Isometry3d turned_mounting() {
  Vector6d xi;
  xi << 0.05, -0.02, 0.1, 0.0, 0.1, 0.7;
  return se3_exp(xi);
}

inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// A sine and a constant speed, with their derivatives.
struct Wave {
  double amplitude = 0.0;
  double frequency = 0.0;  ///< Hz
  double phase = 0.0;
  double speed = 0.0;  ///< 1/s

  double value(double t) const { return speed * t + amplitude * std::sin(angle(t)); }
  double rate(double t) const { return speed + amplitude * turn() * std::cos(angle(t)); }
  double acceleration(double t) const { return -amplitude * turn() * turn() * std::sin(angle(t)); }

 private:
  double turn() const { return 2.0 * M_PI * frequency; }
  double angle(double t) const { return turn() * t + phase; }
};

/// Position and roll, pitch and yaw as waves: R = Rz(yaw) Ry(pitch) Rx(roll), z of the map up.
struct WavyMotion {
  std::array<Wave, 3> position;
  std::array<Wave, 3> angles;  ///< roll, pitch, yaw
  Eigen::Vector3d gravity = Eigen::Vector3d(0.0, 0.0, -9.80665);
  /// s: it stands still until then, and takes a second to come up to speed.
  double rest = -std::numeric_limits<double>::infinity();

  NavState state(double time) const {
    const auto [t, pace, quickening] = warped(time);
    NavState state;
    state.stamp = at_seconds(time);
    state.gravity_map = gravity;
    for (int i = 0; i < 3; ++i) {
      state.T_map_body.translation()[i] = position[static_cast<size_t>(i)].value(t);
      state.v_map_body[i] = pace * position[static_cast<size_t>(i)].rate(t);
    }
    state.T_map_body.linear() = (Eigen::AngleAxisd(angles[2].value(t), Eigen::Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(angles[1].value(t), Eigen::Vector3d::UnitY()) *
                                 Eigen::AngleAxisd(angles[0].value(t), Eigen::Vector3d::UnitX()))
                                    .toRotationMatrix();
    return state;
  }

  /// Without noise or bias.
  ImuSample sample(double time) const {
    const auto [t, pace, quickening] = warped(time);
    const double roll = angles[0].value(t);
    const double pitch = angles[1].value(t);
    Eigen::Matrix3d body_rates;                                 // from the angles' rates
    body_rates << 1.0, 0.0, -std::sin(pitch),                   //
        0.0, std::cos(roll), std::sin(roll) * std::cos(pitch),  //
        0.0, -std::sin(roll), std::cos(roll) * std::cos(pitch);
    const Eigen::Vector3d rates(angles[0].rate(t), angles[1].rate(t), angles[2].rate(t));
    Eigen::Vector3d acceleration;
    for (int i = 0; i < 3; ++i) {
      const Wave& wave = position[static_cast<size_t>(i)];
      acceleration[i] = pace * pace * wave.acceleration(t) + quickening * wave.rate(t);
    }
    return {at_seconds(time), pace * (body_rates * rates),
            state(time).T_map_body.linear().transpose() * (acceleration - gravity)};
  }

 private:
  /// Time along the waves, and its first two derivatives.
  struct Warped {
    double time = 0.0;
    double pace = 1.0;
    double quickening = 0.0;  ///< 1/s
  };
  Warped warped(double time) const {
    const double s = time - rest;
    if (std::isinf(rest)) {
      return {.time = time};
    }
    if (s <= 0.0) {
      return {.time = 0.0, .pace = 0.0};
    }
    return s < 1.0
               ? Warped{s * s * s * (1.0 - 0.5 * s), s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s)}
               : Warped{.time = s - 0.5};
  }
};

/// Somebody waving a sensor about: up to 2 rad/s, 1 to 4 Hz.
inline WavyMotion hand_held_motion() {
  return {.position = {{{0.03, 2.1, 0.3, 0.4}, {0.03, 1.7, 1.1, 0.0}, {0.008, 3.3, 2.0, 0.0}}},
          .angles = {{{0.06, 3.7, 0.2, 0.0}, {0.08, 2.9, 1.3, 0.0}, {0.25, 1.1, 0.7, 0.3}}}};
}

/// `rate` readings a second from `begin` to `end` (s), both included, with biases.
inline std::vector<ImuSample> readings(const WavyMotion& motion, double begin, double end,
                                       double rate, const ImuBias& bias = {}) {
  std::vector<ImuSample> samples;
  const auto steps = static_cast<int>(std::llround((end - begin) * rate));
  for (int i = 0; i <= steps; ++i) {
    samples.push_back(motion.sample(begin + i / rate));
    samples.back().angular_velocity += bias.gyro;
    samples.back().linear_acceleration += bias.accel;
  }
  return samples;
}

/// White noise of the given densities on readings `rate` times a second.
inline void add_noise(std::vector<ImuSample>& samples, const ImuNoise& noise, double rate,
                      std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  for (ImuSample& sample : samples) {
    sample.angular_velocity += noise.gyro * std::sqrt(rate) * draw();
    sample.linear_acceleration += noise.accel * std::sqrt(rate) * draw();
  }
}

}  // namespace adit::test
