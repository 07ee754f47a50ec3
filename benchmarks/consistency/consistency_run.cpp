// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/consistency/consistency_run.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "adit/tools/simulator/imu_model.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/range_simulator.hpp"
#include "adit/tools/simulator/simulation.hpp"

namespace adit::bench {
namespace {

constexpr int kImuRate = 200;  // Hz
constexpr double kGolden = 0.6180339887498949;
constexpr double kBehind = 0.5;  // s that trajectories are defined beyond the last sweep

Sweep sweep_of(const RangeSweep& simulated) {
  Sweep sweep;
  sweep.stamp = Nanoseconds(simulated.start);
  for (std::size_t i = 0; i < simulated.returns.size(); ++i) {
    const Return& back = simulated.returns[i];
    const Firing& firing = simulated.firings[i];
    if (back.range > 0.0) {
      const Eigen::Vector3f p = (firing.origin + back.range * firing.direction).cast<float>();
      sweep.points.push_back({p.x(), p.y(), p.z(), back.intensity});
      sweep.times.push_back(1e-9F * static_cast<float>(firing.time));
      sweep.rings.push_back(firing.ring);
    }
  }
  return sweep;
}

std::array<double, 7> setting_of(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d p = pose.translation();
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

}  // namespace

std::vector<ConsistencyCase> consistency_cases() {
  return {{"room", "room", "Mid-360", "handheld"}, {"office", "office", "VLP-16", "walk"},
          {"mine", "mine", "VLP-16", "drive"},     {"city", "city", "VLP-16", "drive"},
          {"forest", "forest", "OS1-64", "walk"},  {"field", "field", "VLP-16", "walk"}};
}

std::vector<ConsistencySweep> consistency_run(engine::Context& context, Config config,
                                              const ConsistencyCase& what, const RunOfCase& run) {
  const uint64_t seed = run.first_seed + static_cast<uint64_t>(run.index);
  Scene scene = make_scene(what.scene, seed);
  const double share = (run.index + kGolden * static_cast<double>(run.first_seed - 1)) / run.runs;
  const double begin = route_length(scene) * (share - std::floor(share));
  const SplineTrajectory trajectory = make_trajectory(scene, motion_named(what.trajectory),
                                                      what.duration + kBehind, std::nullopt, begin);
  scene = out_of_the_way(
      std::move(scene), [&](double time) { return trajectory.pose(time); }, what.duration);
  const RangeSimulator lidar(scene, range_sensor_named(what.sensor),
                             {.trajectory = &trajectory, .T_body_lidar = lidar_mount()}, seed);
  ImuSimulator imu(imu_named("industrial"), kImuRate, trajectory, seed);
  config.imu.T_imu_lidar = setting_of(lidar_mount());

  Odometry odometry(context, config);
  std::vector<ConsistencySweep> sweeps;
  ImuSample next = imu.next().sample;
  const double period = 1e-9 * static_cast<double>(lidar.sensor().period);
  const int count = static_cast<int>(std::floor(what.duration / period + 1e-6));
  for (int i = 0; i < count; ++i) {
    const Sweep sweep = sweep_of(lidar.sweep(i));
    const Nanoseconds end = sweep.stamp + Nanoseconds(lidar.sensor().period);
    for (; next.stamp <= end; next = imu.next().sample) {
      odometry.add(next);
    }
    sweeps.push_back({.result = odometry.step(sweep), .T_world_lidar = lidar.pose(i * period)});
    sweeps.back().result.cloud.clear();
  }
  return sweeps;
}

}  // namespace adit::bench
