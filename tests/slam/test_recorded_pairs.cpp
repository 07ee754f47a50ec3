// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Real pairs of clouds with known relative poses (../shared/data beside the checkout), by every
// method.
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/slam/registration/batch_aligner.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tests/support/shared_data.hpp"
#include "adit/tests/support/shared_data_sweeps.hpp"

namespace adit {
namespace {

double pair_metres_off(const RegistrationResult& result, const Eigen::Isometry3d& truth) {
  return (truth.inverse() * result.T_target_source).translation().norm();
}
double pair_degrees_off(const RegistrationResult& result, const Eigen::Isometry3d& truth) {
  return kDegreesPerRadian * rotation_angle((truth.inverse() * result.T_target_source).linear());
}

std::vector<Point> read_three_floats(const std::filesystem::path& file) {
  const std::string bytes = test::read_bytes(file);
  std::vector<Point> points(bytes.size() / (3 * sizeof(float)));
  for (size_t i = 0; i < points.size(); ++i) {
    std::array<float, 3> xyz{};
    std::memcpy(xyz.data(), bytes.data() + sizeof(xyz) * i, sizeof(xyz));
    points[i] = {xyz[0], xyz[1], xyz[2], 0.0F};
  }
  return points;
}

/// Lines "vN tx ty tz qx qy qz qw".
std::vector<Eigen::Isometry3d> read_graph(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<Eigen::Isometry3d> poses;
  std::string name;
  double x = 0;
  double y = 0;
  double z = 0;
  Eigen::Quaterniond q;
  while (in >> name >> x >> y >> z >> q.x() >> q.y() >> q.z() >> q.w()) {
    poses.push_back(Eigen::Translation3d(x, y, z) * q.normalized());
  }
  return poses;
}

PreprocessConfig preprocessing(double r_input, double surface_size = 1.0) {
  PreprocessConfig config;
  config.r_input = r_input;
  config.surface_size = surface_size;
  return config;
}

struct Method {
  std::string name;
  AlignmentSettings settings;
  std::vector<double> voxel_sizes;
};

std::vector<Method> methods() {
  Method vgicp{.name = "VGICP", .settings = {}, .voxel_sizes = {2.0, 1.0, 0.5}};
  Method ndt{.name = "NDT", .settings = {}, .voxel_sizes = {3.0, 1.5}};
  ndt.settings.method = RegistrationMethod::ndt;
  ndt.settings.d_max = 2.0;
  ndt.settings.translation_epsilon = 1e-3;
  ndt.settings.rotation_epsilon = 1e-4;
  return {vgicp, ndt};
}

class RecordedPairsTest : public test::DeviceTest {
 protected:
  /// Errors of the relative poses of neighbours, from a guess 0.27 m and 1.9 degrees off.
  void expect_neighbours(const std::vector<std::vector<Point>>& clouds,
                         const std::vector<Eigen::Isometry3d>& poses, double degrees) {
    AlignmentClouds maker(context(), preprocessing(0.1));
    std::vector<SurfaceCloud> surfaces;
    for (const std::vector<Point>& cloud : clouds) {
      surfaces.push_back(maker.make_cloud(cloud));
    }
    Vector6d offset;
    offset << 0.2, -0.15, 0.1, 0.01, -0.01, 0.03;
    for (const Method& method : methods()) {
      std::vector<AlignmentTarget> targets;
      std::vector<AlignmentPair> pairs(clouds.size() - 1);
      for (const SurfaceCloud& cloud : surfaces) {
        targets.push_back(maker.make_target(cloud, method.settings.method, method.voxel_sizes));
      }
      for (size_t i = 0; i < pairs.size(); ++i) {
        pairs[i].source = &surfaces[i + 1];
        pairs[i].target = &targets[i];
        pairs[i].T_target_source = retract(poses[i].inverse() * poses[i + 1], offset);
      }
      const std::vector<RegistrationResult> results =
          BatchAligner(context(), method.settings).align(pairs);
      for (size_t i = 0; i < pairs.size(); ++i) {
        const Eigen::Isometry3d truth = poses[i].inverse() * poses[i + 1];
        EXPECT_EQ(results[i].status, RegistrationStatus::converged)
            << method.name << ", pair " << i;
        EXPECT_LE(pair_metres_off(results[i], truth), 0.05) << method.name << ", pair " << i;
        EXPECT_LE(pair_degrees_off(results[i], truth), degrees) << method.name << ", pair " << i;
        RecordProperty(method.name + " " + std::to_string(i),
                       std::to_string(1e3 * pair_metres_off(results[i], truth)) + " mm, " +
                           std::to_string(pair_degrees_off(results[i], truth)) + " degrees");
      }
    }
  }
};

TEST_F(RecordedPairsTest, TheRegistrationPairIsAlignedFromTheIdentity) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "registration_pair");
  const Eigen::Isometry3d truth = test::read_poses(folder / "T_target_source.txt")[0];
  AlignmentClouds maker(context(), preprocessing(0.25, 0.0));
  const SurfaceCloud target =
      maker.make_cloud(test::read_four_float_ply(folder / "target.ply").points);
  const SurfaceCloud source =
      maker.make_cloud(test::read_four_float_ply(folder / "source.ply").points);
  for (const Method& method : methods()) {
    const AlignmentTarget map =
        maker.make_target(target, method.settings.method, method.voxel_sizes);
    AlignmentPair pair;
    pair.source = &source;
    pair.target = &map;
    const RegistrationResult result =
        BatchAligner(context(), method.settings).align(std::vector{pair}).at(0);
    EXPECT_EQ(result.status, RegistrationStatus::converged) << method.name;
    // The reference itself is good to 2 cm.
    EXPECT_LE(pair_metres_off(result, truth), method.name == "NDT" ? 0.030 : 0.015) << method.name;
    EXPECT_LE(pair_degrees_off(result, truth), 0.3) << method.name;
    for (const auto* directions : {&result.translation, &result.rotation}) {
      for (const ObservedDirection& direction : *directions) {
        EXPECT_EQ(direction.localizability, Localizability::full) << method.name;
      }
    }
    RecordProperty(method.name, std::to_string(1e3 * pair_metres_off(result, truth)) + " mm, " +
                                    std::to_string(pair_degrees_off(result, truth)) + " degrees");
  }
}

// The last pair's reference and both methods differ by 0.25 degrees, and the methods agree.
TEST_F(RecordedPairsTest, NeighbouringSubmapsOfKitti07) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "submaps_kitti_07");
  std::vector<std::vector<Point>> clouds;
  for (const char* name : {"000000", "000001", "000002", "000003", "000004"}) {
    clouds.push_back(read_three_floats(folder / name / "points.bin"));
  }
  expect_neighbours(clouds, read_graph(folder / "graph.txt"), 0.27);
}

TEST_F(RecordedPairsTest, NeighbouringCloudsOfNewerCollege) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "submaps_newer_college");
  std::vector<std::vector<Point>> clouds;
  for (const char* number : {"000000", "000010", "000020", "000030", "000040"}) {
    clouds.push_back(read_three_floats(folder / (std::string("planes_") + number + ".bin")));
    const std::vector<Point> edges =
        read_three_floats(folder / (std::string("edges_") + number + ".bin"));
    clouds.back().insert(clouds.back().end(), edges.begin(), edges.end());
  }
  expect_neighbours(clouds, read_graph(folder / "graph.txt"), 0.2);
}

}  // namespace
}  // namespace adit
