// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/foxglove/shown_messages.hpp"

#include <algorithm>
#include <ostream>
#include <span>
#include <utility>

#include "adit/tools/clouds/ply_visit.hpp"
#include "adit/tools/foxglove/foxglove_types.hpp"
#include "adit/tools/foxglove/sweep_message.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_products/tiled_cloud.hpp"
#include "adit/tools/results/page_cloud.hpp"
#include "adit/tools/support/progress.hpp"

namespace adit {
namespace {

constexpr std::size_t kMostOverviewPoints = 500'000;
constexpr float kFarthestShown = 1e8F;  // m: no sensor was there
const ShownTopic kWorldTransformTopic{"/tf_static", "foxglove.FrameTransform"};
const ShownTopic kPlaceTopic{"/gnss/pose", "foxglove.LocationFix"};
const ShownTopic kFixTopic{"/gnss/fix", "foxglove.LocationFix"};

std::vector<ShownMoment> moments_of(const ShownRun& run) {
  std::vector<ShownMoment> moments;
  const auto add = [&](Shown what, const auto& all) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      moments.push_back({.stamp = all[i].stamp, .what = what, .index = i});
    }
  };
  add(Shown::event, run.events);
  add(Shown::pose, run.poses);
  add(Shown::sweep, run.sweeps);
  add(Shown::fix, run.fixes);
  add(Shown::keyframe, run.keyframes);
  std::ranges::sort(moments);
  return moments;
}

bool is_shown(const Point& point) {
  const Eigen::Vector3f p(point.x, point.y, point.z);
  return p.allFinite() && p.cwiseAbs().maxCoeff() < kFarthestShown;
}

/// Points of a map, map frame; 1 in the place of the intensity where they move.
std::vector<Point> shown_points(std::span<const CloudPoint> cloud) {
  std::vector<Point> points;
  points.reserve(cloud.size());
  for (const CloudPoint& point : cloud) {
    const Eigen::Vector3f p = point.position.cast<float>();
    points.push_back({.x = p.x(), .y = p.y(), .z = p.z(), .intensity = point.moving ? 1.0F : 0.0F});
  }
  std::erase_if(points, [](const Point& point) { return !is_shown(point); });
  return points;
}

/// The whole cloud of bounded size.
/// Ends the reading of a cloud.
struct OverviewStopped {};

void read_overview(const ShownRun& run, std::ostream& progress, const std::stop_token& stop,
                   PageCloud& cloud) {
  const auto add = [&](const std::vector<Point>& points) {
    cloud.add(points, Eigen::Isometry3d::Identity(), 0);
    if (stop.stop_requested()) {
      throw OverviewStopped();
    }
  };
  if (!run.map.empty()) {
    const MapDatabase map(run.map, MapAccess::read);
    Progress bar(progress, progress_style_of_stderr(), "thin", run.keyframes.size(),
                 Progress::Clock::now(), "keyframes");
    std::size_t done = 0;
    visit_cloud(map, {}, {}, [&](std::span<const CloudPoint> points) {
      add(shown_points(points));
      bar.update(++done, 0);
    });
    bar.finish();
  } else if (!run.cloud.empty()) {
    const WrittenPly ply(run.cloud);
    Progress bar(progress, progress_style_of_stderr(), "thin", ply.points(), Progress::Clock::now(),
                 "points");
    std::size_t done = 0;
    ply.visit([&](std::span<const Point> points) {
      std::vector<Point> sound(points.begin(), points.end());
      std::erase_if(sound, [](const Point& point) { return !is_shown(point); });
      add(sound);
      bar.update(done += points.size(), 0);
    });
    bar.finish();
  }
}

std::vector<Point> overview_of(const ShownRun& run, std::ostream& progress,
                               const std::stop_token& stop) {
  PageCloud cloud(kMostOverviewPoints);
  try {
    read_overview(run, progress, stop, cloud);
  } catch (const OverviewStopped&) {
  }
  std::vector<Point> points;
  for (const SeenFrom& point : cloud.points()) {
    points.push_back(
        {.x = point.p.x(), .y = point.p.y(), .z = point.p.z(), .intensity = point.intensity});
  }
  return points;
}

ShownColour colour_of_fix(FixVerdict verdict) {
  switch (verdict) {
    case FixVerdict::used:
    case FixVerdict::thinned:
      return {.r = 0.2, .g = 0.9, .b = 0.3, .a = 1.0};
    case FixVerdict::outlier:
    case FixVerdict::frozen:
      return {.r = 0.95, .g = 0.25, .b = 0.2, .a = 1.0};
    default:
      return {.r = 0.7, .g = 0.7, .b = 0.7, .a = 1.0};
  }
}

}  // namespace

std::vector<ProtobufMessageType> shown_types() {
  std::vector<ProtobufMessageType> types = foxglove_types();
  types.push_back(sweep_message_type());
  return types;
}

ShownMessage drawn_message(Nanoseconds stamp, const ShownPart& part) {
  return {.topic = {part.topic, kDrawnType},
          .stamp = stamp,
          .message = scene_update(stamp, kMapFrame, part.entity)};
}

ShownMessages::ShownMessages(ShownRun run) : run_(std::move(run)), moments_(moments_of(run_)) {
  if (!run_.map.empty()) {
    map_.emplace(run_.map, MapAccess::read);
  }
  if (run_.georeference) {
    world_.emplace(run_.georeference->origin);
  }
}

std::vector<ShownMessage> ShownMessages::graph() const {
  const Nanoseconds stamp = moments_.front().stamp;
  std::vector<ShownMessage> messages;
  if (run_.georeference) {
    messages.push_back(
        {kWorldTransformTopic, stamp,
         frame_transform(stamp, kWorldFrame, kMapFrame, run_.georeference->T_world_map)});
  }
  messages.push_back(drawn_message(stamp, shown_trajectory(run_.poses, run_.parts)));
  if (map_) {
    for (const ShownPart& part : shown_graph(*map_)) {
      messages.push_back(drawn_message(stamp, part));
    }
  }
  return messages;
}

ShownMessage ShownMessages::overview(std::ostream& progress, const std::stop_token& stop) const {
  const Nanoseconds stamp = moments_.front().stamp;
  return {kMapPointsTopic, stamp,
          point_cloud(stamp, kMapFrame, map_ ? "moving" : "intensity",
                      overview_of(run_, progress, stop))};
}

std::vector<ShownTopic> ShownMessages::topics_of(Shown what) const {
  switch (what) {
    case Shown::event:
      return {kLogTopic};
    case Shown::pose:
      return world_ ? std::vector{kPoseTransformTopic, kPoseTopic, kPlaceTopic}
                    : std::vector{kPoseTransformTopic, kPoseTopic};
    case Shown::sweep:
      return {kSweepTopic};
    case Shown::fix:
      return {kFixTopic};
    case Shown::keyframe:
      return {kKeyframePointsTopic};
  }
  return {};
}

std::vector<ShownMessage> ShownMessages::at(const ShownMoment& moment) const {
  const Nanoseconds stamp = moment.stamp;
  switch (moment.what) {
    case Shown::event: {
      const ShownEvent& event = run_.events[moment.index];
      return {{kLogTopic, stamp, log_message(stamp, event.level, event.text)}};
    }
    case Shown::pose:
      return pose_messages(run_.poses[moment.index]);
    case Shown::sweep:
      return {{kSweepTopic, stamp, sweep_message(run_.sweeps[moment.index])}};
    case Shown::fix: {
      const MapFix& fix = run_.fixes[moment.index];
      return {{kFixTopic, stamp,
               location_fix({.stamp = stamp,
                             .frame = "",
                             .place = fix.place,
                             .covariance = fix.covariance,
                             .colour = colour_of_fix(fix.verdict),
                             .metadata = {{"verdict", std::string(to_string(fix.verdict))}}})}};
    }
    case Shown::keyframe: {
      const MapKeyframe& keyframe = run_.keyframes[moment.index];
      const KeyframeSubmap submap = load_submap(*map_, keyframe.id, run_.map);
      return {{kKeyframePointsTopic, stamp,
               point_cloud(stamp, kMapFrame, "moving",
                           shown_points(points_of_keyframe(keyframe, submap, {}, {})))}};
    }
  }
  return {};
}

std::vector<ShownMessage> ShownMessages::pose_messages(const StampedPose& pose) const {
  std::vector<ShownMessage> messages = {
      {kPoseTransformTopic, pose.stamp,
       frame_transform(pose.stamp, kMapFrame, kLidarFrame, pose.pose)},
      {kPoseTopic, pose.stamp, pose_in_frame(pose.stamp, kMapFrame, pose.pose)}};
  if (world_) {
    const Eigen::Vector3d place = run_.georeference->T_world_map * pose.pose.translation();
    messages.push_back(
        {kPlaceTopic, pose.stamp,
         location_fix(
             {.stamp = pose.stamp, .frame = kLidarFrame, .place = world_->place_of(place)})});
  }
  return messages;
}

}  // namespace adit
