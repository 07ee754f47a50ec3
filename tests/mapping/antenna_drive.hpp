// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A drive with a receiver whose antenna sits elsewhere than it is taken to, and whose fixes are
// late.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "adit/slam/gnss/antenna_calibration.hpp"
#include "adit/slam/gnss/gnss_noise.hpp"
#include "adit/slam/gnss/map_fix.hpp"
#include "adit/slam/graph/solver.hpp"

namespace adit::test {

inline constexpr double kStep = 0.01;                // s, of the truth
inline constexpr double kFixRate = 2.5;              // Hz
inline constexpr double kCorrelation = 60.0;         // s
inline const Eigen::Vector3d kMast(-0.4, 0.3, 1.2);  // m, where the antenna is taken to be

/// How something drives: speed (m/s) and turn rates about its y and z axes (rad/s) at a time (s).
struct Driving {
  std::function<double(double)> speed;
  std::function<double(double)> pitch_rate;
  std::function<double(double)> yaw_rate;
};

/// Changing speeds, left and right corners, and slopes.
inline Driving in_town() {
  return {.speed = [](double t) { return 6.0 + 3.0 * std::sin(0.2 * t); },
          .pitch_rate = [](double t) { return 0.03 * std::cos(0.3 * t); },
          .yaw_rate = [](double t) { return 0.35 * std::sin(0.11 * t) * std::sin(0.4 * t); }};
}

inline Driving straight_on() {
  const auto none = [](double) { return 0.0; };
  return {.speed = [](double) { return 8.0; }, .pitch_rate = none, .yaw_rate = none};
}

/// A drive with a node a second, whose odometry errs as its edges say, and fixes of a receiver
/// whose antenna sits elsewhere than it is taken to, and whose stamps are late.
class AntennaDrive {
 public:
  struct Errors {
    AntennaError antenna = AntennaError::Zero();
    double fix_sigma = 0.0;             ///< m, nine tenths of its variance correlated
    double edge_sigma = 0.0;            ///< m and, a tenth of it, rad, each second
    double correlation = kCorrelation;  ///< s, of the receiver's errors
    double multipath = 0.0;             ///< m, that fixes are off by from 40 % to 60 % of the way
    double outliers = 0.0;              ///< share of the fixes, 3 to 25 m off
  };

  AntennaDrive(const Driving& driving, double duration, const Errors& errors, unsigned seed = 1)
      : random_(seed) {
    Eigen::Isometry3d T_world_lidar = Eigen::Isometry3d::Identity();
    T_world_lidar.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    for (double t = 0.0; t <= duration; t += kStep) {
      Vector6d twist;
      twist << driving.speed(t), 0.0, 0.0, 0.0, driving.pitch_rate(t), driving.yaw_rate(t);
      truth_.push_back({.T_odom_lidar = T_world_lidar, .twist = twist});
      T_world_lidar = T_world_lidar * se3_exp(kStep * twist);
    }
    const double sigma = std::max(1e-3, errors.edge_sigma);
    Vector6d deviations;
    deviations << Eigen::Vector3d::Constant(sigma), Eigen::Vector3d::Constant(0.1 * sigma);
    Matrix6d information = deviations.cwiseAbs2().cwiseInverse().asDiagonal();
    graph_.set_T_world_map(T_world_node(0));
    Eigen::Isometry3d T_map_node = Eigen::Isometry3d::Identity();
    for (NodeId id = 0; id < static_cast<NodeId>(duration); ++id) {
      if (id > 0) {
        Vector6d error;
        for (double& entry : error) {
          entry = normal_(random_);
        }
        const Eigen::Isometry3d way =
            T_world_node(id - 1).inverse() * T_world_node(id) *
            se3_exp(errors.edge_sigma > 0.0 ? Vector6d(deviations.cwiseProduct(error))
                                            : Vector6d(Vector6d::Zero()));
        T_map_node = T_map_node * way;
        graph_.add_node({.id = id, .T_map_node = T_map_node});
        graph_.add_edge({.from = id - 1, .to = id, .T_from_to = way, .information = information});
      } else {
        graph_.add_node({.id = id, .T_map_node = T_map_node, .fixed = true});
      }
      graph_.add_level({.node = id, .information = 2500.0});
    }
    add_fixes(duration, errors);
  }

  /// Where the graph is once it is optimised with the fixes as they are taken.
  void optimize_graph() {
    graph_.clear_fixes();
    for (const AntennaSighting& sighting : sightings_) {
      graph_.add_fix({.node = sighting.node,
                      .p_node = p_node_antenna(sighting, AntennaError::Zero()),
                      .p_world = sighting.p_world,
                      .information = shares_[graph_.fixes().size()] *
                                     fix_information(sighting.covariance, true)});
    }
    const OptimizedGraph optimum = optimize(graph_, {});
    graph_.set_poses(optimum.poses);
    graph_.set_T_world_map(optimum.T_world_map);
  }

  /// Sightings as if that much had been wrong with the antenna and the stamps.
  void take(const AntennaError& error) {
    taken_ = error;
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      place(i);
    }
  }

  /// The fixes as a map has them, their places in the world those of the sightings from `frame`.
  std::vector<MapFix> map_fixes(const WorldFrame& frame) const {
    std::vector<MapFix> fixes;
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      const AntennaSighting& sighting = sightings_[i];
      fixes.push_back({.id = static_cast<int64_t>(i) + 1,
                       .keyframe = sighting.node,
                       .stamp = nanoseconds(stamps_[i]),
                       .kind = GnssFixKind::ground_augmented,
                       .place = frame.place_of(sighting.p_world),
                       .covariance = sighting.covariance,
                       .p_keyframe_antenna = p_node_antenna(sighting, AntennaError::Zero()),
                       .path = path_at(stamps_[i]),
                       .T_keyframe_lidar = sighting.T_node_lidar,
                       .twist = sighting.twist});
    }
    return fixes;
  }

  /// Of the lidar, ten a second.
  std::vector<StampedPose> odometry() const {
    std::vector<StampedPose> poses;
    for (std::size_t i = 0; i < truth_.size(); i += 10) {
      poses.push_back(
          {.stamp = nanoseconds(kStep * static_cast<double>(i)), .pose = truth_[i].T_odom_lidar});
    }
    return poses;
  }

  /// How far nodes lie from where they are in the world (m, rms).
  double world_error(const PoseGraph& graph, const Eigen::Isometry3d& T_world_map) const {
    double sum = 0.0;
    for (const PoseNode& node : graph.nodes()) {
      sum += (T_world_map * node.T_map_node.translation() - T_world_node(node.id).translation())
                 .squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(graph.nodes().size()));
  }

  AntennaEstimate estimate() const {
    return estimate_antenna(graph_, sightings_, {.correlation = kCorrelation}).value();
  }
  const std::vector<AntennaSighting>& sightings() const { return sightings_; }
  const PoseGraph& graph() const { return graph_; }

 private:
  TrackedMotion at(double t) const {
    const double steps = std::clamp(t / kStep, 0.0, static_cast<double>(truth_.size() - 1));
    const auto i = static_cast<std::size_t>(steps + 1e-9);
    TrackedMotion motion = truth_[i];
    motion.T_odom_lidar =
        motion.T_odom_lidar * se3_exp((steps - static_cast<double>(i)) * kStep * motion.twist);
    return motion;
  }

  /// Level, as keyframes are.
  Eigen::Isometry3d T_world_node(NodeId node) const {
    Eigen::Isometry3d pose = at(static_cast<double>(node)).T_odom_lidar;
    const Eigen::Vector3d x = pose.linear().col(0);
    pose.linear() =
        Eigen::AngleAxisd(std::atan2(x.y(), x.x()), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return pose;
  }

  void place(std::size_t i) {
    AntennaSighting& sighting = sightings_[i];
    const double t = stamps_[i] - taken_(kDelay);
    sighting.T_node_lidar = T_world_node(sighting.node).inverse() * at(t).T_odom_lidar;
    sighting.twist = at(t).twist;
    sighting.p_lidar_antenna = kMast + taken_.head<3>();
  }

  void add_fixes(double duration, const Errors& errors) {
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const double kept = std::exp(-1.0 / kFixRate / errors.correlation);
    const double sigma = std::max(0.02, errors.fix_sigma);
    const Eigen::Vector3d deviations(sigma, sigma, 2.0 * sigma);
    Eigen::Vector3d drift = noise();
    for (double stamp = 1.0; stamp + 1.0 < duration; stamp += 1.0 / kFixRate) {
      drift = kept * drift + std::sqrt(1.0 - kept * kept) * noise();
      Eigen::Vector3d error =
          errors.fix_sigma / sigma *
          deviations.cwiseProduct(std::sqrt(0.9) * drift + std::sqrt(0.1) * noise());
      if (uniform(random_) < errors.outliers) {
        const double way = 6.28 * uniform(random_);
        error +=
            (3.0 + 22.0 * uniform(random_)) * Eigen::Vector3d(std::cos(way), std::sin(way), 0.5);
      }
      if (stamp > 0.4 * duration && stamp < 0.6 * duration) {
        error += errors.multipath * Eigen::Vector3d(0.8, -0.6, 0.0);
      }
      const double taken = stamp - errors.antenna(kDelay);
      stamps_.push_back(stamp);
      AntennaSighting sighting;
      sighting.node = static_cast<NodeId>(stamp + 1e-9);
      sighting.p_world = at(taken).T_odom_lidar * (kMast + errors.antenna.head<3>()) + error;
      sighting.covariance = deviations.cwiseAbs2().asDiagonal();
      sighting.time = stamp;
      sightings_.push_back(sighting);
      place(sightings_.size() - 1);
    }
    shares_ = independent_shares(stamps_, kCorrelation);
  }

  /// m, since the beginning.
  double path_at(double t) const {
    double path = 0.0;
    for (std::size_t i = 0; kStep * static_cast<double>(i) < t; ++i) {
      path += kStep * truth_[i].twist.head<3>().norm();
    }
    return path;
  }

  Eigen::Vector3d noise() { return {normal_(random_), normal_(random_), normal_(random_)}; }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::vector<TrackedMotion> truth_;  ///< T_world_lidar, each hundredth of a second
  PoseGraph graph_;
  std::vector<double> stamps_;
  std::vector<double> shares_;
  std::vector<AntennaSighting> sightings_;
  AntennaError taken_ = AntennaError::Zero();
};

}  // namespace adit::test
