// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Sweeps of a street for tests of submaps, and a map in a file of its own.
#pragma once

#include <string>
#include <vector>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/submaps/submap_builder.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/map_database/map_database.hpp"

namespace adit::test {

inline const Lidar& small_lidar() {
  static const Lidar lidar{.beams = 24, .columns = 360};
  return lidar;
}

inline Config submap_config() {
  Config config;
  config.preprocess.beam_spacing = small_lidar().beam_spacing();
  return with_lengths(config);
}

inline Config loop_config(bool loops = true) {
  Config config = submap_config();
  config.mapping.loops = loops;
  return config;
}

/// A drive along a street with the places where its sweeps were taken.
struct SubmapDrive {
  std::vector<StampedPose> truth;  ///< T_world_lidar
  std::vector<Sweep> sweeps;
};

/// `T_mount_lidar`: how the lidar sits on what drives.
inline SubmapDrive submap_drive(
    std::size_t count, double forward,
    const Eigen::Isometry3d& T_mount_lidar = Eigen::Isometry3d::Identity()) {
  SubmapDrive drive{.truth = steady_drive(count, twist(forward, 0.01)), .sweeps = {}};
  for (StampedPose& pose : drive.truth) {
    pose.pose = pose.pose * T_mount_lidar;
  }
  drive.sweeps = scan_all(make_street(60.0), drive.truth, small_lidar());
  return drive;
}

/// Points with a return.
inline std::vector<Point> returns(const Sweep& sweep) {
  std::vector<Point> points;
  for (const Point& point : sweep.points) {
    if (point.x != 0.0F || point.y != 0.0F || point.z != 0.0F) {
      points.push_back(point);
    }
  }
  return points;
}

/// A map in a folder of its own, with a session.
class TemporaryMap {
 public:
  TemporaryMap()
      : store_(folder_ / "map.adit", MapAccess::write),
        session_(store_.add_session({.name = "test"})) {}

  MapDatabase& store() { return store_; }
  SessionId session() const { return session_; }
  std::string dump() const {
    std::string text;
    store_.dump([&](std::string_view line) { text += std::string(line) + "\n"; });
    return text;
  }

 private:
  TemporaryFolder folder_;
  MapDatabase store_;
  SessionId session_;
};

}  // namespace adit::test
