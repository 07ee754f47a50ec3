// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The messages that other viewers are shown of a run or a map; docs/viewing.md has the topics.
#pragma once

#include <compare>
#include <cstddef>
#include <iosfwd>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "adit/slam/gnss/world_frame.hpp"
#include "adit/tools/containers/protobuf_schema.hpp"
#include "adit/tools/foxglove/foxglove_messages.hpp"
#include "adit/tools/foxglove/foxglove_scene.hpp"
#include "adit/tools/foxglove/shown_run.hpp"

namespace adit {

inline constexpr const char* kMapFrame = "map";
inline constexpr const char* kLidarFrame = "lidar";
inline constexpr const char* kWorldFrame = "world";  ///< east, north, up

/// A topic with the name of its messages' type.
struct ShownTopic {
  std::string topic;
  std::string type;

  bool operator==(const ShownTopic&) const = default;
};
inline constexpr const char* kDrawnType = "foxglove.SceneUpdate";
inline const ShownTopic kPoseTransformTopic{"/tf", "foxglove.FrameTransform"};
inline const ShownTopic kPoseTopic{"/pose", "foxglove.PoseInFrame"};
inline const ShownTopic kSweepTopic{"/sweep", "adit.Sweep"};
inline const ShownTopic kMapPointsTopic{"/map/points", "foxglove.PointCloud"};
inline const ShownTopic kKeyframePointsTopic{"/keyframe/points", "foxglove.PointCloud"};
inline const ShownTopic kLogTopic{"/log", "foxglove.Log"};

/// The types of all topics, with what they are made of.
std::vector<ProtobufMessageType> shown_types();

struct ShownMessage {
  ShownTopic topic;
  Nanoseconds stamp{0};
  ProtobufMessage message;
};

/// What a message with a time of its own is of; in the order of those with the same stamp.
enum class Shown { event, pose, sweep, fix, keyframe };
inline constexpr int kShownKinds = 5;

/// When something is shown: which of its kind.
struct ShownMoment {
  Nanoseconds stamp{0};
  Shown what = Shown::event;
  std::size_t index = 0;
  auto operator<=>(const ShownMoment&) const = default;
};

/// Drawn in the map's frame.
ShownMessage drawn_message(Nanoseconds stamp, const ShownPart& part);

class ShownMessages {
 public:
  /// Throws InputError where the map cannot be opened.
  explicit ShownMessages(ShownRun run);

  const ShownRun& run() const { return run_; }

  /// What holds all the time, at the stamp of the first moment: the place on the Earth and the
  /// graph. Throws InputError.
  std::vector<ShownMessage> graph() const;
  /// The run has points, which overview() shows.
  bool has_points() const { return map_ || !run_.cloud.empty(); }
  /// The whole cloud thinned to at most 500 000 points, at the same stamp; of the part that was
  /// read by then once `stop` asks for it. May run beside all other functions. Throws InputError.
  ShownMessage overview(std::ostream& progress, const std::stop_token& stop = {}) const;

  /// In the order of their stamps; at least one.
  const std::vector<ShownMoment>& moments() const { return moments_; }
  /// The topics of each moment of that kind.
  std::vector<ShownTopic> topics_of(Shown what) const;
  /// A message for each of those topics, in their order. Throws InputError.
  std::vector<ShownMessage> at(const ShownMoment& moment) const;

 private:
  std::vector<ShownMessage> pose_messages(const StampedPose& pose) const;

  ShownRun run_;
  std::vector<ShownMoment> moments_;
  std::optional<MapDatabase> map_;
  std::optional<WorldFrame> world_;
};

}  // namespace adit
