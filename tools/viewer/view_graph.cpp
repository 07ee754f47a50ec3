// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_graph.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <nlohmann/json.hpp>

#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_database/odometry_chain.hpp"
#include "adit/tools/viewer/view_world.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMostSweeps = 65'535;
constexpr double kLastMoment = 65'535.0;

/// Rounded: a page draws no finer, and digits are bytes. Null where it is no number.
ordered_json rounded(double value, double unit) {
  return std::isfinite(value) ? ordered_json(std::round(value / unit) * unit) : ordered_json();
}
ordered_json length(double metres) {
  return rounded(metres, 1e-4);
}

/// x, y, z (m) and the quaternion x, y, z, w, one after the other.
void append_pose(ordered_json& list, const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  for (int k = 0; k < 3; ++k) {
    list.push_back(length(pose.translation()[k]));
  }
  for (const double part : {q.x(), q.y(), q.z(), q.w()}) {
    list.push_back(rounded(part, 1e-7));
  }
}

void append_covariance(ordered_json& list, const MapKeyframe& keyframe) {
  const Eigen::Matrix3d R = keyframe.T_map_keyframe.linear();
  const Eigen::Matrix3d in_map = R * keyframe.covariance.topLeftCorner<3, 3>() * R.transpose();
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      list.push_back(rounded(in_map(row, column), 1e-9));
    }
  }
}

using Positions = std::unordered_map<NodeId, int64_t>;

Positions positions_of(const std::vector<MapKeyframe>& keyframes) {
  Positions positions;
  for (const MapKeyframe& keyframe : keyframes) {
    positions.emplace(keyframe.id, static_cast<int64_t>(positions.size()));
  }
  return positions;
}

int64_t at(const Positions& positions, NodeId id) {
  const auto found = positions.find(id);
  return found == positions.end() ? -1 : found->second;
}

ordered_json json_of(const LoopCandidate& loop, const Positions& positions) {
  return {{"id", loop.id},
          {"from", at(positions, loop.from)},
          {"to", at(positions, loop.to)},
          {"verdict", to_string(loop.verdict)},
          {"reason", loop.reason},
          {"figure", rounded(loop.figure, 1e-6)},
          {"overlap", rounded(loop.overlap, 1e-4)},
          {"rms", length(loop.rms)},
          {"correction", length(loop.correction)},
          {"turn", rounded(loop.turn, 1e-6)},
          {"through", rounded(loop.through, 1e-4)},
          {"found_by", to_string(loop.source)},
          {"chi2", rounded(loop.chi2, 1e-4)},
          {"pose", poses_of(std::vector{loop.T_from_to})}};
}

ordered_json fixes_of(const MapDatabase& map, const ViewSpan& span, const Positions& positions) {
  ordered_json list = ordered_json::array();
  const std::optional<Georeference> earth = map.georeference();
  if (!earth) {
    return list;
  }
  const WorldFrame world(earth->origin);
  const Eigen::Isometry3d T_map_world = earth->T_world_map.inverse();
  for (const MapFix& fix : map.fixes()) {
    if (fix.verdict == FixVerdict::impossible) {
      continue;  // it is nowhere
    }
    const Eigen::Vector3d p = T_map_world * world.position_of(fix.place);
    list.push_back({{"keyframe", at(positions, fix.keyframe)},
                    {"time", rounded(span.seconds_of(fix.stamp), 1e-3)},
                    {"p", {length(p.x()), length(p.y()), length(p.z())}},
                    {"verdict", to_string(fix.verdict)},
                    {"sigma", length(std::sqrt(fix.covariance.trace() / 3.0))},
                    {"chi2", rounded(fix.chi2, 1e-3)}});
  }
  return list;
}

ordered_json json_of(const std::optional<ViewTruth>& truth,
                     const std::vector<MapKeyframe>& keyframes) {
  if (!truth) {
    return nullptr;
  }
  ordered_json errors = ordered_json::array();
  for (const MapKeyframe& keyframe : keyframes) {
    const auto found = truth->errors.find(keyframe.id);
    errors.push_back(found == truth->errors.end() ? ordered_json() : length(found->second));
  }
  ordered_json path = ordered_json::array();
  for (std::size_t i = 0; i < truth->path.size(); i += stride_of(truth->path.size())) {
    for (int k = 0; k < 3; ++k) {
      path.push_back(length(truth->path[i][k]));
    }
  }
  return {{"error", errors}, {"path", path}};
}

}  // namespace

uint16_t ViewSpan::moment_of(Nanoseconds stamp) const {
  const double all = seconds(last - first);
  const double share = all > 0.0 ? seconds_of(stamp) / all : 0.0;
  return static_cast<uint16_t>(std::lround(kLastMoment * std::clamp(share, 0.0, 1.0)));
}

std::vector<ViewSweep> sweeps_of(const MapDatabase& map) {
  std::vector<ViewSweep> sweeps;
  int64_t position = 0;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    for (const SubmapSweep& sweep : load_sweeps(map, keyframe.id, map.file()).sweeps) {
      sweeps.push_back(
          {.stamp = sweep.stamp, .keyframe = position, .T_keyframe_lidar = sweep.T_keyframe_lidar});
    }
    ++position;
  }
  return sweeps;
}

ordered_json poses_of(const std::vector<Eigen::Isometry3d>& poses) {
  ordered_json list = ordered_json::array();
  for (const Eigen::Isometry3d& pose : poses) {
    append_pose(list, pose);
  }
  return list;
}

ordered_json poses_of(const std::vector<MapKeyframe>& keyframes) {
  ordered_json list = ordered_json::array();
  for (const MapKeyframe& keyframe : keyframes) {
    append_pose(list, keyframe.T_map_keyframe);
  }
  return list;
}

ordered_json no_graph() {
  const ordered_json none = ordered_json::array();
  return {{"type", "graph"},
          {"keyframes",
           {{"id", none},
            {"session", none},
            {"time", none},
            {"pose", none},
            {"odometry", none},
            {"covariance", none}}},
          {"edges", none},
          {"loops", none},
          {"fixes", none},
          {"truth", nullptr},
          {"world", nullptr}};
}

ordered_json graph_of(const MapDatabase& map, const ViewSpan& span,
                      const std::optional<ViewTruth>& truth) {
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  const PoseGraph graph = map.graph();
  const Positions positions = positions_of(keyframes);
  ordered_json ids = ordered_json::array();
  ordered_json sessions = ordered_json::array();
  ordered_json times = ordered_json::array();
  ordered_json covariances = ordered_json::array();
  for (const MapKeyframe& keyframe : keyframes) {
    ids.push_back(keyframe.id);
    sessions.push_back(keyframe.session);
    times.push_back(rounded(span.seconds_of(keyframe.stamp), 1e-3));
    append_covariance(covariances, keyframe);
  }
  ordered_json edges = ordered_json::array();
  for (const PoseEdge& edge : graph.edges()) {
    edges.push_back({at(positions, edge.from), at(positions, edge.to), to_string(edge.kind),
                     to_string(edge.status)});
  }
  ordered_json loops = ordered_json::array();
  for (const LoopCandidate& loop : map.candidates()) {
    loops.push_back(json_of(loop, positions));
  }
  return {{"type", "graph"},
          {"keyframes",
           {{"id", ids},
            {"session", sessions},
            {"time", times},
            {"pose", poses_of(keyframes)},
            {"odometry", poses_of(odometry_chain(keyframes, graph))},
            {"covariance", covariances}}},
          {"edges", edges},
          {"loops", loops},
          {"fixes", fixes_of(map, span, positions)},
          {"truth", json_of(truth, keyframes)},
          {"world", world_of(map.georeference())}};
}

std::size_t stride_of(std::size_t sweeps) {
  return std::max<std::size_t>(1, (sweeps + kMostSweeps - 1) / kMostSweeps);
}

ordered_json json_of(const std::vector<ViewSweep>& sweeps, const ViewSpan& span) {
  const std::size_t stride = stride_of(sweeps.size());
  ordered_json times = ordered_json::array();
  ordered_json keyframes = ordered_json::array();
  ordered_json poses = ordered_json::array();
  for (std::size_t i = 0; i < sweeps.size(); i += stride) {
    times.push_back(rounded(span.seconds_of(sweeps[i].stamp), 1e-3));
    keyframes.push_back(sweeps[i].keyframe);
    append_pose(poses, sweeps[i].T_keyframe_lidar);
  }
  return {{"time", times}, {"keyframe", keyframes}, {"pose", poses}};
}

std::string text_of(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace adit
