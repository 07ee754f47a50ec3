// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/lidar_mounting.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>
#include <variant>

#include <fmt/core.h>
#include <Eigen/Cholesky>

#include "adit/slam/core/farthest_point_time.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/slam/inertial/rotation_comparison.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/slam/registration/cloud_aligner.hpp"
#include "adit/slam/registration/front_end.hpp"
#include "adit/tools/map_products/dense_cloud.hpp"
#include "adit/tools/recordings/tolerant_recording.hpp"

namespace adit {
namespace {

constexpr double kMappedTime = 10.0;      // s: some hundred sweeps
constexpr std::size_t kCompared = 20;     // of them
constexpr std::size_t kLeastAligned = 5;  // of which a scatter can be estimated
// What a map of submaps of a quarter of a metre does not notice: 9 cm at 10 m.
constexpr double kHarmlessTurn = 0.5 * kDegree;  // rad
constexpr double kHarmlessShift = 0.05;          // m

/// What the first sensor has mapped, and the sweeps of the other one meanwhile.
struct Stretch {
  std::vector<Point> map{};          ///< m, map frame
  std::vector<StampedPose> poses{};  ///< T_map_lidar
  std::vector<Sweep> further{};
};

Stretch read_stretch(const Recording& recording, const MergedTopic& first,
                     const MergedTopic& further, const Config& config, engine::Context& context) {
  Stretch stretch;
  Config alone = config;
  alone.imu.use = false;
  Odometry odometry(context, alone);
  const auto whole = pass_over_damage(recording, [](const InputError&) {});  // reported elsewhere
  const auto events = whole->events({.topics = {first.topic, further.topic}});
  while (std::optional<Event> event = events->next()) {
    auto* sweep = std::get_if<Sweep>(&event->value);
    if (sweep == nullptr) {
      continue;
    }
    const bool mapped = !stretch.poses.empty();
    if (mapped && seconds(sweep->stamp - stretch.poses.front().stamp) > kMappedTime) {
      break;
    }
    if (event->topic == further.topic) {
      if (mapped) {
        stretch.further.push_back(std::move(*sweep));
      }
      continue;
    }
    if (mapped && sweep->stamp <= stretch.poses.back().stamp) {
      continue;
    }
    const SweepResult result = odometry.step(*sweep);
    stretch.poses.push_back({.stamp = sweep->stamp, .pose = result.T_map_lidar});
    const std::vector<Point> cloud = odometry.cloud();
    if (stretch.map.size() + cloud.size() > kLargestSweep) {
      break;  // as much as can be aligned with
    }
    for (const Point& point : cloud) {
      const Eigen::Vector3f p =
          (result.T_map_lidar * Eigen::Vector3d(point.x, point.y, point.z)).cast<float>();
      stretch.map.push_back({p.x(), p.y(), p.z(), point.intensity});
    }
  }
  return stretch;
}

/// A sweep of the further sensor as it would have been seen at its stamp.
struct PlacedSweep {
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  std::vector<Point> points{};  ///< m, axes of the further sensor
};

std::optional<PlacedSweep> placed(const Sweep& sweep, const std::vector<StampedPose>& poses,
                                  const Eigen::Isometry3d& T_lidar_sensor) {
  const auto after = std::ranges::upper_bound(poses, sweep.stamp, {}, &StampedPose::stamp);
  if (after == poses.begin() || after == poses.end()) {
    return std::nullopt;
  }
  const Nanoseconds before = std::prev(after)->stamp;
  const auto path = SensorPath(poses).from(before);
  if (!path) {
    return std::nullopt;
  }
  const double begin = seconds(sweep.stamp - before);
  PlacedSweep result{.T_map_lidar = path->at(begin)};
  const Eigen::Isometry3d T_sensor_map = (result.T_map_lidar * T_lidar_sensor).inverse();
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const Point& point = sweep.points[i];
    const double time = sweep.times.empty() ? 0.0 : static_cast<double>(sweep.times[i]);
    const Eigen::Vector3d p = Eigen::Vector3d(point.x, point.y, point.z) + sweep.offset;
    if (!p.allFinite() || p.isZero(0.0) || !(std::abs(time) <= kFarthestPointTime)) {
      continue;
    }
    const Eigen::Vector3f q =
        (T_sensor_map * path->at(begin + time) * T_lidar_sensor * p).cast<float>();
    result.points.push_back({q.x(), q.y(), q.z(), point.intensity});
  }
  return result;
}

/// The pose is where the guess leads to. Another one that fits as well is far from the guess, and
/// a direction that no match holds has next to no information.
bool is_evidence(AlignmentRefusal refusal) {
  return refusal == AlignmentRefusal::none || refusal == AlignmentRefusal::ambiguous ||
         refusal == AlignmentRefusal::degenerate;
}

/// The error of the expected mounting by one alignment, and its information.
struct MountingError {
  Vector6d error;
  Matrix6d information;
};

/// The mean of the alignments' errors, each weighed by its information, and less where it is far
/// from the others (Cauchy's weights). Its covariance is that of the information, and of the
/// scatter as it is in each direction: the "sandwich" of White (1980), since matches err together.
void combine(const std::vector<MountingError>& errors, LidarMounting& mounting) {
  constexpr int kIterations = 20;  // it has converged
  Vector6d mean = Vector6d::Zero();
  double scale = 1.0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Matrix6d information = Matrix6d::Zero();
    Matrix6d scatter = Matrix6d::Zero();
    Vector6d sum = Vector6d::Zero();
    double weights = 0.0;
    double squares = 0.0;
    for (const MountingError& one : errors) {
      const Vector6d pull = one.information * (one.error - mean);
      const double squared = pull.dot(one.error - mean) / 6.0;
      const double weight = 1.0 / (1.0 + squared / scale);
      information += weight * one.information;
      scatter += weight * weight * pull * pull.transpose();
      sum += weight * one.information * one.error;
      weights += weight;
      squares += weight * squared;
    }
    const Matrix6d covariance = information.ldlt().solve(Matrix6d::Identity());
    mean = covariance * sum;
    scale = std::max(1.0, squares / weights);
    mounting.covariance = covariance + covariance * scatter * covariance;
  }
  mounting.found = mounting.expected * se3_exp(mean);
}

std::string text_of(const Eigen::Isometry3d& pose) {
  const auto n = numbers_of(pose);
  return fmt::format("[{:.3f}, {:.3f}, {:.3f}, {:.5f}, {:.5f}, {:.5f}, {:.5f}]", n[0], n[1], n[2],
                     n[3], n[4], n[5], n[6]);
}

/// How far the sensor is from its expected pose, with standard deviations.
struct Deviation {
  double turn = 0.0;         ///< rad
  double turn_sigma = 0.0;   ///< along that axis
  double shift = 0.0;        ///< m
  double shift_sigma = 0.0;  ///< in that direction
};

double sigma_along(const Eigen::Vector3d& v, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d axis = v.stableNormalized();
  return std::sqrt(std::max(0.0, axis.dot(covariance * axis)));
}

Deviation deviation_of(const LidarMounting& mounting) {
  const Vector6d error = se3_log(mounting.expected.inverse() * *mounting.found);
  return {.turn = error.tail<3>().norm(),
          .turn_sigma = sigma_along(error.tail<3>(), mounting.covariance.bottomRightCorner<3, 3>()),
          .shift = error.head<3>().norm(),
          .shift_sigma = sigma_along(error.head<3>(), mounting.covariance.topLeftCorner<3, 3>())};
}

}  // namespace

LidarMounting check_lidar_mounting(const Recording& recording, const MergedTopic& first,
                                   const MergedTopic& further, const Config& config,
                                   engine::Context& context) {
  LidarMounting mounting{.topic = recording.topics()[further.topic].name,
                         .to_topic = recording.topics()[first.topic].name,
                         .expected = further.sensor.T_lidar_sensor};
  const Stretch stretch = read_stretch(recording, first, further, config, context);
  if (stretch.poses.empty()) {
    return mounting;
  }
  CloudAligner aligner(context, {.min_overlap = config.registration.min_overlap});
  const AlignableCloud map =
      aligner.prepare(stretch.map, stretch.poses[stretch.poses.size() / 2].pose.translation());
  std::vector<MountingError> errors;
  const std::size_t every = (stretch.further.size() + kCompared - 1) / kCompared;
  for (std::size_t i = 0; i < stretch.further.size(); i += every) {
    const auto sweep = placed(stretch.further[i], stretch.poses, mounting.expected);
    if (!sweep) {
      continue;
    }
    ++mounting.compared;
    const AlignableCloud cloud = aligner.prepare(sweep->points, Eigen::Vector3d::Zero().eval());
    const CloudPair pair{.a = &map, .b = &cloud, .guess = sweep->T_map_lidar * mounting.expected};
    const CloudAlignment result = aligner.align(std::span(&pair, 1)).front();
    if (is_evidence(result.refusal)) {
      const Eigen::Isometry3d T_lidar_sensor = sweep->T_map_lidar.inverse() * result.T_a_b;
      errors.push_back(
          {.error = se3_log(mounting.expected.inverse() * T_lidar_sensor),
           .information = covariance(result.registration, CovarianceModel{}).inverse()});
    }
  }
  mounting.aligned = errors.size();
  if (errors.size() >= kLeastAligned) {
    combine(errors, mounting);
  }
  return mounting;
}

std::string describe(const LidarMounting& mounting) {
  if (!mounting.found) {
    return fmt::format(
        "of {} sweeps {} could be aligned with the map of {}: too few to say how "
        "it is mounted",
        mounting.compared, mounting.aligned, mounting.to_topic);
  }
  const Deviation deviation = deviation_of(mounting);
  return fmt::format(
      "by {} of {} sweeps it lies {:.2f} degrees (+- {:.2f}) and {:.3f} m (+- {:.3f}) from where "
      "it is said to be on {}; pose in that one's axes {}",
      mounting.aligned, mounting.compared, deviation.turn * kDegreesPerRadian,
      kSureSigmas * deviation.turn_sigma * kDegreesPerRadian, deviation.shift,
      kSureSigmas * deviation.shift_sigma, mounting.to_topic, text_of(*mounting.found));
}

std::vector<Finding> find_in_mounting(const LidarMounting& mounting) {
  if (!mounting.found) {
    return {{Severity::notice, "lidar_mounting_unchecked", mounting.topic, describe(mounting),
             "an error of the mounting is not found",
             "Record a stretch in which both sensors see the same walls"}};
  }
  const Deviation deviation = deviation_of(mounting);
  const bool turned = deviation.turn > kHarmlessTurn + kSureSigmas * deviation.turn_sigma;
  const bool shifted = deviation.shift > kHarmlessShift + kSureSigmas * deviation.shift_sigma;
  if (!turned && !shifted) {
    return {};
  }
  return {
      {Severity::problem, "lidar_mounting", mounting.topic, describe(mounting),
       fmt::format("its points lie {:.2f} m off at 10 m", deviation.shift + 10.0 * deviation.turn),
       "Correct the transform, or use the recording.T_lidar_further that --write-config "
       "writes"}};
}

}  // namespace adit
