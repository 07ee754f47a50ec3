// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/placed_cloud.hpp"

#include <fstream>
#include <string>
#include <unordered_map>
#include <vector>

#include "adit/tools/clouds/ply_writer.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// Leaves the stream at the first point. False where it does not hold so many.
bool find_points(std::ifstream& stream, uint64_t points) {
  std::string line;
  while (std::getline(stream, line) && line != "end_header") {
  }
  const std::streamoff begin = stream.tellg();
  stream.seekg(0, std::ios::end);
  const std::streamoff end = stream.tellg();
  stream.seekg(begin);
  return stream && static_cast<uint64_t>(end - begin) >= points * sizeof(Point);
}

}  // namespace

void place_again(const fs::path& ply, std::span<const CloudPart> parts,
                 std::span<const StampedPose> poses) {
  std::unordered_map<Nanoseconds::rep, const Eigen::Isometry3d*> places;
  for (const StampedPose& pose : poses) {
    places.emplace(pose.stamp.count(), &pose.pose);
  }
  std::ifstream before(ply, std::ios::binary);
  uint64_t all = 0;
  for (const CloudPart& part : parts) {
    all += part.points;
  }
  if (!find_points(before, all)) {
    throw OutputError(ply, ply.string() +
                               ": holds fewer points than were written; something else has "
                               "changed it. Its points are where the odometry saw them.");
  }
  Draft draft(ply);
  PlyWriter after(draft.path());
  std::vector<Point> points;
  for (const CloudPart& part : parts) {
    points.resize(part.points);
    before.read(reinterpret_cast<char*>(points.data()),
                static_cast<std::streamsize>(points.size() * sizeof(Point)));
    if (!before) {
      throw OutputError(ply, ply.string() + ": cannot be read again.");
    }
    const auto place = places.find(part.stamp.count());
    if (place != places.end()) {
      const Eigen::Isometry3d moved = *place->second * part.T_map_lidar.inverse();
      for (Point& point : points) {
        const Eigen::Vector3f p =
            (moved * Eigen::Vector3d(point.x, point.y, point.z)).cast<float>();
        point = {.x = p.x(), .y = p.y(), .z = p.z(), .intensity = point.intensity};
      }
    }
    after.write(points);
  }
  after.close();
  draft.take_its_place();
}

}  // namespace adit
