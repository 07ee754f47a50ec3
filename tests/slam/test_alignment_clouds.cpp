// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/alignment_clouds.hpp"

#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

class AlignmentCloudsTest : public test::DeviceTest {
 protected:
  static std::vector<Point> street(int beams) {
    StampedPose pose;
    pose.pose.translation() << 20.0, 0.0, 1.8;
    return test::scan(test::make_street(40.0), pose, test::Lidar{.beams = beams}).points;
  }
  static bool same_bytes(const SurfaceCloud& a, const SurfaceCloud& b) {
    const auto x = download<gpu::uvec4>(a.points);
    const auto y = download<gpu::uvec4>(b.points);
    return a.size == b.size && std::memcmp(x.data(), y.data(), a.size * sizeof(gpu::uvec4)) == 0;
  }
};

TEST_F(AlignmentCloudsTest, ACloudDoesNotDependOnThoseMadeBefore) {
  // The angle between the beams is measured, and each sensor has its own.
  PreprocessConfig config;
  config.beam_spacing = 0.0;
  const auto make = [&](AlignmentClouds& maker, int beams) {
    return maker.make_cloud(street(beams), Eigen::Vector3d::Zero());
  };
  AlignmentClouds first(context(), config);
  AlignmentClouds second(context(), config);
  const SurfaceCloud dense_first = make(first, 64);
  const SurfaceCloud sparse_second = make(first, 16);
  const SurfaceCloud sparse_first = make(second, 16);
  const SurfaceCloud dense_second = make(second, 64);
  EXPECT_TRUE(same_bytes(dense_first, dense_second));
  EXPECT_TRUE(same_bytes(sparse_first, sparse_second));

  config.beam_spacing = test::Lidar{.beams = 64}.beam_spacing();
  AlignmentClouds told(context(), config);
  EXPECT_FALSE(same_bytes(make(told, 16), sparse_first)) << "the angle makes a difference";
}

}  // namespace
}  // namespace adit
