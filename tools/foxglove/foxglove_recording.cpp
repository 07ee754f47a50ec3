// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/foxglove/foxglove_recording.hpp"

#include <algorithm>
#include <compare>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "adit/tools/clouds/ply_visit.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/foxglove/foxglove_layout.hpp"
#include "adit/tools/foxglove/foxglove_types.hpp"
#include "adit/tools/foxglove/shown_run.hpp"
#include "adit/tools/foxglove/sweep_message.hpp"
#include "adit/tools/maps/map_trajectory.hpp"
#include "adit/tools/maps/tiled_cloud.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/results/page_cloud.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostOverviewPoints = 500'000;
constexpr float kFarthestShown = 1e8F;  // m: no sensor was there
constexpr const char* kMapFrame = "map";
constexpr const char* kLidarFrame = "lidar";
constexpr const char* kWorldFrame = "world";

/// What a message is of; in the order of those with the same stamp.
enum class Shown { event, pose, sweep, fix, keyframe };

/// A message that is to be written: which of its kind.
struct Moment {
  Nanoseconds stamp{0};
  Shown what = Shown::event;
  std::size_t index = 0;
  auto operator<=>(const Moment&) const = default;
};

std::vector<Moment> moments_of(const ShownRun& run) {
  std::vector<Moment> moments;
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
std::vector<Point> overview_of(const ShownRun& run, std::ostream& progress) {
  PageCloud cloud(kMostOverviewPoints);
  const auto add = [&](const std::vector<Point>& points) {
    cloud.add(points, Eigen::Isometry3d::Identity(), 0);
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

/// Topics of an MCAP file, each declared with its first message.
class TopicWriter {
 public:
  TopicWriter(const fs::path& file, Compression compression)
      : types_(foxglove_types()), writer_(file, {.compression = compression}) {
    types_.push_back(sweep_message_type());
  }

  void write(const std::string& topic, const std::string& type, Nanoseconds stamp,
             const ProtobufMessage& message) {
    const auto known = channels_.find(topic);
    std::size_t number = 0;
    if (known == channels_.end()) {
      number = writer_.add_channel(topic, protobuf_mcap_schema(types_, type));
      channels_.emplace(topic, number);
      topics_.push_back({.topic = topic, .type = type});
    } else {
      number = known->second;
    }
    ++topics_[number].messages;
    writer_.write(number, stamp, message.content());
  }

  std::vector<FoxgloveTopic> close() {
    writer_.close();
    return std::move(topics_);
  }

 private:
  std::vector<ProtobufMessageType> types_;
  McapWriter writer_;
  std::map<std::string, std::size_t> channels_;
  std::vector<FoxgloveTopic> topics_;
};

/// Writes the messages of a run one after the other.
class RunShower {
 public:
  RunShower(const ShownRun& run, TopicWriter& topics) : run_(&run), topics_(&topics) {
    if (!run.map.empty()) {
      map_.emplace(run.map, MapAccess::read);
    }
    if (run.georeference) {
      world_.emplace(run.georeference->origin);
    }
  }

  /// What holds all the time.
  void begin(Nanoseconds stamp, std::span<const Point> overview) {
    if (run_->georeference) {
      topics_->write(
          "/tf_static", "foxglove.FrameTransform", stamp,
          frame_transform(stamp, kWorldFrame, kMapFrame, run_->georeference->T_world_map));
    }
    draw(stamp, shown_trajectory(run_->poses, run_->parts));
    if (map_) {
      for (const ShownPart& part : shown_graph(*map_)) {
        draw(stamp, part);
      }
    }
    if (!overview.empty()) {
      topics_->write("/map/points", "foxglove.PointCloud", stamp,
                     point_cloud(stamp, kMapFrame, map_ ? "moving" : "intensity", overview));
    }
  }

  void show(const Moment& moment) {
    switch (moment.what) {
      case Shown::event: {
        const ShownEvent& event = run_->events[moment.index];
        topics_->write("/log", "foxglove.Log", event.stamp,
                       log_message(event.stamp, event.level, event.text));
        return;
      }
      case Shown::pose:
        show(run_->poses[moment.index]);
        return;
      case Shown::sweep:
        topics_->write("/sweep", "adit.Sweep", moment.stamp,
                       sweep_message(run_->sweeps[moment.index]));
        return;
      case Shown::fix:
        show(run_->fixes[moment.index]);
        return;
      case Shown::keyframe:
        show(run_->keyframes[moment.index]);
        return;
    }
  }

 private:
  void draw(Nanoseconds stamp, const ShownPart& part) {
    topics_->write(part.topic, "foxglove.SceneUpdate", stamp,
                   scene_update(stamp, kMapFrame, part.entity));
  }

  void show(const StampedPose& pose) {
    topics_->write("/tf", "foxglove.FrameTransform", pose.stamp,
                   frame_transform(pose.stamp, kMapFrame, kLidarFrame, pose.pose));
    topics_->write("/pose", "foxglove.PoseInFrame", pose.stamp,
                   pose_in_frame(pose.stamp, kMapFrame, pose.pose));
    if (world_) {
      const Eigen::Vector3d place = run_->georeference->T_world_map * pose.pose.translation();
      topics_->write(
          "/gnss/pose", "foxglove.LocationFix", pose.stamp,
          location_fix(
              {.stamp = pose.stamp, .frame = kLidarFrame, .place = world_->place_of(place)}));
    }
  }

  void show(const MapFix& fix) {
    topics_->write("/gnss/fix", "foxglove.LocationFix", fix.stamp,
                   location_fix({.stamp = fix.stamp,
                                 .frame = "",
                                 .place = fix.place,
                                 .covariance = fix.covariance,
                                 .colour = colour_of_fix(fix.verdict),
                                 .metadata = {{"verdict", std::string(to_string(fix.verdict))}}}));
  }

  void show(const MapKeyframe& keyframe) {
    const KeyframeSubmap submap = load_submap(*map_, keyframe.id, run_->map);
    topics_->write("/keyframe/points", "foxglove.PointCloud", keyframe.stamp,
                   point_cloud(keyframe.stamp, kMapFrame, "moving",
                               shown_points(points_of_keyframe(keyframe, submap, {}, {}))));
  }

  const ShownRun* run_;
  TopicWriter* topics_;
  std::optional<MapDatabase> map_;
  std::optional<WorldFrame> world_;
};

LayoutSubject subject_of(const ShownRun& run) {
  LayoutSubject subject{.has_sweeps = !run.sweeps.empty(),
                        .has_places = run.georeference.has_value() || !run.fixes.empty()};
  for (const StampedPose& pose : run.poses) {
    subject.way.extend(Eigen::Vector3d(pose.pose.translation()));
  }
  return subject;
}

fs::path layout_beside(fs::path output) {
  return output.replace_extension(".foxglove.json");
}

void check_output(const FoxgloveOptions& options, const ShownRun& run) {
  for (const fs::path& kept : {options.input, run.map, run.cloud, run.recording}) {
    for (const fs::path& written : {options.output, layout_beside(options.output)}) {
      keep_input("OUT", written, kept);
    }
  }
}

}  // namespace

FoxgloveReport write_foxglove(const FoxgloveOptions& options, std::ostream& progress) {
  if (options.output.extension() != ".mcap") {
    throw UsageError(options.output.string() + ": --as foxglove writes MCAP. Name it NAME.mcap.");
  }
  const ShownRun run = read_shown_run(options.input);
  check_output(options, run);
  const std::vector<Moment> moments = moments_of(run);
  Draft draft(options.output);
  TopicWriter topics(draft.path(), options.compression);
  RunShower shower(run, topics);
  shower.begin(moments.front().stamp, overview_of(run, progress));
  Progress bar(progress, progress_style_of_stderr(), "write", moments.size(),
               Progress::Clock::now(), "messages");
  for (std::size_t i = 0; i < moments.size(); ++i) {
    shower.show(moments[i]);
    bar.update(i + 1, 0);
  }
  bar.finish();
  FoxgloveReport report{.topics = topics.close(), .layout = layout_beside(options.output)};
  draft.take_its_place();
  write_text_file(report.layout, foxglove_layout(subject_of(run)));
  return report;
}

}  // namespace adit
