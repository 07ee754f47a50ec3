// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/sweep_motion.hpp"

#include <algorithm>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/inertial/imu_buffer.hpp"
#include "adit/slam/inertial/preintegration.hpp"

namespace adit {
namespace {

double knot_time(double first, double last, int k) {
  return first + (last - first) * k / (kMotionKnots - 1);
}

/// Body poses along the readings, one time after the other, later ones later.
class Walk {
 public:
  Walk(const NavState& state, std::span<const ImuSample> readings)
      : state_(state), readings_(readings), now_(readings.front()) {
    so_far_.bias = state.bias;
  }

  Eigen::Isometry3d T_map_body(Nanoseconds stamp) {
    while (next_ < readings_.size() && readings_[next_].stamp <= stamp) {
      step(readings_[next_++]);
    }
    if (next_ < readings_.size() && now_.stamp < stamp) {
      step(interpolate(readings_[next_ - 1], readings_[next_], stamp));
    }
    const NavState here = predict(state_, so_far_);
    const double beyond = std::max(0.0, seconds(stamp - now_.stamp));
    Eigen::Isometry3d pose = here.T_map_body;
    pose.translation() += beyond * here.v_map_body;
    pose.linear() *= so3_exp(beyond * (now_.angular_velocity - state_.bias.gyro));
    return pose;
  }

 private:
  void step(const ImuSample& to) {
    if (to.stamp > now_.stamp) {
      so_far_ = advanced(so_far_, now_, to, {});
    }
    now_ = to;
  }

  NavState state_;
  std::span<const ImuSample> readings_;
  Preintegration so_far_;
  ImuSample now_;
  size_t next_ = 1;
};

}  // namespace

SweepMotion steady_motion(const Vector6d& twist, double first, double last) {
  SweepMotion motion{.first = first, .last = last, .T_start_lidar = {}};
  for (int k = 0; k < kMotionKnots; ++k) {
    motion.T_start_lidar.push_back(se3_exp(knot_time(first, last, k) * twist));
  }
  return motion;
}

SweepMotion inertial_motion(const NavState& state, std::span<const ImuSample> readings,
                            const Eigen::Isometry3d& T_body_lidar, double first, double last) {
  const Eigen::Isometry3d T_start_map = (state.T_map_body * T_body_lidar).inverse();
  Walk walk(state, readings);
  SweepMotion motion{.first = first, .last = last, .T_start_lidar = {}};
  for (int k = 0; k < kMotionKnots; ++k) {
    const auto after = std::chrono::duration<double>(knot_time(first, last, k));
    const Nanoseconds stamp = state.stamp + std::chrono::round<Nanoseconds>(after);
    motion.T_start_lidar.push_back(T_start_map * walk.T_map_body(stamp) * T_body_lidar);
  }
  return motion;
}

std::vector<gpu::DeskewKnot> knots(const SweepMotion& motion) {
  std::vector<gpu::DeskewKnot> table;
  Eigen::Quaterniond last = Eigen::Quaterniond::Identity();
  for (const Eigen::Isometry3d& pose : motion.T_start_lidar) {
    Eigen::Quaterniond q(pose.linear());
    q.coeffs() *= q.dot(last) < 0.0 ? -1.0 : 1.0;
    last = q;
    const Eigen::Vector4f rotation = q.coeffs().cast<float>();
    const Eigen::Vector3f translation = pose.translation().cast<float>();
    table.push_back({{rotation.x(), rotation.y(), rotation.z(), rotation.w()},
                     {translation.x(), translation.y(), translation.z(), 0.0F}});
  }
  return table;
}

Eigen::Vector3d mean_turn(const SweepMotion& motion) {
  const std::vector<Eigen::Isometry3d>& poses = motion.T_start_lidar;
  Eigen::Vector3d sum =  // the ends count half
      -0.5 * (so3_log(poses.front().linear()) + so3_log(poses.back().linear()));
  for (const Eigen::Isometry3d& pose : poses) {
    sum += so3_log(pose.linear());
  }
  return sum / static_cast<double>(poses.size() - 1);
}

}  // namespace adit
