// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What verification makes of pairs of submaps that are given to it, one by one: pairs of a finished
// map that look alike and are of different places, which it is to refuse, or the submaps of a
// folder with a graph. A program by itself, built on request.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "adit/slam/core/units.hpp"
#include "adit/slam/loops/loop_voting.hpp"
#include "adit/slam/loops/place_index.hpp"
#include "adit/slam/mapping/loop_by_hand.hpp"
#include "adit/slam/submaps/submap_builder.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/evaluation/loop_score.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace {

using namespace adit;
namespace fs = std::filesystem;

struct Options {
  fs::path map;
  fs::path truth;
  fs::path folder;
  std::size_t pairs = 200;
  double apart = 10.0;  ///< m
  double r_submap = 0.5;
  bool list = false;
};

/// Two keyframes and how they might lie to each other.
struct Offer {
  NodeId from = 0;
  NodeId to = 0;
  double likeness = 0.0;
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();
};

/// Keyframes with where they really are.
struct Places {
  std::vector<MapKeyframe> keyframes;
  std::map<NodeId, Eigen::Isometry3d> T_world_keyframe;
};

Places places_of(const MapDatabase& map, const Trajectory& truth) {
  std::map<Nanoseconds, Eigen::Isometry3d> poses;
  for (const StampedPose& pose : truth.poses) {
    poses[pose.stamp] = pose.pose;
  }
  Places places;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    const auto pose = poses.lower_bound(keyframe.stamp - std::chrono::milliseconds(20));
    if (pose != poses.end()) {
      const KeyframeSubmap submap = decode(map.submap(keyframe.id));
      places.T_world_keyframe[keyframe.id] =
          pose->second * submap.sweeps.front().T_keyframe_lidar.inverse();
      places.keyframes.push_back(keyframe);
    }
  }
  return places;
}

/// Of all pairs that are really `apart`, those that look most alike, each keyframe at most four
/// times: as the plans fit best.
std::vector<Offer> wrong_pairs(engine::Context& context, const MapDatabase& map,
                               const Places& places, const Options& options) {
  PlaceIndex index(context);
  std::vector<Offer> offers;
  for (const MapKeyframe& newest : places.keyframes) {
    const KeyframeSubmap submap = decode(map.submap(newest.id));
    index.add(make_surface_cloud(context, submap), plan_cell(submap.r_submap));
    const Eigen::Vector3d here = places.T_world_keyframe.at(newest.id).translation();
    std::vector<SimilarPlace> similar = index.similar();
    std::erase_if(similar, [&](const SimilarPlace& one) {
      const NodeId id = places.keyframes[one.place].id;
      return (places.T_world_keyframe.at(id).translation() - here).norm() < options.apart;
    });
    std::ranges::sort(similar, std::greater<>(), &SimilarPlace::similarity);
    similar.resize(std::min<std::size_t>(similar.size(), 4));
    for (const PlaceGuess& guess : index.guesses(similar)) {
      offers.push_back({.from = places.keyframes[guess.place].id,
                        .to = newest.id,
                        .likeness = guess.likeness,
                        .T_from_to = guess.T_place_newest});
    }
  }
  std::ranges::stable_sort(offers, std::greater<>(), &Offer::likeness);
  offers.resize(std::min(offers.size(), options.pairs));
  return offers;
}

/// Keyframes where the odometry has them.
PoseGraph odometry_alone(const PoseGraph& graph) {
  PoseGraph alone;
  std::vector<PoseEdge> edges;
  std::ranges::copy_if(graph.edges(), std::back_inserter(edges), [](const PoseEdge& edge) {
    return edge.kind == EdgeKind::odometry && edge.status == EdgeStatus::active;
  });
  for (PoseNode node : graph.nodes()) {
    const auto edge = std::ranges::find(edges, node.id, &PoseEdge::to);
    if (edge != edges.end() && alone.contains(edge->from)) {
      node.T_map_node = alone.nodes()[alone.index_of(edge->from)].T_map_node * edge->T_from_to;
    }
    alone.add_node(node);
  }
  for (const PoseEdge& edge : edges) {
    alone.add_edge(edge);
  }
  return alone;
}

/// How many of these loops, all of them wrong, are accepted: `all` at once, as if they had come
/// within one queue.
std::map<std::string, std::size_t> votes(const PoseGraph& graph,
                                         const std::vector<LoopHypothesis>& all) {
  std::map<std::string, std::size_t> counted;
  for (const LoopVote& one : vote(graph, all, {}, true, {})) {
    const char* said = one.accepted                               ? "ACCEPTED"
                       : one.objection == LoopObjection::odometry ? "against_odometry"
                       : one.objection == LoopObjection::loops    ? "against_loops"
                       : one.objection == LoopObjection::places   ? "another_place"
                                                                  : "few_votes";
    ++counted[said];
  }
  return counted;
}

void offer_wrong_pairs(engine::Context& context, const Options& options) {
  const MapDatabase map(options.map, MapAccess::read);
  const Config config = parse_config(map.sessions().front().configuration, map.file());
  const Places places = places_of(map, read_trajectory(options.truth));
  const std::vector<Offer> offers = wrong_pairs(context, map, places, options);
  const double usual = usual_rms(context, config, map);
  std::map<std::string, std::size_t> counted;
  std::vector<LoopHypothesis> wrong;
  for (const Offer& offer : offers) {
    const LoopVerification found =
        verify_by_hand(context, config, map,
                       {.from = offer.from, .to = offer.to, .guess = offer.T_from_to}, usual);
    const LoopError error = loop_error(found.T_from_to, places.T_world_keyframe.at(offer.from),
                                       places.T_world_keyframe.at(offer.to));
    const bool validated = found.reason == LoopReason::none;
    ++counted[validated ? (error.right ? "validated, right" : "validated, WRONG")
                        : std::string(to_string(found.reason))];
    if (options.list) {
      std::printf("  %5ld %5ld likeness %.2f overlap %.2f rms %.3f through %.3f: %s, off %.1f m\n",
                  static_cast<long>(offer.from), static_cast<long>(offer.to), offer.likeness,
                  found.overlap, found.rms, found.through,
                  std::string(to_string(found.reason)).c_str(), error.metres);
    }
    if (validated && !error.right) {
      wrong.push_back({.id = static_cast<int64_t>(wrong.size()) + 1,
                       .from = offer.from,
                       .to = offer.to,
                       .T_from_to = found.T_from_to,
                       .covariance = found.covariance,
                       .strong = found.strong,
                       .source = LoopSource::appearance});
    }
  }
  std::printf("%zu pairs offered that are %.0f m apart and more; likeness %.2f to %.2f\n",
              offers.size(), options.apart, offers.empty() ? 0.0 : offers.back().likeness,
              offers.empty() ? 0.0 : offers.front().likeness);
  for (const auto& [what, number] : counted) {
    std::printf("  %-22s %5zu\n", what.c_str(), number);
  }
  if (!wrong.empty()) {
    std::printf("what was validated wrongly, voted on at once:\n");
    for (const auto& [what, number] : votes(odometry_alone(map.graph()), wrong)) {
      std::printf("  %-22s %5zu\n", what.c_str(), number);
    }
  }
}

/// A submap of a folder, as if it had been seen by one sweep.
struct FolderSubmap {
  std::string name;
  FrozenSubmap frozen;
  Eigen::Isometry3d T_map_keyframe = Eigen::Isometry3d::Identity();
};

/// float32 x y z, m.
void append_points(const fs::path& file, std::vector<Point>& points) {
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw std::runtime_error(file.string() + " cannot be opened");
  }
  std::array<float, 3> p{};
  while (in.read(reinterpret_cast<char*>(p.data()), sizeof(p))) {
    points.push_back({.x = p[0], .y = p[1], .z = p[2], .intensity = 0.0F});
  }
}

/// NAME/points.bin, or planes_NAME.bin and edges_NAME.bin.
std::vector<Point> points_of(const fs::path& folder, const std::string& name) {
  std::vector<Point> points;
  if (fs::exists(folder / name / "points.bin")) {
    append_points(folder / name / "points.bin", points);
  } else {
    append_points(folder / ("planes_" + name + ".bin"), points);
    append_points(folder / ("edges_" + name + ".bin"), points);
  }
  return points;
}

std::vector<FolderSubmap> submaps_of(engine::Context& context, const Options& options,
                                     const Config& config) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(options.folder)) {
    const std::string stem = entry.path().stem().string();
    if (entry.is_directory()) {
      names.insert(stem);
    } else if (stem.starts_with("planes_")) {
      names.insert(stem.substr(7));
    }
  }
  std::ifstream graph(options.folder / "graph.txt");
  std::vector<FolderSubmap> submaps;
  SubmapBuilder builder(context, config.preprocess, options.r_submap);
  for (const std::string& name : names) {
    std::string node;
    Eigen::Vector3d t;
    Eigen::Quaterniond q;
    if (!(graph >> node >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w())) {
      throw std::runtime_error("graph.txt has no pose for " + name);
    }
    const std::vector<Point> points = points_of(options.folder, name);
    builder.add({.stamp = Nanoseconds(1), .cloud = points});
    FolderSubmap& made = submaps.emplace_back();
    made.name = name;
    made.frozen = builder.freeze(config.preprocess.beam_spacing);
    made.T_map_keyframe.linear() = q.normalized().toRotationMatrix();
    made.T_map_keyframe.translation() = t;
    made.T_map_keyframe = made.T_map_keyframe * made.frozen.T_odom_keyframe;
  }
  return submaps;
}

/// As a drift of some 0.3 m and 3 degrees would have it.
Eigen::Isometry3d drifted(const Eigen::Isometry3d& T, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Vector6d twist;
  for (int i = 0; i < 6; ++i) {
    twist[i] = normal(random) * (i < 3 ? 0.3 : 3.0 / kDegreesPerRadian);
  }
  return T * se3_exp(twist);
}

void offer_folder(engine::Context& context, const Options& options) {
  Config config;
  config.preprocess.r_input = options.r_submap;
  config.preprocess.beam_spacing = 0.4 / kDegreesPerRadian;
  config = with_lengths(config, options.r_submap);
  const std::vector<FolderSubmap> submaps = submaps_of(context, options, config);
  LoopVerifier verifier(context, config);
  std::mt19937_64 random(1);
  for (std::size_t j = 0; j < submaps.size(); ++j) {
    const SurfaceCloud cloud = make_surface_cloud(context, submaps[j].frozen.submap);
    for (std::size_t i = 0; i < submaps.size(); ++i) {
      if (i == j) {
        continue;
      }
      const Eigen::Isometry3d truth =
          submaps[i].T_map_keyframe.inverse() * submaps[j].T_map_keyframe;
      Vector6d sigma;
      sigma << Eigen::Vector3d::Constant(0.5), Eigen::Vector3d::Constant(5.0 / kDegreesPerRadian);
      const LoopQuestion question{.from = &submaps[i].frozen.submap,
                                  .T_from_to = drifted(truth, random),
                                  .covariance = sigma.cwiseAbs2().asDiagonal()};
      const LoopVerification found =
          verifier.verify(submaps[j].frozen.submap, cloud, std::span(&question, 1), 0.1).front();
      const LoopError error =
          loop_error(found.T_from_to, submaps[i].T_map_keyframe, submaps[j].T_map_keyframe);
      std::printf(
          "%s to %s, %.1f m: %s%s, overlap %.2f, rms %.3f m, off the graph by %.3f m %.2f "
          "degrees\n",
          submaps[j].name.c_str(), submaps[i].name.c_str(), truth.translation().norm(),
          found.reason == LoopReason::none ? "validated" : "refused: ",
          found.reason == LoopReason::none ? "" : std::string(to_string(found.reason)).c_str(),
          found.overlap, found.rms, error.metres, error.degrees);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const CommandLine line("loop_pairs", "What verification makes of pairs that are given to it");
  const Command program = line.program();
  Options options;
  program.option("--map", options.map, "A map, whose pairs that look alike are offered");
  program.option("--truth", options.truth, "The truth's trajectory");
  program.option("--pairs", options.pairs, "So many of them");
  program.option("--apart", options.apart, "Really so far apart, m");
  program.option("--folder", options.folder, "Submaps with graph.txt, whose pairs are offered");
  program.option("--r-submap", options.r_submap, "They are down-sampled to that, m");
  program.flag("--list", options.list, "Every pair");
  if (const std::optional<int> ended = line.run(argc, argv)) {
    return *ended;
  }
  try {
    DeviceSession session(DeviceOptions{});
    options.folder.empty() ? offer_wrong_pairs(session.context(), options)
                           : offer_folder(session.context(), options);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "loop_pairs: %s\n", error.what());
    return 1;
  }
}
