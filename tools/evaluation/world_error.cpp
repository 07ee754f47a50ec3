// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/world_error.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/gnss/world_covariance.hpp"
#include "adit/slam/graph/horizontal_drift.hpp"
#include "adit/tools/evaluation/evaluate_association.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

constexpr std::size_t kMostJudged = 100;  // keyframes, evenly spread

Trajectory stamped(const std::filesystem::path& file, std::vector<StampedPose> poses) {
  return {.file = file, .stamped = true, .poses = std::move(poses)};
}

/// The first pose of each keyframe that is judged.
struct JudgedKeyframes {
  std::vector<NodeId> ids;
  std::vector<StampedPose> poses;
};

JudgedKeyframes chosen(const std::vector<MapKeyframe>& keyframes) {
  JudgedKeyframes judged;
  const std::size_t step = 1 + keyframes.size() / kMostJudged;
  for (std::size_t i = 0; i < keyframes.size(); i += step) {
    judged.ids.push_back(keyframes[i].id);
    judged.poses.push_back({.stamp = keyframes[i].stamp, .pose = keyframes[i].T_map_keyframe});
  }
  return judged;
}

/// With the odometry's covariances as far as the fixes do not rule them out.
PoseGraph as_drifted(const PoseGraph& graph) {
  return with_horizontal_drift(graph, horizontal_drift(graph).largest);
}

}  // namespace

WorldError world_error(const std::filesystem::path& map, const Trajectory& truth,
                       const Geodetic& truth_origin, double tolerance) {
  const MapDatabase database(map, MapAccess::read);
  const std::optional<Georeference> world = database.georeference();
  if (!world) {
    throw InputError(map, {}, "the map has no place in the world",
                     "Map a recording whose GNSS fixes tell it; the run says what became of them");
  }
  const WorldFrame frame(world->origin);
  const auto true_position = [&](std::size_t i) {
    return frame.position_of(
        place_in_tangent_plane(truth_origin, truth.poses[i].pose.translation()));
  };
  const auto error_of = [&](const StampedPose& estimate, std::size_t of_truth) {
    return Eigen::Vector3d(world->T_world_map * estimate.pose.translation() -
                           true_position(of_truth));
  };
  WorldError result;
  std::vector<double> horizontal;
  std::vector<double> vertical;
  const Trajectory sweeps = stamped(map, map_trajectory(database, map));
  for (const MatchedPair& pair : associate(sweeps, truth, tolerance).pairs) {
    const Eigen::Vector3d error = error_of(sweeps.poses[pair.estimate], pair.truth);
    horizontal.push_back(error.head<2>().norm());
    vertical.push_back(std::abs(error.z()));
    result.mean += error;
  }
  result.mean /= static_cast<double>(horizontal.size());
  result.horizontal = statistics(horizontal);
  result.vertical = statistics(vertical);

  const JudgedKeyframes judged = chosen(database.keyframes());
  const Trajectory keyframes = stamped(map, judged.poses);
  const std::vector<Eigen::Matrix3d> covariances =
      world_covariances(as_drifted(database.graph()), judged.ids);
  for (const MatchedPair& pair : associate(keyframes, truth, tolerance).pairs) {
    if (!covariances.empty()) {
      const Eigen::Vector3d error = error_of(keyframes.poses[pair.estimate], pair.truth);
      result.nees += error.dot(covariances[pair.estimate].ldlt().solve(error)) / 3.0;
      ++result.judged;
    }
  }
  result.nees /= static_cast<double>(std::max<std::size_t>(1, result.judged));
  return result;
}

std::string describe(const WorldError& error) {
  return fmt::format(
      "world        {:.3f} m level (rmse; at most {:.3f}), {:.3f} m in height (at most {:.3f}), of "
      "{} "
      "sweeps, not aligned\n"
      "             on average {:+.3f} m east, {:+.3f} m north, {:+.3f} m up; NEES of {} "
      "keyframes' "
      "positions {:.2f}\n",
      error.horizontal.rmse, error.horizontal.max, error.vertical.rmse, error.vertical.max,
      error.horizontal.count, error.mean.x(), error.mean.y(), error.mean.z(), error.judged,
      error.nees);
}

nlohmann::ordered_json to_json(const WorldError& error) {
  return {{"sweeps", error.horizontal.count},
          {"horizontal_rmse_m", error.horizontal.rmse},
          {"horizontal_max_m", error.horizontal.max},
          {"vertical_rmse_m", error.vertical.rmse},
          {"vertical_max_m", error.vertical.max},
          {"mean_m", {error.mean.x(), error.mean.y(), error.mean.z()}},
          {"nees", error.nees},
          {"nees_keyframes", error.judged}};
}

}  // namespace adit
