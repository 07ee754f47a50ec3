// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/placed_cloud.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/clouds/ply_writer.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

Eigen::Isometry3d pose(double x, double yaw) {
  Eigen::Isometry3d result(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  result.translation().x() = x;
  return result;
}

/// Three sweeps of two points each, 1 and 2 m ahead of the sensor; the last one has no points.
class CloudWherePlaced : public testing::Test {
 protected:
  CloudWherePlaced() {
    PlyWriter writer(file_);
    for (int i = 0; i < 4; ++i) {
      const Eigen::Isometry3d placed = pose(10.0 * i, 0.1 * i);
      std::vector<Point> points;
      for (float ahead = 1.0F; i < 3 && ahead < 3.0F; ahead += 1.0F) {
        const Eigen::Vector3f p =
            (placed * Eigen::Vector3d(static_cast<double>(ahead), 0.0, 0.0)).cast<float>();
        points.push_back({.x = p.x(), .y = p.y(), .z = p.z(), .intensity = 7.0F + ahead});
      }
      writer.write(points);
      parts_.push_back(
          {.stamp = Nanoseconds(100 * i), .T_map_lidar = placed, .points = points.size()});
    }
    writer.close();
  }

  const test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "map.ply";
  std::vector<CloudPart> parts_;
};

TEST_F(CloudWherePlaced, FollowsThePosesThatTheMapHasInTheEnd) {
  const std::vector<StampedPose> poses{{.stamp = Nanoseconds(0), .pose = pose(0.0, 0.0)},
                                       {.stamp = Nanoseconds(100), .pose = pose(5.0, 0.5)},
                                       {.stamp = Nanoseconds(300), .pose = pose(9.0, 0.5)}};
  place_again(file_, parts_, poses);
  const Sweep cloud = read_ply(file_).sweep;
  ASSERT_EQ(cloud.points.size(), 6U);
  const auto expect_at = [&](std::size_t index, const Eigen::Isometry3d& placed, double ahead) {
    const Point& point = cloud.points[index];
    const Eigen::Vector3d p = placed * Eigen::Vector3d(ahead, 0.0, 0.0);
    EXPECT_LT((Eigen::Vector3d(point.x, point.y, point.z) - p).norm(), 1e-5) << index;
    EXPECT_EQ(point.intensity, 7.0F + static_cast<float>(ahead)) << index;
  };
  for (const std::size_t i : {0U, 1U}) {
    expect_at(i, pose(0.0, 0.0), 1.0 + static_cast<double>(i));
    expect_at(2 + i, pose(5.0, 0.5), 1.0 + static_cast<double>(i));
    expect_at(4 + i, parts_[2].T_map_lidar, 1.0 + static_cast<double>(i));  // has no pose: stays
  }
  EXPECT_FALSE(std::filesystem::exists(file_.string() + ".part"));
}

TEST_F(CloudWherePlaced, AFileThatWasCutOffIsToldAndStays) {
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) - 10);
  const auto size = std::filesystem::file_size(file_);
  EXPECT_THROW(place_again(file_, parts_, {}), OutputError);
  EXPECT_EQ(std::filesystem::file_size(file_), size);
}

}  // namespace
}  // namespace adit
