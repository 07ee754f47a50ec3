// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/imu_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/counter_random.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr double kDegreePerHour = kDegree / 3600.0;
constexpr double kMilliG = 1e-3 * kStandardGravity;

// Time constants of the flicker's processes: 0.05 s, and each 2.5 times the one before (to 20 min).
constexpr double kShortest = 0.05;
constexpr double kRatio = 2.5;

std::vector<ImuModel> models() {
  return {
      {.name = "perfect", .gyroscope = {}, .accelerometer = {}},
      {.name = "tactical",
       .gyroscope = {.allan = {.white = 0.26 / 60.0 * kDegree,
                               .instability = 5.1 * kDegreePerHour,
                               .walk = 1e-6},
                     .turn_on_bias = 0.02 * kDegree,
                     .scale = 0.001,
                     .misalignment = 0.0009,
                     .full_scale = 480.0 * kDegree,
                     .vibration = 0.0005},
       .accelerometer = {.allan = {.white = 0.029 / 60.0,
                                   .instability = 0.07 * kMilliG,
                                   .walk = 2e-5},
                         .turn_on_bias = 1.0 * kMilliG,
                         .scale = 0.001,
                         .misalignment = 0.0006,
                         .full_scale = 18.0 * kStandardGravity,
                         .vibration = 0.02}},
      {.name = "industrial",
       .gyroscope = {.allan = {.white = 0.014 * kDegree,
                               .instability = 2.0 * kDegreePerHour,
                               .walk = 4e-6},
                     .turn_on_bias = 0.2 * kDegree,
                     .scale = 0.003,
                     .misalignment = 0.002,
                     .full_scale = 2000.0 * kDegree,
                     .vibration = 0.002},
       .accelerometer = {.allan = {.white = 0.175 * kMilliG,
                                   .instability = 0.03 * kMilliG,
                                   .walk = 1e-4},
                         .turn_on_bias = 10.0 * kMilliG,
                         .scale = 0.003,
                         .misalignment = 0.002,
                         .full_scale = 24.0 * kStandardGravity,
                         .vibration = 0.05}},
      {.name = "consumer",
       .gyroscope = {.allan = {.white = 0.015 * kDegree,
                               .instability = 8.0 * kDegreePerHour,
                               .walk = 2e-5},
                     .turn_on_bias = 0.5 * kDegree,
                     .scale = 0.01,
                     .misalignment = 0.005,
                     .full_scale = 2000.0 * kDegree,
                     .vibration = 0.004},
       .accelerometer = {.allan = {.white = 0.23 * kMilliG,
                                   .instability = 0.08 * kMilliG,
                                   .walk = 5e-4},
                         .turn_on_bias = 25.0 * kMilliG,
                         .scale = 0.005,
                         .misalignment = 0.005,
                         .full_scale = 16.0 * kStandardGravity,
                         .vibration = 0.1}},
  };
}

/// Numbers for a triad at a sample; purposes are told apart by `lane`.
uint64_t counter(int64_t index, uint64_t triad, uint64_t lane) {
  constexpr uint64_t kLanes = 16;
  return (static_cast<uint64_t>(index) * 2 + triad) * kLanes + lane;
}

/// Standard deviation of each of the processes whose sum has the bias instability B. A series of
/// Gauss-Markov processes with time constants a ratio r apart has the one-sided spectrum sigma^2 /
/// (f ln r); that of flicker noise is B^2 / (pi f).
double flicker_sigma(double instability) {
  return instability * std::sqrt(repeatable_log(kRatio) / kPi);
}

}  // namespace

std::vector<std::string> imu_names() {
  std::vector<std::string> names;
  for (const ImuModel& model : models()) {
    names.push_back(model.name);
  }
  return names;
}

ImuModel imu_named(std::string_view name) {
  for (ImuModel& model : models()) {
    if (model.name == name) {
      return std::move(model);
    }
  }
  throw UsageError("there is no IMU '" + std::string(name) + "'. " +
                   suggestion(std::string(name), imu_names()) + ".");
}

Vector3d ImuSimulator::Bias::sum() const {
  Vector3d total = constant + walk;
  for (const Vector3d& process : flicker) {
    total += process;
  }
  return total;
}

ImuSimulator::ImuSimulator(ImuModel model, int rate, const SplineTrajectory& trajectory,
                           uint64_t seed)
    : model_(std::move(model)), trajectory_(&trajectory), seed_(seed), period_(1000000000 / rate) {
  start(gyroscope_, model_.gyroscope, 0);
  start(accelerometer_, model_.accelerometer, 1);
}

void ImuSimulator::start(Bias& bias, const TriadModel& model, uint64_t triad) const {
  const CounterRandom random(seed_, RandomStream::imu_bias);
  bias.constant = model.turn_on_bias * random.gaussian_vector(counter(-1, triad, 0));
  for (std::size_t i = 0; i < Bias::kProcesses; ++i) {
    bias.flicker[i] =
        flicker_sigma(model.allan.instability) * random.gaussian_vector(counter(-1, triad, 1 + i));
  }
}

void ImuSimulator::advance(Bias& bias, const TriadModel& model, uint64_t triad) const {
  const CounterRandom random(seed_, RandomStream::imu_bias);
  const double dt = 1e-9 * static_cast<double>(period_);
  if (model.allan.walk > 0.0) {
    bias.walk +=
        model.allan.walk * std::sqrt(dt) * random.gaussian_vector(counter(index_, triad, 0));
  }
  if (model.allan.instability == 0.0) {
    return;
  }
  const double sigma = flicker_sigma(model.allan.instability);
  double constant = kShortest;
  for (std::size_t i = 0; i < Bias::kProcesses; ++i) {
    const double kept = repeatable_exp(-dt / constant);
    bias.flicker[i] =
        kept * bias.flicker[i] + sigma * std::sqrt(1.0 - kept * kept) *
                                     random.gaussian_vector(counter(index_, triad, 1 + i));
    constant *= kRatio;
  }
}

Vector3d ImuSimulator::read(const TriadModel& model, const Vector3d& truth, const Vector3d& bias,
                            uint64_t triad) const {
  const CounterRandom errors(seed_, RandomStream::imu_bias);
  const CounterRandom noise(seed_, RandomStream::imu_noise);
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  axes.diagonal() += model.scale * errors.gaussian_vector(counter(-2, triad, 0));
  const Vector3d above = model.misalignment * errors.gaussian_vector(counter(-2, triad, 1));
  const Vector3d below = model.misalignment * errors.gaussian_vector(counter(-2, triad, 2));
  axes(0, 1) = above.x();
  axes(0, 2) = above.y();
  axes(1, 2) = above.z();
  axes(1, 0) = below.x();
  axes(2, 0) = below.y();
  axes(2, 1) = below.z();
  Vector3d reading = axes * truth + bias;
  if (model.allan.white > 0.0) {
    const double rate = 1e9 / static_cast<double>(period_);
    reading +=
        model.allan.white * std::sqrt(rate) * noise.gaussian_vector(counter(index_, triad, 0));
  }
  if (model.vibration > 0.0) {
    constexpr double kFrequency = 47.0;  // Hz, an engine at 2800 turns a minute
    const double turns = kFrequency * 1e-9 * static_cast<double>(index_ * period_);
    const double angle = 2.0 * kPi * (turns - std::floor(turns));
    reading += model.vibration * Vector3d(repeatable_sin_cos(angle).sin,
                                          repeatable_sin_cos(angle + 1.0).sin,
                                          repeatable_sin_cos(angle + 2.3).sin);
  }
  if (model.full_scale > 0.0) {
    reading = reading.cwiseMax(-model.full_scale).cwiseMin(model.full_scale);
  }
  return reading;
}

SimulatedImu ImuSimulator::next() {
  const double time = 1e-9 * static_cast<double>(index_ * period_);
  SimulatedImu out;
  out.truth = trajectory_->at(time);
  out.gyroscope_bias = gyroscope_.sum();
  out.accelerometer_bias = accelerometer_.sum();
  const Vector3d force = out.truth.T_world_body.linear().transpose() *
                         (out.truth.acceleration + Vector3d(0.0, 0.0, kStandardGravity));
  out.sample.stamp = Nanoseconds(index_ * period_);
  out.sample.angular_velocity =
      read(model_.gyroscope, out.truth.angular_velocity, out.gyroscope_bias, 0);
  out.sample.linear_acceleration = read(model_.accelerometer, force, out.accelerometer_bias, 1);
  advance(gyroscope_, model_.gyroscope, 0);
  advance(accelerometer_, model_.accelerometer, 1);
  ++index_;
  return out;
}

}  // namespace adit
