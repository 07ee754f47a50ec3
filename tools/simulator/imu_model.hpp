// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/nav_state.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/tools/simulator/spline.hpp"

namespace adit {

/// A sensor's noise as its Allan deviation shows it. In the unit of the sensor: rad/s or m/s².
struct AllanParameters {
  double white = 0.0;        ///< unit/sqrt(Hz): falls as tau^-1/2, this at 1 s
  double instability = 0.0;  ///< unit: bias instability B, a floor of 0.664 B
  double walk = 0.0;         ///< unit*sqrt(Hz): random walk K, rises as K sqrt(tau / 3)
};

/// One triad of an IMU.
struct TriadModel {
  AllanParameters allan;
  double turn_on_bias = 0.0;  ///< unit, standard deviation of the constant part
  double scale = 0.0;         ///< standard deviation of each axis' scale error
  double misalignment = 0.0;  ///< rad, standard deviation of each axis' tilt
  double full_scale = 0.0;    ///< unit, larger readings are cut; 0: no limit
  double vibration = 0.0;     ///< unit, amplitude of a vibration of 47 Hz
};

struct ImuModel {
  std::string name;
  TriadModel gyroscope;
  TriadModel accelerometer;
};

std::vector<std::string> imu_names();

/// perfect, tactical (as ADIS16488A), industrial (as BMI088), consumer (as ICM-20948), from their
/// data sheets. Throws UsageError for other names, with the nearest.
ImuModel imu_named(std::string_view name);

/// A reading and what is behind it.
struct SimulatedImu {
  ImuSample sample;  ///< stamp counted from the start of the recording
  MotionState truth;
  Eigen::Vector3d gyroscope_bias = Eigen::Vector3d::Zero();      ///< rad/s
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  ///< m/s²
};

/// Reads the body's motion as an IMU there would, sample after sample.
class ImuSimulator {
 public:
  /// `rate` in Hz, a divisor of 1e9. The trajectory must outlive it.
  ImuSimulator(ImuModel model, int rate, const SplineTrajectory& trajectory, uint64_t seed);

  /// The reading at the time of the next sample; the first is at 0.
  SimulatedImu next();

 private:
  /// Bias that wanders: a constant, a random walk, and Gauss-Markov processes whose time constants
  /// are spread evenly on a logarithmic scale, which together have the flat Allan deviation of
  /// flicker noise.
  struct Bias {
    static constexpr std::size_t kProcesses = 12;
    Eigen::Vector3d constant = Eigen::Vector3d::Zero();
    Eigen::Vector3d walk = Eigen::Vector3d::Zero();
    std::array<Eigen::Vector3d, kProcesses> flicker{};

    Eigen::Vector3d sum() const;
  };

  void start(Bias& bias, const TriadModel& model, uint64_t triad) const;
  void advance(Bias& bias, const TriadModel& model, uint64_t triad) const;
  Eigen::Vector3d read(const TriadModel& model, const Eigen::Vector3d& truth,
                       const Eigen::Vector3d& bias, uint64_t triad) const;

  ImuModel model_;
  const SplineTrajectory* trajectory_;
  uint64_t seed_;
  int64_t period_;  ///< ns
  int64_t index_ = 0;
  Bias gyroscope_;
  Bias accelerometer_;
};

}  // namespace adit
