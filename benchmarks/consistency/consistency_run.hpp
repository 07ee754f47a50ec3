// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The odometry on simulated sweeps and readings whose truth is known, in memory.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adit/slam/odometry/odometry.hpp"

namespace adit::bench {

/// What is simulated; the runs of a case begin at different places of the scene's route, and differ
/// in whatever is random: scene, range noise, readings of the IMU (BMI088's).
struct ConsistencyCase {
  std::string name{};
  std::string scene{};
  std::string sensor{};
  std::string trajectory{};
  double duration = 6.0;  ///< s
};

/// The cases of `adit bench consistency`.
std::vector<ConsistencyCase> consistency_cases();

/// A sweep beside its truth.
struct ConsistencySweep {
  SweepResult result;
  Eigen::Isometry3d T_world_lidar = Eigen::Isometry3d::Identity();
};

/// Which of the runs of a case: what is random follows from `first_seed` + `index`, the beginnings
/// are spread over the scene's route, others with another `first_seed`.
struct RunOfCase {
  int index = 0;
  int runs = 1;
  uint64_t first_seed = 1;
};

/// `config` is as the user set it; the mounting is the simulator's. Throws
/// UsageError for names the simulator does not know, engine::Error.
std::vector<ConsistencySweep> consistency_run(engine::Context& context, Config config,
                                              const ConsistencyCase& what, const RunOfCase& run);

}  // namespace adit::bench
