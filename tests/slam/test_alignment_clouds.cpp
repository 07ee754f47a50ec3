// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/alignment_clouds.hpp"

#include <array>
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

TEST_F(AlignmentCloudsTest, AVoxelWithMorePointsThanItsSumsHoldIsToldOf) {
  PreprocessConfig config;
  config.c_min = 0.5;
  config.c_max = 100.0;
  config.r_input = 0.02;
  config.beam_spacing = 0.01;
  AlignmentClouds maker(context(), config);
  std::vector<Point> points;
  for (int i = 0; i < 65'536; ++i) {
    points.push_back({8.01F, 1.01F + 0.02F * static_cast<float>(i % 256),
                      1.01F + 0.02F * static_cast<float>(i / 256), 0.0F});
  }
  for (const bool fits : {false, true}) {
    if (fits) {
      points.pop_back();
    }
    const SurfaceCloud cloud = maker.make_cloud(points);
    ASSERT_EQ(cloud.size, points.size());
    for (const RegistrationMethod method : {RegistrationMethod::vgicp, RegistrationMethod::ndt}) {
      const auto make = [&] { maker.make_target(cloud, method, std::array{16.0}); };
      if (fits) {
        EXPECT_NO_THROW(make());
      } else {
        EXPECT_THROW(make(), engine::Error);
      }
    }
  }
}

}  // namespace
}  // namespace adit
