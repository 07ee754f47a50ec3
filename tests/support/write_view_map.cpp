// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// write_view_map FILE: a map whose places are known, for the tests of `adit view`. Six keyframes
// lie 10 m apart along x by the odometry; an accepted loop has the last one 1 m nearer, a rejected
// one ties it to the second. Before each is a wall 4 m to its left; points 2 m above the first
// three of them stand alone. The last two are of a second session. The map's origin is at 48
// degrees north, 11.5 degrees east and 500 m, and its x axis points 30 degrees north of east.
#include <cstdio>
#include <exception>
#include <numbers>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/map_support.hpp"

namespace adit {
namespace {

constexpr int kMetre = static_cast<int>(kSubmapSteps);

KeyframeSubmap wall(NodeId id, Nanoseconds stamp) {
  KeyframeSubmap submap;
  submap.r_submap = 0.25;
  submap.sweeps.push_back({.stamp = stamp, .merged = true});
  for (int x = 0; x < 80; ++x) {
    for (int z = 0; z < 40; ++z) {
      submap.points.push_back(
          {.place = {(x - 40) * kMetre / 10, 4 * kMetre, (z - 10) * kMetre / 20}});
    }
  }
  if (id < 3) {
    submap.points.push_back({.place = {0, 0, 2 * kMetre}});
  }
  return submap;
}

void write(const char* file) {
  MapDatabase map(file, MapAccess::write);
  const SessionId first = test::add_session(map);
  const SessionId second = map.add_session({.name = "second"});
  for (NodeId id = 0; id < 6; ++id) {
    KeyframeRecord record = test::record(id, id < 4 ? first : second);
    record.keyframe.stamp = Nanoseconds(1'700'000'000'000'000'000 + 2'000'000'000 * id);
    record.submap = encode(wall(id, record.keyframe.stamp));
    map.store(record);
  }
  MapRevision revision = test::loops_of_six();
  revision.georeference = Georeference{.origin = {48.0, 11.5, 500.0}};
  revision.georeference->T_world_map.rotate(
      Eigen::AngleAxisd(std::numbers::pi / 6.0, Eigen::Vector3d::UnitZ()));
  map.revise(revision);
}

}  // namespace
}  // namespace adit

int main(int argc, char** argv) {
  try {
    if (argc != 2) {
      std::fputs("write_view_map FILE\n", stderr);
      return 2;
    }
    adit::write(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "write_view_map: %s\n", error.what());
    return 1;
  }
}
