// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Pairs of clouds from guesses and from nothing: what is found, and what is refused.
#include "adit/slam/registration/cloud_aligner.hpp"

#include <cstring>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using test::Lidar;

/// A lidar's pose in a street, 1.8 m above the ground.
StampedPose place(double x, double y, double degrees, int64_t stamp = 1) {
  StampedPose pose{.stamp = Nanoseconds(stamp)};
  pose.pose = Eigen::AngleAxisd(degrees * kDegree, Eigen::Vector3d::UnitZ());
  pose.pose.translation() << x, y, 1.8;
  return pose;
}

class CloudAlignerTest : public test::DeviceTest {
 protected:
  static std::vector<Point> seen(const StampedPose& pose, uint64_t street = 1) {
    return test::scan(test::make_street(30.0, street), pose, Lidar{.beams = 64}).points;
  }

  static double metres_off(const CloudAlignment& alignment, const Eigen::Isometry3d& truth) {
    return (truth.inverse() * alignment.T_a_b).translation().norm();
  }
  static double degrees_off(const CloudAlignment& alignment, const Eigen::Isometry3d& truth) {
    return rotation_angle((truth.inverse() * alignment.T_a_b).linear()) / kDegree;
  }
};

TEST_F(CloudAlignerTest, FindsAPairFromFarGuessesAndFromNothing) {
  const StampedPose at_a = place(10.0, 0.5, 0.0);
  const StampedPose at_b = place(13.0, -0.5, 130.0, 2);
  const Eigen::Isometry3d truth = at_a.pose.inverse() * at_b.pose;
  CloudAligner aligner(context());
  const AlignableCloud a = aligner.prepare(seen(at_a));
  const AlignableCloud b = aligner.prepare(seen(at_b));
  std::vector<CloudPair> pairs = {{.a = &a, .b = &b}};
  for (int i = 0; i < 8; ++i) {  // 2 m and 20 degrees off, all ways
    Vector6d off;
    off << (i & 1 ? 1.2 : -1.2), (i & 2 ? 1.2 : -1.2), (i & 4 ? 1.0 : -1.0), (i & 2 ? 0.15 : -0.15),
        (i & 1 ? -0.15 : 0.15), (i & 4 ? 0.27 : -0.27);
    pairs.push_back({.a = &a, .b = &b, .guess = retract(truth, off)});
  }
  const std::vector<CloudAlignment> found = aligner.align(pairs);
  ASSERT_EQ(found.size(), pairs.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].refusal, AlignmentRefusal::none)
        << i << ": " << to_string(found[i].refusal) << ", overlap " << found[i].registration.overlap
        << ", rms " << found[i].registration.residual_rms;
    EXPECT_LT(metres_off(found[i], truth), 0.05) << i;
    EXPECT_LT(degrees_off(found[i], truth), 0.3) << i;
    const Vector6d variances = found[i].covariance.diagonal();
    EXPECT_GT(variances.minCoeff(), 0.0) << i;
    EXPECT_LT(variances.head<3>().maxCoeff(), 0.05 * 0.05) << i;
  }
  EXPECT_GT(found[0].poses_tried, 1U);
  EXPECT_EQ(found[1].poses_tried, 1U);
}

TEST_F(CloudAlignerTest, GivesTheSameBitsAgainAndWithOtherPairs) {
  const StampedPose at_b = place(12.0, 0.0, 20.0, 2);
  CloudAligner aligner(context());
  const AlignableCloud a = aligner.prepare(seen(place(10.0, 0.5, 0.0)));
  const AlignableCloud b = aligner.prepare(seen(at_b));
  const std::vector<CloudPair> one = {{.a = &a, .b = &b}};
  const std::vector<CloudPair> more = {{.a = &b, .b = &a}, one[0], {.a = &a, .b = &a}};
  const CloudAlignment alone = aligner.align(one).at(0);
  const CloudAlignment together = aligner.align(more).at(1);
  EXPECT_EQ(std::memcmp(alone.T_a_b.data(), together.T_a_b.data(), 16 * sizeof(double)), 0);
  EXPECT_EQ(alone.covariance, together.covariance);
  EXPECT_EQ(alone.refusal, together.refusal);
}

TEST_F(CloudAlignerTest, ACheckpointEndsTheWorkAndChangesNoBit) {
  struct Stop {};
  CloudAligner aligner(context());
  std::size_t passed = 0;
  const Checkpoint count = [&] { ++passed; };
  const AlignableCloud a = aligner.prepare(seen(place(10.0, 0.5, 0.0)), std::nullopt, count);
  const AlignableCloud b = aligner.prepare(seen(place(12.0, 0.0, 20.0, 2)), std::nullopt, count);
  EXPECT_GE(passed, 6U) << "between the parts of a cloud";
  const std::vector<CloudPair> pairs(6, {.a = &a, .b = &b});
  const std::vector<CloudAlignment> expected = aligner.align(pairs);
  passed = 0;
  const std::vector<CloudAlignment> in_pieces = aligner.align(pairs, count);
  EXPECT_GE(passed, 36 * pairs.size() + 4) << "searches, coarse, fine, scores, competing poses";
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_EQ(in_pieces[i].T_a_b.matrix(), expected[i].T_a_b.matrix());
    EXPECT_EQ(in_pieces[i].covariance, expected[i].covariance);
    EXPECT_EQ(in_pieces[i].refusal, expected[i].refusal);
  }
  for (const std::size_t last : {std::size_t{1}, 36 * pairs.size() + 1, 36 * pairs.size() + 4}) {
    std::size_t left = last;
    const Checkpoint stop = [&] {
      if (--left == 0) {
        throw Stop{};
      }
    };
    EXPECT_THROW(aligner.align(pairs, stop), Stop) << last;
    EXPECT_EQ(aligner.align(pairs).front().T_a_b.matrix(), expected.front().T_a_b.matrix());
  }
}

TEST_F(CloudAlignerTest, RefusesOtherPlacesWithAReason) {
  CloudAligner aligner(context());
  const AlignableCloud here = aligner.prepare(seen(place(10.0, 0.0, 0.0)));
  const AlignableCloud there = aligner.prepare(seen(place(10.0, 0.0, 0.0), 77));
  const std::vector<CloudPair> pairs = {
      {.a = &here, .b = &there}, {.a = &here, .b = &there, .guess = Eigen::Isometry3d::Identity()}};
  for (const CloudAlignment& alignment : aligner.align(pairs)) {
    EXPECT_NE(alignment.refusal, AlignmentRefusal::none)
        << "overlap " << alignment.registration.overlap << ", rms "
        << alignment.registration.residual_rms;
  }
}

/// Two walls and a floor along x without end: nothing tells where along x one is.
std::vector<Point> corridor() {
  std::vector<Point> points;
  for (float x = -20.0F; x < 20.0F; x += 0.08F) {
    for (float at = -1.5F; at < 1.5F; at += 0.1F) {
      points.push_back({x, at, -1.5F, 0.0F});
      points.push_back({x, -1.5F, at, 0.0F});
      points.push_back({x, 1.5F, at, 0.0F});
    }
  }
  return points;
}

TEST_F(CloudAlignerTest, RefusesACorridorThatLooksTheSameAllAlong) {
  CloudAligner aligner(context());
  const AlignableCloud cloud = aligner.prepare(corridor());
  const std::vector<CloudPair> pairs = {
      {.a = &cloud, .b = &cloud, .guess = Eigen::Isometry3d(Eigen::Translation3d(1.0, 0.1, 0.0))}};
  const CloudAlignment alignment = aligner.align(pairs).at(0);
  EXPECT_TRUE(alignment.refusal == AlignmentRefusal::degenerate ||
              alignment.refusal == AlignmentRefusal::ambiguous)
      << to_string(alignment.refusal);
}

TEST_F(CloudAlignerTest, SaysOfCloudsWithoutPointsThatThereIsNothingToAlign) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CloudAligner aligner(context());
  const AlignableCloud street = aligner.prepare(seen(place(10.0, 0.0, 0.0)));
  const AlignableCloud empty = aligner.prepare({});
  const AlignableCloud none = aligner.prepare(std::vector<Point>(500, Point{nan, nan, nan, nan}));
  const AlignableCloud zeros = aligner.prepare(std::vector<Point>(500));
  std::vector<CloudPair> pairs;
  for (const AlignableCloud* cloud : {&empty, &none, &zeros}) {
    pairs.push_back({.a = &street, .b = cloud});
    pairs.push_back({.a = cloud, .b = &street, .guess = Eigen::Isometry3d::Identity()});
  }
  pairs.push_back({.a = &street, .b = &street, .guess = Eigen::Isometry3d::Identity()});
  const std::vector<CloudAlignment> found = aligner.align(pairs);
  for (std::size_t i = 0; i + 1 < found.size(); ++i) {
    EXPECT_EQ(found[i].refusal, AlignmentRefusal::nothing_to_align) << i;
  }
  EXPECT_EQ(found.back().refusal, AlignmentRefusal::none);
  EXPECT_TRUE(aligner.align({}).empty());
}

TEST_F(CloudAlignerTest, EveryMethodFindsANearPair) {
  const StampedPose at_a = place(10.0, 0.5, 0.0);
  const StampedPose at_b = place(11.0, 0.0, 8.0, 2);
  const Eigen::Isometry3d truth = at_a.pose.inverse() * at_b.pose;
  for (const RegistrationMethod method :
       {RegistrationMethod::vgicp, RegistrationMethod::ndt, RegistrationMethod::point_to_plane,
        RegistrationMethod::ndt_to_ndt}) {
    CloudAligner aligner(context(), {.method = method});
    const AlignableCloud a = aligner.prepare(seen(at_a));
    const AlignableCloud b = aligner.prepare(seen(at_b));
    const std::vector<CloudPair> pairs = {
        {.a = &a, .b = &b, .guess = Eigen::Isometry3d::Identity()}};
    const CloudAlignment found = aligner.align(pairs).at(0);
    EXPECT_EQ(found.refusal, AlignmentRefusal::none)
        << to_string(method) << ": " << to_string(found.refusal);
    EXPECT_LT(metres_off(found, truth), 0.1) << to_string(method);
    EXPECT_LT(degrees_off(found, truth), 0.6) << to_string(method);
  }
}

TEST_F(CloudAlignerTest, CloudsFarFromTheirOriginAreAlignedAboutTheirMiddle) {
  const Eigen::Vector3d far(4000.0, -7000.0, 300.0);
  const StampedPose at_a = place(10.0, 0.5, 0.0);
  const StampedPose at_b = place(11.0, 0.0, 8.0, 2);
  const auto moved = [&](std::vector<Point> points) {
    std::erase_if(points, [](const Point& p) { return p.x == 0.0F && p.y == 0.0F; });
    for (Point& p : points) {
      p.x += static_cast<float>(far.x());
      p.y += static_cast<float>(far.y());
      p.z += static_cast<float>(far.z());
    }
    return points;
  };
  CloudAligner aligner(context());
  const AlignableCloud a = aligner.prepare(moved(seen(at_a)));
  const AlignableCloud b = aligner.prepare(moved(seen(at_b)));
  const std::vector<CloudPair> pairs = {{.a = &a, .b = &b}};
  const CloudAlignment found = aligner.align(pairs).at(0);
  EXPECT_EQ(found.refusal, AlignmentRefusal::none) << to_string(found.refusal);
  const Eigen::Isometry3d truth =
      Eigen::Translation3d(far) * (at_a.pose.inverse() * at_b.pose) * Eigen::Translation3d(-far);
  EXPECT_LT((found.T_a_b * far - truth * far).norm(), 0.05);
}

}  // namespace
}  // namespace adit
