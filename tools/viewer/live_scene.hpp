// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a page is told of a run that goes on, as JSON: tools/viewer/page/protocol.ts is the other
// side. Its size is bounded, however long the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "adit/tools/foxglove/foxglove_graph.hpp"
#include "adit/tools/viewer/live_plots.hpp"
#include "adit/tools/viewer/live_sweep.hpp"
#include "adit/tools/viewer/view_graph.hpp"
#include "adit/tools/viewer/view_server.hpp"

namespace adit {

/// The graph of a map that is being written, as it was stored by then.
struct LiveGraph {
  std::string json{};              ///< as graph_of() has it
  std::vector<ShownPart> parts{};  ///< the same for Foxglove
  /// Poses of the keyframes' first sweeps in the map.
  std::map<NodeId, Eigen::Isometry3d> T_map_first{};
};

/// Reads it beside the writer, each time what is new.
class LiveGraphReader {
 public:
  /// Throws InputError and OutputError where it cannot be read.
  LiveGraph read(const std::filesystem::path& map, const ViewSpan& span);

 private:
  /// Rotation of the first sweep in its keyframe's axes, which gravity levels.
  std::map<NodeId, Eigen::Isometry3d> T_keyframe_first_;
};

class LiveScene {
 public:
  /// Of a sensor when it was placed, and where it is now.
  struct Placed {
    std::optional<NodeId> keyframe{};
    Eigen::Isometry3d T_first_lidar = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  };
  struct Pose {
    Placed placed{};
    Nanoseconds stamp{0};
    uint64_t version = 0;  ///< that it came with
  };
  struct Numbered {
    uint32_t number = 0;
    Placed placed{};
    SensorCloud cloud{};
    Nanoseconds stamp{0};
    uint64_t version = 0;  ///< that it came with
  };
  struct Newest {
    Numbered shown{};
    SweepRecord record{};
  };
  /// Versions since which parts of it are as they are.
  struct Versions {
    uint64_t doing = 1;
    uint64_t graph = 1;
    uint64_t poses = 1;   ///< all of the trajectory, but for poses that were added
    uint64_t clouds = 1;  ///< likewise
    uint64_t stretches = 1;
  };

  /// `title`: what is mapped.
  explicit LiveScene(const std::string& title);

  void add(LiveSweep sweep);
  /// Keyframes that have moved take their sweeps with them.
  void set(const LiveGraph& graph);
  /// In words, what the run is doing.
  void set_doing(const std::string& doing);

  /// From the first sweep to the newest.
  const ViewSpan& span() const { return span_; }
  /// Counts what has changed.
  uint64_t version() const { return version_; }
  /// What has changed since the version `told`; all of it for 0.
  ViewNews news(uint64_t told) const;
  /// Points of the newest sweeps, or of a keyframe, by the numbers that news() names; with the
  /// layout of ViewData::tile(). Without points where it is there no more.
  std::string tile(uint32_t number) const;

  const Versions& versions() const { return versions_; }
  const std::string& doing() const { return doing_; }
  const std::vector<ShownPart>& graph_parts() const { return graph_parts_; }
  /// Some of the sweeps' poses, evenly chosen.
  const std::vector<Pose>& poses() const { return poses_; }
  /// Likewise of the keyframes' clouds.
  const std::vector<Numbered>& clouds() const { return clouds_; }
  /// The last few.
  const std::deque<Newest>& newest() const { return newest_; }

 private:
  std::string text_since(uint64_t told) const;
  void add_pose(const Pose& pose);
  void add_cloud(Numbered cloud);
  bool place(Placed& placed) const;

  ViewText scene_;
  ViewText graph_;
  std::vector<ShownPart> graph_parts_;
  std::map<NodeId, Eigen::Isometry3d> T_map_first_;
  ViewSpan span_;
  std::size_t sweeps_ = 0;
  std::size_t stride_ = 1;  ///< of sweeps, one is in the trajectory
  std::vector<Pose> poses_;
  std::size_t keyframes_ = 0;
  std::size_t cloud_stride_ = 1;  ///< of keyframes, one has points
  std::vector<Numbered> clouds_;
  std::deque<Newest> newest_;
  bool has_intensity_ = false;
  LiveProgress progress_{};
  LivePlots plots_;
  std::string doing_ = "starting";
  uint64_t version_ = 1;
  Versions versions_;
};

}  // namespace adit
