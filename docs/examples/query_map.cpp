// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A stored map: what it consists of, and what it has near a place.
#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/map_database/map_database.hpp"

int main(int argc, char** argv) try {
  if (argc != 5) {
    std::cerr << "usage: query_map MAP X Y Z\n";
    return 2;
  }
  const adit::MapDatabase map(argv[1], adit::MapAccess::read);
  const auto edges = map.graph().edges();
  const auto loops = std::ranges::count(edges, adit::EdgeKind::loop, &adit::PoseEdge::kind);
  std::cout << map.keyframes().size() << " keyframes, " << edges.size() << " edges, " << loops
            << " of them loops\n";
  if (const auto world = map.georeference()) {
    std::cout << "its origin lies at " << world->origin.latitude << ", " << world->origin.longitude
              << "\n";
  }
  const Eigen::Vector3d place(std::atof(argv[2]), std::atof(argv[3]), std::atof(argv[4]));
  const Eigen::Vector3d margin(1.0, 1.0, 1.0);
  for (const adit::NodeId id : map.submaps_within(place - margin, place + margin)) {
    const adit::KeyframeSubmap submap = adit::decode(map.submap(id));
    const Eigen::Isometry3d pose = map.keyframe(id)->T_map_keyframe;
    const auto near = std::ranges::count_if(submap.points, [&](const adit::SubmapPoint& point) {
      return (pose * point.position() - place).cwiseAbs().maxCoeff() <= 1.0;
    });
    std::cout << "keyframe " << id << ", " << (pose.translation() - place).norm()
              << " m away: " << near << " of its " << submap.points.size()
              << " points within 1 m\n";
  }
} catch (const adit::InputError& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
