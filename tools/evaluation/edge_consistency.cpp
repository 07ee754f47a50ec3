// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/edge_consistency.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tools/evaluation/true_keyframes.hpp"

namespace adit {
namespace {

/// Squared error of three of the directions, the others being whatever they are.
double squared(const Matrix6d& covariance, const Vector6d& error, int at) {
  const Eigen::Vector3d part = error.segment<3>(at);
  return part.dot(covariance.block<3, 3>(at, at).ldlt().solve(part));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

std::optional<EdgeConsistency> edge_consistency(const std::filesystem::path& map_file,
                                                const Trajectory& truth) {
  const MapDatabase map(map_file, MapAccess::read);
  const std::map<NodeId, TrueKeyframe> keyframes = true_keyframes(map, map_file, truth);
  EdgeConsistency found;
  std::vector<double> all;
  const PoseGraph graph = map.graph();
  for (const PoseEdge& edge : graph.edges()) {
    const auto from = keyframes.find(edge.from);
    const auto to = keyframes.find(edge.to);
    if (edge.kind != EdgeKind::odometry || from == keyframes.end() || to == keyframes.end()) {
      continue;
    }
    const Eigen::Isometry3d off =
        edge.T_from_to.inverse() *
        (from->second.T_world_keyframe.inverse() * to->second.T_world_keyframe);
    Vector6d error;
    error << off.translation(), so3_log(off.linear());
    const Matrix6d covariance = symmetric_inverse(edge.information);
    all.push_back(error.dot(edge.information * error) / 6.0);
    found.nees += all.back();
    found.translation += squared(covariance, error, 0) / 3.0;
    found.rotation += squared(covariance, error, 3) / 3.0;
    found.rms_translation += error.head<3>().squaredNorm();
    found.rms_rotation += error.tail<3>().squaredNorm();
  }
  if (all.empty()) {
    return std::nullopt;
  }
  found.edges = all.size();
  const auto count = static_cast<double>(all.size());
  found.nees /= count;
  found.translation /= count;
  found.rotation /= count;
  found.rms_translation = std::sqrt(found.rms_translation / count);
  found.rms_rotation = std::sqrt(found.rms_rotation / count);
  found.median = median(std::move(all));
  return found;
}

std::string describe(const EdgeConsistency& found) {
  return fmt::format(
      "edges        {} between consecutive keyframes, off by {:.1f} mm, {:.2f} degrees (rms); "
      "squared error {:.2f} per degree of freedom (NEES; 1: as they promise; median {:.2f}, "
      "translation {:.2f}, rotation {:.2f})\n",
      found.edges, 1000.0 * found.rms_translation, found.rms_rotation * kDegreesPerRadian,
      found.nees, found.median, found.translation, found.rotation);
}

nlohmann::ordered_json to_json(const EdgeConsistency& found) {
  return {{"edges", found.edges},
          {"nees_per_degree",
           {{"mean", found.nees},
            {"median", found.median},
            {"translation", found.translation},
            {"rotation", found.rotation}}},
          {"rms_m", found.rms_translation},
          {"rms_rad", found.rms_rotation}};
}

}  // namespace adit
