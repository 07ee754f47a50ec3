// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/live_scene.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/support/version.hpp"
#include "adit/tools/viewer/view_access.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMostPoses = 4096;
constexpr std::size_t kMostClouds = 512;
constexpr std::size_t kNewest = 8;        // sweeps that can still be asked for
constexpr uint32_t kSweepBit = 1U << 31;  // in numbers of sweeps; those of keyframes are lower
constexpr double kHalfEdge = 100.0;       // m, of the cube that an empty scene is given
constexpr double kMovedBy = 1e-3;         // m or rad; what moves by less is not told anew

ViewText shared_text(const ordered_json& json) {
  return std::make_shared<const std::string>(text_of(json));
}

ordered_json empty_scene(const std::string& title) {
  const ordered_json none = ordered_json::array();
  return {{"type", "scene"},
          {"live", true},
          {"run", make_token()},  // so that no other run is taken for this one
          {"program", std::string(kGenerator)},
          {"title", title},
          {"editable", false},
          {"intensity", false},
          {"start_ns", "0"},
          {"seconds", 0.0},
          {"points", 0},
          {"keyframes_told", 0},
          {"cube",
           {{"low", {-kHalfEdge, -kHalfEdge, -kHalfEdge}},
            {"edge", 2.0 * kHalfEdge},
            {"cells", kTileCells}}},
          {"tiles", {{"parent", none}, {"octant", none}, {"points", none}}},
          {"tiled_poses", none},
          {"sweeps", {{"time", none}, {"keyframe", none}, {"pose", none}}},
          {"plots", LivePlots::nothing()},
          {"weak", {{"sweep", none}, {"axis", none}, {"none", none}}},
          {"sources", none}};
}

bool is_elsewhere(const Eigen::Isometry3d& now, const Eigen::Isometry3d& before) {
  return (now.translation() - before.translation()).norm() > kMovedBy ||
         (now.linear() - before.linear()).norm() > kMovedBy;
}

ordered_json stretches_of(const std::vector<LiveStretch>& stretches, const ViewSpan& span) {
  ordered_json list = ordered_json::array();
  for (const LiveStretch& stretch : stretches) {
    list.push_back({{"state", stretch.state},
                    {"begin", span.seconds_of(stretch.begin)},
                    {"end", span.seconds_of(stretch.end)},
                    {"text", stretch.text}});
  }
  return list;
}

/// Leaves every second element, from the first.
template <class T>
void halve(std::vector<T>& list) {
  const std::size_t kept = (list.size() + 1) / 2;
  for (std::size_t i = 1; i < kept; ++i) {  // the first is where it is to be
    list[i] = std::move(list[2 * i]);
  }
  list.erase(list.begin() + static_cast<std::ptrdiff_t>(kept), list.end());
}

}  // namespace

LiveGraph LiveGraphReader::read(const std::filesystem::path& map, const ViewSpan& span) {
  const MapDatabase database(map, MapAccess::read);
  LiveGraph graph{.json = text_of(graph_of(database, span)), .parts = shown_graph(database)};
  for (const MapKeyframe& keyframe : database.keyframes()) {
    auto known = T_keyframe_first_.find(keyframe.id);
    if (known == T_keyframe_first_.end()) {
      const auto sweeps = load_sweeps(database, keyframe.id, map).sweeps;
      known = T_keyframe_first_
                  .emplace(keyframe.id, sweeps.empty() ? Eigen::Isometry3d::Identity()
                                                       : sweeps.front().T_keyframe_lidar)
                  .first;
    }
    graph.T_map_first.emplace(keyframe.id, keyframe.T_map_keyframe * known->second);
  }
  return graph;
}

LiveScene::LiveScene(const std::string& title)
    : scene_(shared_text(empty_scene(title))), graph_(shared_text(no_graph())) {}

/// Returns whether it is elsewhere than before.
bool LiveScene::place(Placed& placed) const {
  const auto first = placed.keyframe ? T_map_first_.find(*placed.keyframe) : T_map_first_.end();
  if (first == T_map_first_.end()) {
    return false;
  }
  const Eigen::Isometry3d before = placed.T_map_lidar;
  placed.T_map_lidar = first->second * placed.T_first_lidar;
  return is_elsewhere(placed.T_map_lidar, before);
}

void LiveScene::add(LiveSweep sweep) {
  ++version_;
  if (sweeps_ == 0) {
    span_.first = sweep.stamp;
  }
  span_.last = std::max(sweep.stamp, span_.first);
  if (sweep.progress.stretches != progress_.stretches) {
    versions_.stretches = version_;
  }
  has_intensity_ = sweep.has_intensity;
  progress_ = std::move(sweep.progress);
  plots_.add(sweep.record, span_.seconds_of(sweep.stamp), version_);
  Placed placed{.keyframe = sweep.keyframe,
                .T_first_lidar = sweep.T_first_lidar,
                .T_map_lidar = sweep.T_map_lidar};
  place(placed);
  if (sweeps_ % stride_ == 0) {
    add_pose({.placed = placed, .stamp = sweep.stamp, .version = version_});
  }
  if (sweep.keyframe_cloud) {
    add_cloud({.number = static_cast<uint32_t>(keyframes_) & ~kSweepBit,
               .placed = placed,
               .cloud = std::move(*sweep.keyframe_cloud),
               .stamp = sweep.stamp,
               .version = version_});
  }
  newest_.push_back({.shown = {.number = kSweepBit | (static_cast<uint32_t>(sweeps_) & ~kSweepBit),
                               .placed = placed,
                               .cloud = std::move(sweep.points),
                               .stamp = sweep.stamp,
                               .version = version_},
                     .record = std::move(sweep.record)});
  if (newest_.size() > kNewest) {
    newest_.pop_front();
  }
  ++sweeps_;
}

void LiveScene::add_pose(const Pose& pose) {
  poses_.push_back(pose);
  if (poses_.size() > kMostPoses) {
    halve(poses_);
    stride_ *= 2;
    versions_.poses = version_;
  }
}

void LiveScene::add_cloud(Numbered cloud) {
  if (keyframes_ % cloud_stride_ == 0) {
    clouds_.push_back(std::move(cloud));
    versions_.clouds = version_;
  }
  ++keyframes_;
  if (clouds_.size() > kMostClouds) {
    halve(clouds_);
    cloud_stride_ *= 2;
  }
}

void LiveScene::set(const LiveGraph& graph) {
  ++version_;
  graph_ = std::make_shared<const std::string>(graph.json);
  graph_parts_ = graph.parts;
  versions_.graph = version_;
  T_map_first_ = graph.T_map_first;
  for (Pose& pose : poses_) {
    if (place(pose.placed)) {
      versions_.poses = version_;
    }
  }
  for (Numbered& cloud : clouds_) {
    if (place(cloud.placed)) {
      versions_.clouds = version_;
    }
  }
  for (Newest& sweep : newest_) {
    place(sweep.shown.placed);
  }
}

void LiveScene::set_doing(const std::string& doing) {
  ++version_;
  versions_.doing = version_;
  doing_ = doing;
}

ViewNews LiveScene::news(uint64_t told) const {
  ViewNews news{.told = version_};
  if (told >= version_) {
    return news;
  }
  if (told == 0) {
    news.texts.push_back(scene_);
  }
  if (told < versions_.graph) {
    news.texts.push_back(graph_);
  }
  news.texts.push_back(std::make_shared<const std::string>(text_since(told)));
  return news;
}

std::string LiveScene::text_since(uint64_t told) const {
  const auto first =
      told < versions_.poses
          ? poses_.begin()
          : std::ranges::find_if(poses_, [&](const Pose& pose) { return pose.version > told; });
  std::vector<ViewSweep> added;
  for (auto pose = first; pose != poses_.end(); ++pose) {
    added.push_back({.stamp = pose->stamp, .T_keyframe_lidar = pose->placed.T_map_lidar});
  }
  ordered_json json = {{"type", "live"},
                       {"doing", doing_},
                       {"intensity", has_intensity_},
                       {"seconds", span_.seconds_of(span_.last)},
                       {"progress",
                        {{"sweeps", progress_.sweeps},
                         {"of", progress_.of},
                         {"failed", progress_.failed},
                         {"verdict", progress_.verdict}}},
                       {"sources", to_json(progress_.sources)},
                       {"from", first - poses_.begin()},
                       {"sweeps", json_of(added, span_)}};
  const auto clouds_json = [this](const auto& list) {
    ordered_json numbers = ordered_json::array();
    ordered_json edges = ordered_json::array();
    ordered_json times = ordered_json::array();
    std::vector<Eigen::Isometry3d> poses;
    for (const Numbered& one : list) {
      numbers.push_back(one.number);
      edges.push_back(one.cloud.edge);
      times.push_back(span_.seconds_of(one.stamp));
      poses.push_back(one.placed.T_map_lidar);
    }
    return ordered_json(
        {{"number", numbers}, {"edge", edges}, {"time", times}, {"pose", poses_of(poses)}});
  };
  if (!newest_.empty()) {
    json["newest"] = clouds_json(std::array{std::cref(newest_.back().shown)});
  }
  if (told < versions_.clouds) {
    json["clouds"] = clouds_json(clouds_);
  }
  if (ordered_json plots = plots_.since(told); !plots.is_null()) {
    json["plots"] = std::move(plots);
  }
  if (told < versions_.stretches) {
    json["stretches"] = stretches_of(progress_.stretches, span_);
  }
  return text_of(json);
}

std::string LiveScene::tile(uint32_t number) const {
  std::span<const TilePoint> points;
  if ((number & kSweepBit) != 0) {
    const auto found =
        std::ranges::find(newest_, number, [](const Newest& sweep) { return sweep.shown.number; });
    points = found == newest_.end() ? points : found->shown.cloud.points;
  } else {
    const auto found = std::ranges::find(clouds_, number, &Numbered::number);
    points = found == clouds_.end() ? points : found->cloud.points;
  }
  return tile_message(number, points);
}

}  // namespace adit
