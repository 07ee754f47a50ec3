// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/simulated_graph.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

constexpr int kBlock = 50;             // m between streets
constexpr std::size_t kRecent = 150;   // nodes back, which are no loop
constexpr double kHillHeight = 8.0;    // m
constexpr double kHillLength = 120.0;  // m a radian

/// A place on the grid and the way it is faced, in quarter turns.
struct DrivenPlace {
  int x = 0;
  int y = 0;
  int heading = 0;
};

/// On at a crossing: straight on, left or right, never out of the town, back only where nothing
/// else is left.
int turned(const DrivenPlace& place, int size, Random& random) {
  const auto stays = [&](int heading) {
    const int x = place.x + (heading == 0 ? 1 : heading == 2 ? -1 : 0);
    const int y = place.y + (heading == 1 ? 1 : heading == 3 ? -1 : 0);
    return x >= 0 && y >= 0 && x <= size && y <= size;
  };
  std::vector<int> ways;
  for (const int turn : {0, 1, 3}) {
    if (stays((place.heading + turn) % 4)) {
      ways.push_back((place.heading + turn) % 4);
    }
  }
  const auto last = static_cast<double>(ways.size());
  return ways.empty() ? (place.heading + 2) % 4
                      : ways[static_cast<std::size_t>(random.uniform(0.0, last))];
}

std::vector<DrivenPlace> walk(std::size_t nodes, int streets, Random& random) {
  const int size = kBlock * (streets - 1);
  std::vector<DrivenPlace> places = {{0, 0, 0}};
  while (places.size() < nodes) {
    DrivenPlace place = places.back();
    if (place.x % kBlock == 0 && place.y % kBlock == 0) {
      place.heading = turned(place, size, random);
    }
    place.x += place.heading == 0 ? 1 : place.heading == 2 ? -1 : 0;
    place.y += place.heading == 1 ? 1 : place.heading == 3 ? -1 : 0;
    places.push_back(place);
  }
  return places;
}

Eigen::Isometry3d pose_of(const DrivenPlace& place, bool planar) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const double height =
      planar ? 0.0
             : kHillHeight * std::sin(place.x / kHillLength) * std::cos(place.y / kHillLength);
  pose.translation() = Eigen::Vector3d(place.x, place.y, height);
  constexpr double kCosines[4] = {1.0, 0.0, -1.0, 0.0};
  const double cosine = kCosines[place.heading];
  const double sine = kCosines[(place.heading + 3) % 4];
  pose.linear() << cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0;
  return pose;
}

/// Pairs of an earlier and a later visit of one place.
std::vector<std::pair<std::size_t, std::size_t>> visits_again(
    const std::vector<DrivenPlace>& places) {
  std::map<std::pair<int, int>, std::size_t> last_visit;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto [at, first] = last_visit.try_emplace({places[i].x, places[i].y}, i);
    if (!first) {
      if (i - at->second > kRecent) {
        pairs.emplace_back(at->second, i);
      }
      at->second = i;
    }
  }
  return pairs;
}

PoseEdge measured(const std::vector<Eigen::Isometry3d>& truth, std::size_t from, std::size_t to,
                  double sigma, double angle_sigma, bool planar, Random& random) {
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(sigma), Eigen::Vector3d::Constant(angle_sigma);
  const Vector6d plane = (Vector6d() << 1.0, 1.0, 0.0, 0.0, 0.0, 1.0).finished();
  Vector6d error = sigmas.cwiseProduct(Vector6d::NullaryExpr([&] { return random.gaussian(); }));
  Vector6d information = sigmas.cwiseAbs2().cwiseInverse();
  if (planar) {
    error = error.cwiseProduct(plane);
    information = information.cwiseProduct(plane);
  }
  PoseEdge edge;
  edge.from = static_cast<NodeId>(from);
  edge.to = static_cast<NodeId>(to);
  edge.T_from_to = retract(truth[from].inverse() * truth[to], error);
  edge.information = information.asDiagonal();
  return edge;
}

}  // namespace

SimulatedGraph simulated_graph(const SimulatedGraphSettings& settings) {
  Random random(settings.seed);
  const int fitting = static_cast<int>(std::sqrt(static_cast<double>(settings.nodes) / 200.0));
  const int streets = settings.streets > 1 ? settings.streets : std::max(2, fitting);
  const std::vector<DrivenPlace> places = walk(settings.nodes, streets, random);
  SimulatedGraph result{PoseGraph(settings.planar), {}};
  for (const DrivenPlace& place : places) {
    result.truth.push_back(pose_of(place, settings.planar));
  }
  Eigen::Isometry3d reckoned = result.truth.front();
  std::vector<PoseEdge> edges;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i > 0) {
      edges.push_back(measured(result.truth, i - 1, i, settings.odometry_sigma,
                               settings.odometry_angle_sigma, settings.planar, random));
      reckoned = orthonormalized(reckoned * edges.back().T_from_to);
    }
    result.graph.add_node({.id = static_cast<NodeId>(i), .T_map_node = reckoned});
  }
  const auto pairs = visits_again(places);
  const std::size_t loops = std::min(settings.loops, pairs.size());
  for (std::size_t i = 0; i < loops; ++i) {
    const auto [from, to] = pairs[i * pairs.size() / loops];
    edges.push_back(measured(result.truth, from, to, settings.loop_sigma, settings.loop_angle_sigma,
                             settings.planar, random));
    edges.back().kind = EdgeKind::loop;
  }
  for (const PoseEdge& edge : edges) {
    result.graph.add_edge(edge);
  }
  return result;
}

double position_rmse(const std::vector<Eigen::Isometry3d>& poses,
                     const std::vector<Eigen::Isometry3d>& truth) {
  double squares = 0.0;
  const Eigen::Isometry3d back = truth.front() * poses.front().inverse();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    squares += (back * poses[i].translation() - truth[i].translation()).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(poses.size()));
}

}  // namespace adit
