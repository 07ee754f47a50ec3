// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Looks for the loops of a finished map anew, keyframe by keyframe as a run does, with drift put
// into the edges between its keyframes: how much of it the loops take out again. Then what the
// descriptor alone finds. A program by itself, built on request; what it does is no setting of
// adit's.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/core/units.hpp"
#include "adit/slam/loops/loop_verification.hpp"
#include "adit/slam/mapping/map_assembly.hpp"
#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/evaluation/evaluate.hpp"
#include "adit/tools/evaluation/loop_score.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace {

using namespace adit;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct Options {
  fs::path map;
  fs::path truth;
  fs::path loops;
  fs::path replayed = "replayed.adit";
  double yaw = 0.0;       ///< degrees a metre
  double vertical = 0.0;  ///< m a metre
  int64_t part = 0;       ///< a keyframe that nothing ties to the one before; 0: none
  bool recall = false;
  bool list = false;
};

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// The map's settings with the lengths that its submaps have.
Config config_of(const MapDatabase& map, const KeyframeSubmap& submap) {
  Config config = parse_config(map.sessions().front().configuration, map.file());
  if (config.preprocess.r_input == 0.0) {
    config.preprocess.r_input = submap.r_submap;
  }
  config.mapping.loops = true;
  return with_lengths(config, config.preprocess.r_input);
}

PoseEdge drifted(PoseEdge edge, const Options& options) {
  const double metres = edge.T_from_to.translation().norm();
  edge.T_from_to.linear() *=
      Eigen::AngleAxisd(options.yaw / kDegreesPerRadian * metres, Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  edge.T_from_to.translation().z() += options.vertical * metres;
  return edge;
}

/// Stored keyframes with what was measured between them, drift included.
struct Recorded {
  std::vector<MapKeyframe> keyframes;
  std::map<NodeId, PoseEdge> edges;  ///< by their later keyframe
};

Recorded recorded(const MapDatabase& map, const Options& options) {
  Recorded found{.keyframes = map.keyframes(), .edges = {}};
  const PoseGraph graph = map.graph();
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::odometry && edge.to != options.part) {
      found.edges[edge.to] = drifted(edge, options);
    }
  }
  return found;
}

double ate_of(const std::vector<StampedPose>& poses, const Trajectory& truth) {
  const Trajectory estimate{.file = {}, .stamped = true, .poses = poses};
  return evaluate(estimate, truth, {}).ate.rmse;
}

/// As a run has it of the alignment that tied the two.
void add_usual_rms(MapAssembly& assembly, LoopVerifier& verifier, const KeyframeSubmap& from,
                   const KeyframeSubmap& to, const SurfaceCloud& cloud, const PoseEdge& way) {
  const LoopQuestion question{
      .from = &from, .T_from_to = way.T_from_to, .covariance = symmetric_inverse(way.information)};
  const LoopVerification found = verifier.verify(to, cloud, std::span(&question, 1), 0.0).front();
  if (found.reason == LoopReason::poor_fit) {  // it is aligned, and held against nothing
    assembly.add_expected_rms(found.rms);
  }
}

void replay(engine::Context& context, const MapDatabase& map, const Options& options) {
  const Trajectory truth = read_trajectory(options.truth);
  const Recorded input = recorded(map, options);
  const KeyframeSubmap first = decode(map.submap(input.keyframes.front().id));
  const Config config = config_of(map, first);
  fs::remove(options.replayed);
  std::vector<StampedPose> by_odometry;
  std::vector<StampedPose> by_map;
  std::vector<Eigen::Isometry3d> T_keyframe_lidar;
  std::optional<LoopReport> report;
  double slowest = 0.0;
  const auto start = Clock::now();
  {
    MapDatabase out(options.replayed, MapAccess::write);
    const SessionId session = out.add_session({.name = "replay"});
    MapAssembly assembly(context, config, out, {});
    LoopVerifier verifier(context, config);
    std::optional<KeyframeSubmap> before;
    Eigen::Isometry3d T_odom_keyframe = input.keyframes.front().T_map_keyframe;
    for (const MapKeyframe& stored : input.keyframes) {
      const KeyframeSubmap submap = decode(map.submap(stored.id));
      const SurfaceCloud cloud = make_surface_cloud(context, submap);
      const auto edge = input.edges.find(stored.id);
      const bool tied = edge != input.edges.end();
      T_odom_keyframe = tied ? T_odom_keyframe * edge->second.T_from_to
                             : Eigen::Isometry3d(Eigen::AngleAxisd(
                                   0.5 * static_cast<double>(stored.id), Eigen::Vector3d::UnitZ()));
      const Eigen::Isometry3d T_lidar = submap.sweeps.front().T_keyframe_lidar;
      by_odometry.push_back({.stamp = stored.stamp, .pose = T_odom_keyframe * T_lidar});
      T_keyframe_lidar.push_back(T_lidar);
      MapKeyframe keyframe = stored;
      keyframe.session = session;
      if (tied && before) {
        add_usual_rms(assembly, verifier, *before, submap, cloud, edge->second);
      }
      before = submap;
      const auto begun = Clock::now();
      assembly.add({.keyframe = keyframe,
                    .T_odom_keyframe = T_odom_keyframe,
                    .submap = &submap,
                    .cloud = &cloud,
                    .edge = tied ? std::optional(edge->second) : std::nullopt});
      slowest = std::max(slowest, ms_since(begun));
    }
    assembly.finish();
    report = assembly.loops();
    const std::vector<MapKeyframe> made = out.keyframes();
    for (std::size_t i = 0; i < made.size(); ++i) {
      by_map.push_back(
          {.stamp = made[i].stamp, .pose = made[i].T_map_keyframe * T_keyframe_lidar[i]});
    }
    std::printf("%zu keyframes in %.1f s, the slowest %.0f ms; %zu parts\n", made.size(),
                1e-3 * ms_since(start), slowest,
                connected_components(out.graph()).components.size());
  }
  std::printf("ATE %.3f m by the odometry, %.3f m by the map\n", ate_of(by_odometry, truth),
              ate_of(by_map, truth));
  const LoopScore score =
      score_loops(options.replayed, truth,
                  options.loops.empty() ? std::vector<TrueLoop>() : read_true_loops(options.loops));
  std::printf("%s", describe(score).c_str());
  std::map<std::string, std::array<std::size_t, 2>> counted;  // right, wrong
  for (const ScoredLoop& loop : score.loops) {
    const LoopCandidate& one = loop.candidate;
    ++counted[std::string(to_string(one.source)) + " " + std::string(to_string(one.verdict)) + " " +
              one.reason][loop.error.right ? 0 : 1];
    if (options.list) {
      std::printf(
          "  %5ld %5ld %-10s %-9s %-18s score %6.2f overlap %.2f figure %8.3g, off %7.3f m "
          "%6.2f deg\n",
          static_cast<long>(one.from), static_cast<long>(one.to),
          std::string(to_string(one.source)).c_str(), std::string(to_string(one.verdict)).c_str(),
          one.reason.c_str(), one.score, one.overlap, one.figure, loop.error.metres,
          loop.error.degrees);
    }
  }
  for (const auto& [what, numbers] : counted) {
    std::printf("  %-45s %5zu right %5zu wrong\n", what.c_str(), numbers[0], numbers[1]);
  }
}

/// What the descriptor finds by itself: of the keyframes at a place that the truth says was seen
/// before, those whose most similar earlier place is one of it.
void recall(engine::Context& context, const MapDatabase& map, const Options& options) {
  const Trajectory truth = read_trajectory(options.truth);
  std::map<Nanoseconds, Eigen::Isometry3d> poses;
  for (const StampedPose& pose : truth.poses) {
    poses[pose.stamp] = pose.pose;
  }
  const std::vector<TrueLoop> loops = read_true_loops(options.loops);
  constexpr double kNear = 5.0;  // m
  PlaceIndex index(context);
  std::vector<Eigen::Isometry3d> T_world_keyframes;
  std::vector<double> path;
  std::map<std::string, std::array<std::size_t, 4>> found;  // asked, first, correlated, guess right
  double similar_ms = 0.0;
  std::vector<std::array<double, 3>> scores;  // similarity, likeness, right
  for (const MapKeyframe& keyframe : map.keyframes()) {
    const KeyframeSubmap submap = decode(map.submap(keyframe.id));
    const auto pose = poses.lower_bound(keyframe.stamp - std::chrono::milliseconds(20));
    T_world_keyframes.push_back(pose->second * submap.sweeps.front().T_keyframe_lidar.inverse());
    const Eigen::Isometry3d& T_world_newest = T_world_keyframes.back();
    path.push_back(path.empty() ? 0.0
                                : path.back() + (T_world_newest.translation() -
                                                 T_world_keyframes[path.size() - 1].translation())
                                                    .norm());
    index.add(make_surface_cloud(context, submap), plan_cell(submap.r_submap));
    const auto start = Clock::now();
    std::vector<SimilarPlace> similar = index.similar();
    similar_ms = ms_since(start);
    std::erase_if(similar,
                  [&](const SimilarPlace& one) { return path.back() - path[one.place] < 15.0; });
    std::ranges::sort(similar, std::greater<>(), &SimilarPlace::similarity);
    std::vector<SimilarPlace> best;
    for (const SimilarPlace& one : similar) {
      if (best.size() < 5 && std::ranges::none_of(best, [&](const SimilarPlace& other) {
            return std::max(other.place, one.place) - std::min(other.place, one.place) < 5;
          })) {
        best.push_back(one);
      }
    }
    std::vector<PlaceGuess> guesses = index.guesses(best);
    std::ranges::sort(guesses, std::greater<>(), &PlaceGuess::likeness);
    // The nearest true pair says from which direction the place is seen.
    const TrueLoop* nearest = nullptr;
    for (const TrueLoop& loop : loops) {
      if (loop.overlap >= 0.5 && loop.distance <= kNear &&
          std::chrono::abs(loop.later - keyframe.stamp) < std::chrono::milliseconds(500) &&
          (nearest == nullptr || loop.distance < nearest->distance)) {
        nearest = &loop;
      }
    }
    const auto is_near = [&](std::size_t place) {
      return (T_world_keyframes[place].translation() - T_world_newest.translation()).norm() <=
             kNear;
    };
    for (const PlaceGuess& guess : guesses) {
      const auto of = std::ranges::find(best, guess.place, &SimilarPlace::place);
      const Eigen::Isometry3d off = guess.T_place_newest.inverse() *
                                    T_world_keyframes[guess.place].inverse() * T_world_newest;
      const bool right = off.translation().norm() < 2.0 && rotation_angle(off.linear()) < 0.1;
      scores.push_back({of->similarity, guess.likeness, right ? 1.0 : 0.0});
    }
    if (nearest == nullptr || best.empty()) {
      continue;
    }
    const Eigen::Isometry3d T_earlier =
        poses.lower_bound(nearest->earlier - std::chrono::milliseconds(20))->second;
    const double turn = rotation_angle(T_earlier.linear().transpose() * T_world_newest.linear()) *
                        kDegreesPerRadian;
    const std::string seen = turn < 45.0 ? "same way" : turn < 135.0 ? "crossing" : "reverse";
    auto& counts = found[seen];
    ++counts[0];
    counts[1] += is_near(best.front().place) ? 1U : 0U;
    if (!guesses.empty() && is_near(guesses.front().place)) {
      ++counts[2];
      const Eigen::Isometry3d off = guesses.front().T_place_newest.inverse() *
                                    T_world_keyframes[guesses.front().place].inverse() *
                                    T_world_newest;
      counts[3] += off.translation().norm() < 2.0 && rotation_angle(off.linear()) < 0.1 ? 1U : 0U;
    }
  }
  for (const auto& [seen, counts] : found) {
    std::printf(
        "%-9s %4zu keyframes: most similar is the place %.3f, after correlation %.3f, "
        "guess within 2 m and 6 degrees %.3f\n",
        seen.c_str(), counts[0], static_cast<double>(counts[1]) / static_cast<double>(counts[0]),
        static_cast<double>(counts[2]) / static_cast<double>(counts[0]),
        static_cast<double>(counts[3]) / static_cast<double>(counts[0]));
  }
  std::printf("matching the last keyframe with %zu took %.1f ms\n", index.size() - 1, similar_ms);
  for (const int column : {0, 1}) {
    std::printf("%s:", column == 0 ? "similarity" : "likeness");
    for (int tenth = 0; tenth < 20; ++tenth) {
      std::array<int, 2> counts{};
      for (const auto& score : scores) {
        const double value = score[static_cast<std::size_t>(column)];
        if (std::min(static_cast<int>(value * 20.0), 19) == tenth) {
          ++counts[score[2] > 0.5 ? 0 : 1];
        }
      }
      std::printf(" %.2f:%d/%d", 0.05 * tenth, counts[0], counts[1]);
    }
    std::printf("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const CommandLine line("loop_replay", "Looks for the loops of a finished map anew");
  const Command program = line.program();
  Options options;
  program.option("--map", options.map, "The map").required();
  program.option("--truth", options.truth, "The truth's trajectory").required();
  program.option("--loops", options.loops, "The truth's loops");
  program.option("--output", options.replayed, "The map that is made");
  program.option("--yaw", options.yaw, "Drift, degrees a metre");
  program.option("--vertical", options.vertical, "Drift, m a metre");
  program.option("--part", options.part, "A keyframe that nothing ties to the one before");
  program.flag("--recall", options.recall, "Only what the descriptor finds by itself");
  program.flag("--list", options.list, "Every candidate");
  if (const std::optional<int> ended = line.run(argc, argv)) {
    return *ended;
  }
  try {
    DeviceSession session(DeviceOptions{});
    const MapDatabase map(options.map, MapAccess::read);
    options.recall ? recall(session.context(), map, options)
                   : replay(session.context(), map, options);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "loop_replay: %s\n", error.what());
    return 1;
  }
}
